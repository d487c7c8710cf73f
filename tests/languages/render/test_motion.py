"""Laws of human movement that the rendered hand obeys."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from languages.render.gestures import arc, lying_eight, straight
from languages.render.motion import along_curve, curvature, minimum_jerk, tremor


@given(st.floats(0, 1))
def test_minimum_jerk_is_symmetric_in_time(share: float) -> None:
    assert minimum_jerk(share) + minimum_jerk(1 - share) == pytest.approx(1)


def test_minimum_jerk_starts_and_stops_at_rest() -> None:
    way = minimum_jerk(np.linspace(0, 1, 1001))
    speed = np.gradient(way, 1 / 1000)
    assert (way[0], way[-1]) == (0, 1)
    assert speed[[0, -1]] == pytest.approx([0, 0], abs=1e-3)
    # Flash and Hogan 1985: the peak is 1.875 times the mean.
    assert speed.max() == pytest.approx(1.875, abs=1e-3)


@pytest.mark.parametrize("radius", [0.1, 0.5, 2.0])
def test_curvature_of_a_circle_is_one_over_its_radius(radius: float) -> None:
    bent = curvature(arc((0, 0), radius, 0, 270))
    assert bent[5:-5] == pytest.approx(np.full(len(bent) - 10, 1 / radius), rel=1e-3)


@pytest.mark.parametrize(
    "curve", [straight((0, 0), (0.3, 0.1)), arc((0, 0), 0.2, 0, 360), lying_eight(0.3, 0.2)]
)
def test_a_hand_goes_from_the_first_point_of_a_curve_to_the_last(
    curve: np.ndarray[tuple[int, int], np.dtype[np.float64]],
) -> None:
    path = along_curve(curve, 50)
    assert path.shape == (50, 2)
    assert path[[0, -1]] == pytest.approx(curve[[0, -1]])
    gaps = np.linalg.norm(path[:, None] - curve[None], axis=2).min(axis=1)
    assert gaps.max() < 0.003


def test_a_hand_is_slower_where_the_curve_is_tight() -> None:
    tight_then_wide = np.concatenate([arc((0, 0), 0.05, 180, 0), arc((-0.35, 0), 0.4, 0, -45)[1:]])
    path = along_curve(tight_then_wide, 400)
    speed = np.linalg.norm(np.diff(path, axis=0), axis=1)
    # Compared at one distance in time from either end, where the start and the stop slow it alike.
    assert speed[120] < 0.8 * speed[-120]


def test_a_hand_held_still_trembles_by_millimetres() -> None:
    time = np.arange(0, 20, 0.04)
    moved = tremor(np.random.default_rng(1), time, 0.004)
    assert 0.001 < moved.std(axis=0).max() < 0.004 * 2
    assert np.array_equal(moved, tremor(np.random.default_rng(1), time, 0.004))
