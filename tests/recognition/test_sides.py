"""Exchanged sides: found and undone, and left alone where hands really cross."""

import numpy as np
import pytest

from app.recognition.landmarks import other_side
from app.recognition.sides import PARTS, with_sides_repaired
from app.recognition.trajectory import Trajectory
from tests.recognition.strategies import circle, recording


def shown() -> Trajectory:
    return Trajectory.from_poses(recording(circle, jitter=0.005))


def exchanged(trajectory: Trajectory, frames: list[int]) -> Trajectory:
    body = [f"{side}_{part}" for side in ("left", "right") for part in PARTS]
    xy = trajectory.xy.copy()
    for name in [name for name in trajectory.landmarks if name in body]:
        column = trajectory.landmarks.index(name)
        other = trajectory.landmarks.index(other_side(name))
        xy[frames, column] = trajectory.xy[frames, other]
    return Trajectory(
        landmarks=trajectory.landmarks, xy=xy, time=trajectory.time, unit=trajectory.unit
    )


@pytest.mark.parametrize(
    "frames", [[7], [3, 4, 20, 21, 22, 40], list(range(10, 30)), [0, 1, 2], [57, 58, 59]]
)
def test_mistaken_frames_are_undone(frames: list[int]) -> None:
    seen = exchanged(shown(), frames)
    np.testing.assert_array_equal(with_sides_repaired(seen).xy, shown().xy)


def test_a_steady_recording_is_left_alone() -> None:
    trajectory = shown()
    assert with_sides_repaired(trajectory) is trajectory


def test_hands_that_cross_stay_what_they_are() -> None:
    poses = recording(circle)
    xy = poses.xy.copy()
    sweep = np.linspace(-1, 1, len(xy))
    for hand, way in (("left_wrist", 120 * sweep), ("right_wrist", -120 * sweep)):
        xy[:, poses.landmarks.index(hand)] = np.stack([320 + way, 200 + 0 * way], axis=1)
    crossing = Trajectory(
        landmarks=poses.landmarks, xy=xy / 120, time=poses.time, unit="torso_length"
    )
    assert with_sides_repaired(crossing) is crossing


def test_frames_between_the_sides_are_not_believed() -> None:
    seen = exchanged(shown(), list(range(20, 40)))
    xy = seen.xy.copy()
    xy[[19, 40]] = (seen.xy[[18, 41]] + seen.xy[[21, 38]]) / 2
    repaired = with_sides_repaired(
        Trajectory(landmarks=seen.landmarks, xy=xy, time=seen.time, unit=seen.unit)
    )
    blended = np.isnan(repaired.xy).all(axis=(1, 2))
    assert np.flatnonzero(blended).tolist() == [19, 40]


def test_hands_without_a_body_are_left_alone() -> None:
    hands = exchanged(shown(), [7, 20, 21]).select(["left_wrist", "right_wrist"])
    assert with_sides_repaired(hands) is hands


def test_a_set_with_one_hand_has_no_sides_to_exchange() -> None:
    one = shown().select(["right_wrist", "right_elbow"])
    assert with_sides_repaired(one) is one
