"""Gaps: landmarks between the moments at which they are seen."""

import numpy as np
import numpy.typing as npt
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.poses.sequence import MAX_GAP_SECONDS, bridge_short_gaps, fill_all_gaps

TIME = np.array([0.0, 0.1, 0.2, 0.4, 0.5])


def points(*columns: list[float]) -> npt.NDArray[np.float64]:
    """Return ``(T, K, 1)`` of K landmarks, each by its values over time."""
    return np.array(columns, dtype=np.float64).T[..., None]


def test_a_short_gap_is_bridged_in_time_and_the_ends_are_left_out() -> None:
    xy = points([np.nan, 0.0, np.nan, 3.0, np.nan])
    bridged = bridge_short_gaps(xy, TIME, MAX_GAP_SECONDS)
    np.testing.assert_allclose(bridged[:, 0, 0], [np.nan, 0.0, 1.0, 3.0, np.nan])
    assert np.isnan(xy[2])


def test_a_gap_longer_than_the_limit_stays() -> None:
    xy = points([0.0, np.nan, np.nan, 3.0, 4.0])
    np.testing.assert_array_equal(bridge_short_gaps(xy, TIME, 0.3), xy)
    assert np.isfinite(bridge_short_gaps(xy, TIME, 0.4)).all()


def test_all_gaps_are_filled_with_the_nearest_value_beyond_the_ends() -> None:
    filled = fill_all_gaps(points([np.nan, 0.0, np.nan, 3.0, np.nan], [np.nan] * 5), TIME)
    np.testing.assert_allclose(filled[:, 0, 0], [0.0, 0.0, 1.0, 3.0, 3.0])
    assert np.isnan(filled[:, 1]).all()


def test_a_point_of_which_one_coordinate_is_missing_is_not_known() -> None:
    half = np.array([[[0.0, 0.0]], [[9.0, np.nan]], [[2.0, 4.0]]])
    np.testing.assert_allclose(fill_all_gaps(half, TIME[:3])[1, 0], [1.0, 2.0])


def test_values_are_interpolated_at_other_moments() -> None:
    at = np.array([0.05, 0.3, 9.0])
    filled = fill_all_gaps(points([0.0, 1.0, np.nan, 4.0, 5.0]), TIME, at)
    np.testing.assert_allclose(filled[:, 0, 0], [0.5, 3.0, 5.0])


@given(st.lists(st.one_of(st.just(np.nan), st.floats(-5, 5)), min_size=2, max_size=20))
def test_what_is_known_is_never_changed(path: list[float]) -> None:
    time = np.arange(len(path)) / 10
    xy = points(path)
    known = np.isfinite(xy)
    for filled in (fill_all_gaps(xy, time), bridge_short_gaps(xy, time, MAX_GAP_SECONDS)):
        np.testing.assert_array_equal(filled[known], xy[known])
