"""Salience: only the few landmarks whose motion is the gesture are salient."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition import GestureError, PoseSequence
from app.recognition.poses.landmarks import POSE_LANDMARKS
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.salience import (
    LEAST_DISPLACEMENT,
    choose_landmarks,
    find_salient_landmarks,
    measure_displacements,
)
from tests.recognition.strategies import Shape, circle, line, recording, recordings, rest, strokes


def salient(poses: PoseSequence) -> tuple[str, ...]:
    return find_salient_landmarks(Trajectory.from_poses(poses))


def with_path(poses: PoseSequence, name: str, offsets: FloatArray) -> PoseSequence:
    """Add offsets ``(T, 2)``, in torso lengths of 120 pixels, to one landmark's path."""
    xy = poses.xy.copy()
    xy[:, poses.landmarks.index(name)] += offsets * 120
    return replace(poses, xy=xy)


def sway(width: float, frames: int = 60) -> FloatArray:
    share = np.linspace(0, 1, frames)
    return np.stack([width / 2 * np.sin(2 * np.pi * share), np.zeros(frames)], axis=1)


def test_displacement_is_peak_to_peak_in_torso_lengths() -> None:
    measured = measure_displacements(Trajectory.from_poses(recording(line)))
    assert measured["right_wrist"] == pytest.approx(0.9, abs=1e-6)  # 5 to 95 % of a line of 1
    assert measured["left_wrist"] == pytest.approx(0.0, abs=1e-6)


def test_a_landmark_never_seen_has_no_displacement() -> None:
    poses = recording(circle)
    xy = poses.xy.copy()
    xy[:, POSE_LANDMARKS.index("nose")] = np.nan
    assert measure_displacements(Trajectory.from_poses(replace(poses, xy=xy)))["nose"] == 0.0


@given(strokes(), st.sampled_from(["left_wrist", "right_wrist", "nose"]))
def test_the_landmark_that_moves_is_the_salient_one(stroke: Shape, name: str) -> None:
    assert salient(recording(stroke, hand=name, jitter=0.01)) == (name,)


def test_two_hands_that_gesture_together_are_both_salient() -> None:
    both = with_path(recording(circle), "left_wrist", sway(0.7))
    assert salient(both) == ("left_wrist", "right_wrist")


def test_a_hand_that_only_sculls_is_not_salient() -> None:
    assert salient(with_path(recording(line), "left_wrist", sway(0.35))) == ("right_wrist",)


def test_hand_stands_for_its_fingers_and_elbow_and_legs_never_count() -> None:
    poses = recording(rest)
    for name in ("right_wrist", "right_index", "right_thumb", "right_elbow", "left_ankle"):
        poses = with_path(poses, name, sway(1.0))
    assert salient(poses) == ("right_wrist",)


def test_an_elbow_carries_a_gesture_in_which_no_hand_moves() -> None:
    poses = with_path(recording(rest, jitter=0.005), "left_elbow", sway(0.5))
    assert salient(poses) == ("left_elbow",)


def test_a_small_gesture_is_carried_by_what_moves_most() -> None:
    poses = with_path(recording(rest, jitter=0.005), "right_wrist", sway(0.25))
    assert salient(poses) == ("right_wrist",)


def test_a_body_that_sways_shows_nothing() -> None:
    assert salient(with_path(recording(rest, jitter=0.01), "right_wrist", sway(0.1))) == ()


def test_a_finger_stands_for_its_hand_where_the_wrist_is_not_in_the_set() -> None:
    names = tuple(name for name in POSE_LANDMARKS if name != "right_wrist")
    poses = with_path(recording(rest, landmarks=names), "right_index", sway(1.0))
    assert salient(poses) == ("right_index",)


def test_landmarks_of_another_set_each_stand_for_themselves() -> None:
    poses = recording(circle, hand="marker", landmarks=("marker", "tool", "base"))
    assert salient(with_path(poses, "tool", sway(0.8))) == ("marker", "tool")


def test_two_frames_in_which_a_landmark_jumps_do_not_make_it_salient() -> None:
    jumps = np.zeros((60, 2))
    jumps[[20, 41]] = 3.0
    assert salient(with_path(recording(circle), "left_wrist", jumps)) == ("right_wrist",)


@given(recordings())
def test_nothing_is_salient_in_a_diver_at_rest(poses: PoseSequence) -> None:
    still = recording(rest, frames=len(poses), jitter=0.03, seed=len(poses))
    assert salient(still) == ()


def test_the_threshold_is_in_torso_lengths_not_in_pixels() -> None:
    for torso in (20.0, 400.0):
        assert salient(recording(circle, torso=torso)) == ("right_wrist",)
        below = with_path(
            recording(rest, torso=torso),
            "right_wrist",
            sway(LEAST_DISPLACEMENT * 0.98) * torso / 120,
        )
        assert salient(below) == ()


def test_the_author_may_choose_any_landmark_that_is_seen() -> None:
    whole = Trajectory.from_poses(recording(circle))
    assert choose_landmarks(whole, ["right_wrist", "left_ankle"]) == ("right_wrist", "left_ankle")


@pytest.mark.parametrize(
    ("choice", "complaint"),
    [
        ([], "one or more landmark names"),
        ("right_wrist", "one or more landmark names"),
        (["right_wrist", "right_wrist"], "names a landmark twice"),
        (["tail"], "'tail' is not in this recording; it has nose"),
        (["nose"], "'nose' is never seen"),
    ],
)
def test_a_choice_that_does_not_fit_the_recording_is_refused(
    choice: list[str], complaint: str
) -> None:
    poses = recording(circle)
    xy = poses.xy.copy()
    xy[:, POSE_LANDMARKS.index("nose")] = np.nan
    with pytest.raises(GestureError, match=complaint):
        choose_landmarks(Trajectory.from_poses(replace(poses, xy=xy)), choice)
