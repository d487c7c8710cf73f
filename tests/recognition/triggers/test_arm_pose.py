"""Arm poses: learned from one demonstration, with a score of how closely a body holds them."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.errors import TriggerError
from app.recognition.poses.sequence import PoseSequence
from app.recognition.recording.salute import ENTER_SCORE
from app.recognition.triggers.trigger import ARM_JOINTS, HANGING_ARMS, ArmPose, locate_arms
from tests.posed import belly_pose, head_pose, posed_recording
from tests.recognition.strategies import BODY, circle, recording, rest

ARMS = tuple(BODY)


def held(**wrists: tuple[float, float]) -> PoseSequence:
    """Make a body that holds its wrists at places from the torso's centre, with some jitter."""
    poses = recording(rest, landmarks=ARMS, jitter=0.01)
    centre, length = poses.torso_centre(), poses.torso_length()
    assert centre is not None
    assert length is not None
    xy = poses.xy.copy()
    for name, place in wrists.items():
        xy[:, ARMS.index(name)] = centre + length * np.array(place)
    return replace(poses, xy=xy)


def test_the_pose_is_where_the_joints_are_held() -> None:
    pose = ArmPose.from_poses(held(left_wrist=(0.1, -1.0)))
    assert pose.joints["left_wrist"] == pytest.approx((0.1, -0.5), abs=0.05)
    assert pose.joints["right_elbow"] == pytest.approx((-0.45, 0.5), abs=0.05)
    assert pose.words == "left hand at the head"


def test_the_most_still_moment_of_a_clip_is_the_pose_and_not_hanging_arms() -> None:
    whole = ArmPose.from_poses(posed_recording("circle-by-belly").poses)
    assert whole.resembles(belly_pose()) > 0.8


@given(
    scale=st.floats(0.2, 5),
    shift=st.tuples(st.floats(-900, 900), st.floats(-900, 900)),
)
def test_the_score_depends_on_neither_place_nor_size(
    scale: float, shift: tuple[float, float]
) -> None:
    poses = posed_recording("circle-by-belly-2").poses
    moved = replace(poses, xy=scale * poses.xy + np.array(shift))
    pose = belly_pose()
    expected = pose.score(locate_arms(poses))
    assert pose.score(locate_arms(moved)) == pytest.approx(expected, abs=1e-6)


def test_a_frame_scores_alone_as_in_its_recording() -> None:
    poses, pose = posed_recording("circle-by-belly").poses, head_pose()
    alone = [pose.score(locate_arms(poses.between(time, time)))[0] for time in poses.time.tolist()]
    assert np.array_equal(alone, pose.score(locate_arms(poses)))


def test_other_people_in_other_views_hold_the_pose_too() -> None:
    for name in ("circle-by-belly-2", "wedge-by-belly"):
        shown = posed_recording(name).poses.between(1.2, 2.0)
        assert np.mean(belly_pose().score(locate_arms(shown)) > ENTER_SCORE) > 0.9


def test_another_pose_and_hanging_arms_are_not_this_one() -> None:
    assert belly_pose().resembles(head_pose()) == 0
    assert belly_pose().score(np.array([HANGING_ARMS]))[0] < 0.3


@pytest.mark.parametrize("hidden", [*ARM_JOINTS, "left_shoulder"])
def test_a_joint_that_is_not_seen_scores_nothing(hidden: str) -> None:
    poses = held(left_wrist=(0.1, -1.0))
    pose = ArmPose.from_poses(poses)
    xy = poses.xy.copy()
    xy[:, ARMS.index(hidden)] = np.nan
    assert not pose.score(locate_arms(replace(poses, xy=xy))).any()
    others = tuple(name for name in ARMS if name != hidden)
    assert not pose.score(locate_arms(poses.select(others))).any()


def test_without_hips_the_shoulders_give_the_size() -> None:
    poses = held(left_wrist=(0.1, -1.0))
    seen = poses.select([name for name in ARMS if "hip" not in name])
    assert ArmPose.from_poses(poses).score(locate_arms(seen)).min() > ENTER_SCORE


def test_hanging_arms_are_refused_because_they_hang_most_of_the_time() -> None:
    with pytest.raises(TriggerError, match=r"arms hang whenever they are still.*on the head"):
        ArmPose.from_poses(recording(rest, landmarks=ARMS))
    with pytest.raises(TriggerError, match="both arms hang or nearly so"):
        ArmPose(HANGING_ARMS)


def test_arms_that_move_all_the_time_show_no_pose() -> None:
    with pytest.raises(TriggerError, match=r"never still for 0\.5 s.*mark the range"):
        ArmPose.from_poses(recording(circle, landmarks=ARMS))


def test_arms_out_of_the_picture_show_no_pose() -> None:
    poses = held(left_wrist=(0.1, -1.0))
    with pytest.raises(TriggerError, match=r"never seen.*from the front"):
        ArmPose.from_poses(replace(poses, xy=np.full_like(poses.xy, np.nan)))
    with pytest.raises(TriggerError, match=r"this lasts 0\.\d+ s: mark a longer range"):
        ArmPose.from_poses(poses.between(0, 0.2))
    with pytest.raises(TriggerError, match="mark a longer range"):
        ArmPose.from_poses(poses.between(90, 91))


def test_numbers_that_are_none_are_refused() -> None:
    with pytest.raises(TriggerError, match="needs x and y of left_elbow"):
        ArmPose(((0.1, np.nan), *HANGING_ARMS[1:]))
