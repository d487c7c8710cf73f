"""Jumps: places that no arm could have reached and left again in the time."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.outliers import MOST_JUMPS, find_outliers
from tests.recognition.strategies import Shape, circle, line, recording, square, strokes, wedge

COLUMN = Trajectory.from_poses(recording(circle)).landmarks.index("right_wrist")


def thrown_off(trajectory: Trajectory, frames: list[int], by: tuple[float, float]) -> Trajectory:
    xy: FloatArray = trajectory.xy.copy()
    xy[frames, COLUMN] += by
    return Trajectory(
        landmarks=trajectory.landmarks, xy=xy, time=trajectory.time, unit=trajectory.unit
    )


def found(trajectory: Trajectory) -> list[int]:
    off = find_outliers(trajectory)
    assert not np.delete(off, COLUMN, axis=1).any()
    return np.flatnonzero(off[:, COLUMN]).tolist()


@pytest.mark.parametrize(
    "frames", [[10], [10, 11], [20, 21, 22], [5, 15, 25, 35], [30, 31, 34], [1, 58]]
)
@pytest.mark.parametrize("by", [(0.7, 0.0), (-0.8, 1.1)])
def test_places_far_off_are_found_and_no_others(frames: list[int], by: tuple[float, float]) -> None:
    trajectory = Trajectory.from_poses(recording(circle, jitter=0.01))
    assert found(thrown_off(trajectory, frames, by)) == frames


@pytest.mark.parametrize("shape", [circle, wedge, line, square])
@pytest.mark.parametrize("frames", [8, 15, 60])
def test_quick_strokes_with_sharp_corners_are_no_jumps(shape: Shape, frames: int) -> None:
    assert found(Trajectory.from_poses(recording(shape, frames=frames, rate=15))) == []


def test_trembling_is_no_jump() -> None:
    assert found(Trajectory.from_poses(recording(circle, jitter=0.1))) == []


def test_who_jumps_all_the_time_is_left_alone() -> None:
    trajectory = Trajectory.from_poses(recording(circle))
    many = np.arange(2, 58, 2)
    assert len(many) > MOST_JUMPS * len(trajectory)
    assert found(thrown_off(trajectory, many.tolist(), (1.0, 0.0))) == []


def test_a_slow_camera_sees_no_jumps() -> None:
    """Between two frames half a second apart an arm can be anywhere."""
    slow = Trajectory.from_poses(recording(circle, frames=10, rate=2))
    assert found(thrown_off(slow, [4], (0.9, 0.0))) == []


@given(strokes(), st.integers(1, 48), st.floats(0.7, 3), st.floats(0, 2 * np.pi))
def test_one_far_place_in_any_movement_is_found(
    shape: Shape, frame: int, far: float, angle: float
) -> None:
    trajectory = Trajectory.from_poses(recording(shape, frames=50))
    by = (far * np.cos(angle), far * np.sin(angle))
    assert found(thrown_off(trajectory, [frame], by)) == [frame]


def test_a_jab_is_no_jump() -> None:
    """There and back over half a torso length (25 cm), as fast as an arm can accelerate."""

    def jab(share: FloatArray) -> FloatArray:
        away = 0.5 * np.exp(-0.5 * ((share - 0.5) / 0.05) ** 2)
        return np.stack([-0.7 - away, 0.3 * share], axis=1)

    assert found(Trajectory.from_poses(recording(jab, frames=15, rate=15))) == []


@pytest.mark.parametrize("rate", [5, 8, 15, 30, 60])
def test_a_hand_that_jumps_and_goes_on_is_found_at_every_rate(rate: int) -> None:
    trajectory = Trajectory.from_poses(recording(circle, frames=3 * rate, rate=rate))
    assert found(thrown_off(trajectory, [rate], (0.9, 1.6))) == [rate]


def test_what_a_tracker_blends_on_its_way_back_is_no_place_either() -> None:
    trajectory = Trajectory.from_poses(recording(line, frames=45, rate=15))
    jumped = thrown_off(trajectory, [20], (0.3, 0.6))
    assert found(thrown_off(jumped, [21], (0.06, 0.12))) == [20, 21]
