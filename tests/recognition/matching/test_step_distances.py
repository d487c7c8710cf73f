"""Distances of all steps from all are those of each pair."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.matching.dtw import step_distances


@given(
    seed=st.integers(0, 2**32 - 1),
    shape=st.tuples(st.integers(1, 4), st.integers(1, 6), st.integers(1, 3)),
    hidden=st.floats(0, 1),
)
def test_what_is_known_of_two_vectors_stands_for_the_whole(
    seed: int, shape: tuple[int, int, int], hidden: float
) -> None:
    generator = np.random.default_rng(seed)
    references, query = generator.normal(size=shape), generator.normal(size=shape[1:])
    references[generator.random(shape) < hidden] = np.nan
    squares = (query[:, None, None] - references.transpose(1, 0, 2)) ** 2
    known = np.isfinite(squares).sum(axis=-1)
    total = np.nansum(squares, axis=-1) * shape[-1]
    expected = np.divide(total, known, out=np.full(known.shape, np.inf), where=known > 0)
    np.testing.assert_allclose(step_distances(query, references), np.sqrt(expected), atol=2e-6)


def test_equal_steps_are_at_distance_zero_in_memory_that_is_given() -> None:
    steps = 1e3 + np.random.default_rng(1).normal(size=(5, 2))
    out = np.empty((5, 5, 1))
    found = step_distances(steps - 1e3, steps[None] - 1e3, out)
    assert found is out
    assert (np.diagonal(found[..., 0]) == 0).all()


def test_without_any_component_nothing_can_be_compared() -> None:
    assert np.isinf(step_distances(np.empty((3, 0)), np.empty((2, 3, 0)))).all()
