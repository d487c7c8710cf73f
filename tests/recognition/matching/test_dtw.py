"""Elastic matching: the laws of dynamic time warping, against a plain loop."""

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.matching.dtw import (
    DtwBatch,
    DtwReferences,
    dtw_distances,
    dtw_pairs,
    step_distances,
)
from app.recognition.matching.dtw_kernel import compute_alignment_costs
from app.recognition.poses.sequence import FloatArray


def plain_loop(query: FloatArray, reference: FloatArray, band: int) -> float:
    """Sakoe and Chiba's recurrence, cell by cell."""
    steps = len(query)
    total = np.full((steps + 1, steps + 1), np.inf)
    total[0, 0] = 0.0
    for i in range(steps):
        for j in range(max(0, i - band), min(steps, i + band + 1)):
            before = min(total[i, j], total[i, j + 1], total[i + 1, j])
            total[i + 1, j + 1] = float(np.linalg.norm(query[i] - reference[j])) + before
    return float(total[-1, -1] / steps)


@st.composite
def sequences(draw: st.DrawFn, count: int) -> FloatArray:
    """Draw `count` sequences of the same length and dimension."""
    generator = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    shape = (count, draw(st.integers(1, 12)), draw(st.integers(1, 4)))
    return generator.normal(size=shape).cumsum(axis=1)


@given(sequences(4), st.integers(0, 15))
def test_it_equals_the_plain_loop(drawn: FloatArray, band: int) -> None:
    expected = [plain_loop(drawn[0], reference, band) for reference in drawn[1:]]
    np.testing.assert_allclose(dtw_distances(drawn[0], drawn[1:], band), expected, atol=1e-9)


@given(sequences(1), st.integers(0, 15))
def test_a_sequence_is_at_distance_zero_from_itself(drawn: FloatArray, band: int) -> None:
    assert dtw_distances(drawn[0], drawn, band)[0] == 0.0


@given(sequences(2), st.integers(0, 15))
def test_it_is_symmetric(drawn: FloatArray, band: int) -> None:
    there = dtw_distances(drawn[0], drawn[1:], band)
    back = dtw_distances(drawn[1], drawn[:1], band)
    np.testing.assert_allclose(there, back, atol=1e-9)


@given(sequences(2), st.integers(0, 6))
def test_it_is_the_same_from_end_to_start(drawn: FloatArray, band: int) -> None:
    forward = dtw_distances(drawn[0], drawn[1:], band)
    backward = dtw_distances(drawn[0, ::-1], drawn[1:, ::-1], band)
    np.testing.assert_allclose(forward, backward, atol=1e-9)


@given(sequences(2), st.integers(0, 6))
def test_a_wider_band_never_costs_more(drawn: FloatArray, band: int) -> None:
    narrow = dtw_distances(drawn[0], drawn[1:], band)
    assert dtw_distances(drawn[0], drawn[1:], band + 1)[0] <= narrow[0] + 1e-9


@given(st.integers(0, 8), st.integers(0, 2**32 - 1))
def test_a_delay_within_the_band_costs_nothing(delay: int, seed: int) -> None:
    path = np.random.default_rng(seed).normal(size=(20, 2)).cumsum(axis=0)
    early = np.concatenate([path, np.repeat(path[-1:], delay, axis=0)])
    late = np.concatenate([np.repeat(path[:1], delay, axis=0), path])
    assert dtw_distances(early, late[None], delay)[0] == pytest.approx(0.0, abs=1e-9)
    if delay:
        assert dtw_distances(early, late[None], delay - 1)[0] > 0.0


def test_a_component_that_is_not_known_is_left_out() -> None:
    generator = np.random.default_rng(3)
    query, references = generator.normal(size=(9, 4)), generator.normal(size=(2, 9, 4))
    hidden = references.copy()
    hidden[1, :, 2:] = np.nan
    distances = dtw_distances(query, hidden, 3)
    assert distances[0] == pytest.approx(dtw_distances(query, references, 3)[0])
    half = dtw_distances(query[:, :2], references[1:, :, :2], 3)[0]
    assert distances[1] == pytest.approx(2**0.5 * half)


def test_nothing_in_common_is_infinitely_far() -> None:
    query = np.array([[0.0, np.nan], [1.0, np.nan]])
    references = np.array([[[np.nan, 0.0], [np.nan, 1.0]], [[0.0, 0.0], [1.0, 0.0]]])
    np.testing.assert_array_equal(dtw_distances(query, references, 1), [np.inf, 0.0])


@given(sequences(2), st.integers(0, 15))
def test_the_costs_of_the_alignment_add_up_to_the_distance(drawn: FloatArray, band: int) -> None:
    pairs = dtw_pairs(drawn[0], drawn[1], band)
    costs = np.linalg.norm(drawn[0][pairs[:, 0]] - drawn[1][pairs[:, 1]], axis=1)
    distance = dtw_distances(drawn[0], drawn[1:], band)[0]
    assert costs.sum() / len(drawn[0]) == pytest.approx(distance, abs=1e-9)


