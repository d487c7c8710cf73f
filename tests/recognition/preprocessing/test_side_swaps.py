"""Exchanged sides: found, and none found where hands really cross, meet or part."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.poses.landmarks import POSE_LANDMARKS, other_side
from app.recognition.poses.sequence import FloatArray, PoseSequence
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.repair import find_side_swaps, median, pair_sides
from tests.recognition.strategies import circle, recording


@given(st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=40))
def test_it_is_numpys(numbers: list[float]) -> None:
    assert median(np.array(numbers)) == np.median(numbers)


HANDS = ("left_wrist", "right_wrist")


def shown() -> Trajectory:
    return Trajectory.from_poses(recording(circle, jitter=0.005))


def with_sides_exchanged(trajectory: Trajectory, frames: list[int]) -> Trajectory:
    left, right = pair_sides(trajectory.landmarks)
    order = np.arange(len(trajectory.landmarks))
    order[[*left, *right]] = [*right, *left]
    xy = trajectory.xy.copy()
    xy[frames] = xy[frames][:, order]
    return Trajectory(
        landmarks=trajectory.landmarks, xy=xy, time=trajectory.time, unit=trajectory.unit
    )


def hands_at(left: FloatArray, right: FloatArray) -> Trajectory:
    """Two hands ``(T, 2)`` each without a body, 30 moments a second."""
    poses = PoseSequence(
        landmarks=HANDS,
        xy=320 + 120 * np.stack([left, right], axis=1),
        time=np.arange(len(left)) / 30,
        frame_size=(640, 640),
    )
    return Trajectory.from_poses(poses)


def level(x: FloatArray) -> FloatArray:
    return np.stack([x, np.zeros_like(x)], axis=1)


@pytest.mark.parametrize(
    "frames", [[7], [3, 4, 20, 21, 22, 40], list(range(10, 30)), [0, 1, 2], [57, 58, 59]]
)
@pytest.mark.parametrize("landmarks", [POSE_LANDMARKS, HANDS], ids=["body", "hands"])
def test_mistaken_frames_are_found(frames: list[int], landmarks: tuple[str, ...]) -> None:
    seen = with_sides_exchanged(shown().select(landmarks), frames)
    assert np.flatnonzero(find_side_swaps(seen).exchanged).tolist() == frames


def test_a_steady_recording_has_none() -> None:
    sides = find_side_swaps(shown())
    assert not sides.exchanged.any()
    assert not sides.blended.any()


def test_hands_that_cross_stay_what_they_are() -> None:
    sweep = np.sin(np.linspace(-np.pi / 2, np.pi / 2, 20))
    assert not find_side_swaps(hands_at(level(sweep), level(-sweep))).exchanged.any()


def test_hands_that_clap_stay_what_they_are() -> None:
    apart = 0.05 + np.abs(np.cos(np.linspace(0, 3 * np.pi, 90)))
    assert not find_side_swaps(hands_at(level(apart), level(-apart))).exchanged.any()


def test_a_frame_between_the_sides_is_blended() -> None:
    seen = with_sides_exchanged(shown(), list(range(20, 40)))
    xy = seen.xy.copy()
    xy[[19, 40]] = (seen.xy[[18, 41]] + seen.xy[[21, 38]]) / 2
    sides = find_side_swaps(
        Trajectory(landmarks=seen.landmarks, xy=xy, time=seen.time, unit=seen.unit)
    )
    assert np.flatnonzero(sides.blended).tolist() == [19, 40]
    assert np.flatnonzero(sides.exchanged).tolist() == list(range(20, 40))


def test_arms_that_are_still_blended_after_the_shoulders_are_found() -> None:
    seen = with_sides_exchanged(shown(), list(range(20, 40)))
    xy = seen.xy.copy()
    for name in ("elbow", "wrist"):
        left, right = (seen.landmarks.index(f"{side}_{name}") for side in ("left", "right"))
        xy[41:43, [left, right]] += 0.1 * (xy[41:43, [right, left]] - xy[41:43, [left, right]])
    sides = find_side_swaps(
        Trajectory(landmarks=seen.landmarks, xy=xy, time=seen.time, unit=seen.unit)
    )
    assert np.flatnonzero(sides.blended).tolist() == [41, 42]


def test_frames_that_show_nothing_are_passed_over() -> None:
    seen = with_sides_exchanged(shown(), list(range(20, 30)))
    xy = seen.xy.copy()
    xy[17:22] = np.nan
    sides = find_side_swaps(
        Trajectory(landmarks=seen.landmarks, xy=xy, time=seen.time, unit=seen.unit)
    )
    assert np.flatnonzero(sides.exchanged).tolist() == list(range(22, 30))


def test_one_side_cannot_be_exchanged() -> None:
    one = shown().select(["right_wrist", "right_elbow"])
    assert not find_side_swaps(one).exchanged.any()


def test_sides_are_found_by_other_trackers_names() -> None:
    assert pair_sides(("WristRight", "Head", "WristLeft")) == ((2,), (0,))
    assert other_side("head") == "head"
