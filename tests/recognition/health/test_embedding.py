"""The map: distances that fit into a plane are kept, and near gestures are near."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.health.check import embed_gestures


def between(places: np.ndarray) -> np.ndarray:
    return np.asarray(np.linalg.norm(places[:, None] - places[None], axis=-1))


@given(st.integers(1, 12), st.integers(0, 2**32 - 1))
def test_distances_in_a_plane_are_kept(count: int, seed: int) -> None:
    distances = between(np.random.default_rng(seed).normal(size=(count, 2)))
    np.testing.assert_allclose(between(embed_gestures(distances)), distances, atol=1e-6)


def test_the_same_distances_give_the_same_map_centred_at_zero() -> None:
    distances = between(np.random.default_rng(0).normal(size=(5, 4)))
    np.testing.assert_array_equal(embed_gestures(distances), embed_gestures(distances.copy()))
    np.testing.assert_allclose(embed_gestures(distances).mean(axis=0), 0, atol=1e-9)


def test_what_cannot_be_compared_lies_as_far_as_the_farthest() -> None:
    distances = np.array([[0, 1, np.inf], [1, 0, np.inf], [np.inf, np.inf, 0]])
    near, far = between(embed_gestures(distances))[0, 1:]
    assert np.isfinite([near, far]).all()
    assert far >= near - 1e-9


def test_a_language_of_one_lies_in_the_middle() -> None:
    np.testing.assert_array_equal(embed_gestures(np.zeros((1, 1))), [[0.0, 0.0]])
