"""Landmarks refined by their heat maps."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.estimation.landmark_models.detector import REACH, refine, sigmoid
from app.recognition.estimation.landmark_models.onnx_session import Tensor

NOTHING = -30.0
CERTAIN = 30.0


def heatmap_with(*cells: tuple[int, int]) -> Tensor:
    """Return a map of 64 x 64 cells for one landmark, certain of the given (column, row)."""
    heatmap = np.full((64, 64, 1), NOTHING, np.float32)
    for column, row in cells:
        heatmap[row, column, 0] = CERTAIN
    return heatmap


@given(
    st.integers(0, 63), st.integers(0, 63), st.integers(-REACH, REACH), st.integers(-REACH, REACH)
)
def test_a_landmark_moves_to_the_certain_cell_within_reach(
    column: int, row: int, right: int, down: int
) -> None:
    target = np.array([column + right, row + down])
    if (target < 0).any() or (target > 63).any():
        return
    start = (np.array([[column, row]]) + 0.5) / 64
    refined = refine(start, heatmap_with((target[0], target[1])))
    np.testing.assert_allclose(refined[0], target / 64, atol=1e-6)


def test_two_equally_certain_cells_pull_to_their_middle() -> None:
    refined = refine(np.array([[0.5, 0.5]]), heatmap_with((30, 32), (33, 32)))
    np.testing.assert_allclose(refined[0], (31.5 / 64, 0.5))


@pytest.mark.parametrize("start", [(-0.1, 0.5), (0.5, 1.0), (1.2, 3.0), (0.9, -0.2)])
def test_a_landmark_outside_the_crop_is_left_where_it_is(start: tuple[float, float]) -> None:
    heatmap = np.full((64, 64, 1), CERTAIN, np.float32)
    np.testing.assert_array_equal(refine(np.array([start]), heatmap)[0], start)


def test_an_unsure_heat_map_changes_nothing() -> None:
    start = np.array([[0.31, 0.72]])
    heatmap = np.full((64, 64, 1), -0.1, np.float32)
    np.testing.assert_array_equal(refine(start, heatmap), start)


def test_what_lies_beyond_reach_is_not_seen() -> None:
    start = np.array([[0.5, 0.5]])
    np.testing.assert_array_equal(refine(start, heatmap_with((32 + REACH + 1, 32))), start)


def test_each_landmark_has_its_own_map() -> None:
    heatmap = np.concatenate([heatmap_with((10, 10)), heatmap_with((50, 50))], axis=2)
    refined = refine(np.array([[11.5 / 64, 10 / 64], [49.5 / 64, 51 / 64]]), heatmap)
    np.testing.assert_allclose(refined, [[10 / 64, 10 / 64], [50 / 64, 50 / 64]], atol=1e-6)


def test_the_given_landmarks_stay_unchanged() -> None:
    start = np.array([[0.5, 0.5]])
    refine(start, heatmap_with((33, 33)))
    np.testing.assert_array_equal(start, [[0.5, 0.5]])


def test_the_logistic_function_does_not_overflow() -> None:
    with np.errstate(all="raise"):
        np.testing.assert_allclose(sigmoid(np.array([-1e9, 0, 1e9])), [0, 0.5, 1], atol=1e-30)