@given(sequences(2), st.integers(0, 15))
def test_the_alignment_runs_on_from_start_to_end_within_the_band(
    drawn: FloatArray, band: int
) -> None:
    pairs = dtw_pairs(drawn[0], drawn[1], band)
    assert pairs[0].tolist() == [0, 0]
    assert pairs[-1].tolist() == [len(drawn[0]) - 1] * 2
    assert {tuple(step) for step in np.diff(pairs, axis=0)} <= {(0, 1), (1, 0), (1, 1)}
    assert np.abs(pairs[:, 0] - pairs[:, 1]).max() <= band


def test_the_alignment_leaves_out_what_is_not_known() -> None:
    generator = np.random.default_rng(4)
    query, reference = generator.normal(size=(9, 4)), generator.normal(size=(9, 4))
    query[:, 3] = np.nan
    pairs = dtw_pairs(query, reference, 3)
    costs = step_distances(query, reference[None])[pairs[:, 0], pairs[:, 1], 0]
    assert costs.sum() / 9 == pytest.approx(dtw_distances(query, reference[None], 3)[0])


@given(sequences(5), st.integers(0, 15))
def test_prepared_references_may_be_asked_for_a_few(drawn: FloatArray, band: int) -> None:
    query, references = drawn[0], DtwReferences(drawn[1:], band)
    every = dtw_distances(query, drawn[1:], band)
    # Single precision: squares are right to a millionth of the largest, and small ones are 0.
    right = 2e-3 * max(1.0, float(np.sqrt((drawn**2).sum(axis=2).max())))
    np.testing.assert_allclose(references.distances(query), every, atol=right)
    costs = references.step_costs(query, np.array([2, 0]))
    np.testing.assert_allclose(
        compute_alignment_costs(costs, len(query), band), every[[2, 0]], atol=right
    )


@given(sequences(3), st.integers(0, 15))
def test_a_prepared_sequence_is_at_distance_zero_from_itself(drawn: FloatArray, band: int) -> None:
    sized = drawn / np.sqrt((drawn**2).sum(axis=2).mean(axis=1)).clip(1e-9)[:, None, None]
    assert DtwReferences(sized, band).distances(sized[1])[1] == 0.0


@pytest.mark.parametrize("hook", [1, 2, 3])
@pytest.mark.parametrize("backwards", [False, True])
def test_open_ends_leave_out_what_one_sequence_has_in_addition(hook: int, backwards: bool) -> None:
    generator = np.random.default_rng(hook)
    shown = generator.normal(size=(20, 2))
    hooked = np.concatenate([generator.normal(size=(hook, 2)), shown[:-hook]])
    query, reference = (hooked[::-1], shown[::-1]) if backwards else (hooked, shown)
    for one, other in ((query, reference), (reference, query)):
        assert DtwReferences(other[None], 5, ends=hook).distances(one)[0] == 0.0
        assert DtwReferences(other[None], 5, ends=hook - 1).distances(one)[0] > 0.0


@given(sequences(4), st.integers(0, 15), st.integers(0, 3))
def test_open_ends_never_add_a_cost(drawn: FloatArray, band: int, ends: int) -> None:
    closed = DtwReferences(drawn[1:], band).distances(drawn[0])
    assert (DtwReferences(drawn[1:], band, ends).distances(drawn[0]) <= closed).all()


def test_components_that_no_reference_knows_are_left_out_before() -> None:
    generator = np.random.default_rng(5)
    query, references = generator.normal(size=(9, 4)), generator.normal(size=(3, 9, 4))
    references[..., 3] = np.nan
    known = dtw_distances(query[:, :3], references[..., :3], 2)
    np.testing.assert_allclose(DtwReferences(references, 2).distances(query), known, rtol=1e-5)
    query[:, 0] = np.nan
    known = dtw_distances(query[:, 1:3], references[..., 1:3], 2)
    np.testing.assert_allclose(DtwReferences(references, 2).distances(query), known, rtol=1e-5)


@pytest.mark.parametrize("rows", [None, np.array([2, 0])])
@pytest.mark.parametrize("hidden", [(), (0,), (0, 1), (2,)])
def test_views_asked_together_answer_as_each_does_alone(
    rows: npt.NDArray[np.intp] | None, hidden: tuple[int, ...]
) -> None:
    generator = np.random.default_rng(6)
    sizes = (2, 3, 4)
    queries = [generator.normal(size=(9, size)) for size in sizes]
    views = [DtwReferences(generator.normal(size=(4, 9, size)), 3, ends=2) for size in sizes]
    for index in hidden:
        views[index].sequences[1, 4:, 0] = np.nan
    views[2].sequences[..., 3] = np.nan
    together = DtwBatch(tuple(views))
    for _ in range(2):
        costs = together.step_costs(queries, rows)
        for index, view in enumerate(views):
            alone = view.step_costs(queries[index], rows)
            np.testing.assert_allclose(costs[:, index], alone, atol=1e-5)
        queries[1][3] = np.nan  # and once more for a query with a gap
