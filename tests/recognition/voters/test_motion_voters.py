"""Motion voters: laws that hold for each, and what each of them alone can tell."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.features.motion import Movement, build_movement
from app.recognition.poses.sequence import PoseSequence
from app.recognition.poses.trajectory import Trajectory
from app.recognition.voters.motion_voters import (
    MotionVoter,
    Path,
    Place,
    SecondOpinion,
    Tempo,
    Velocity,
)
from app.recognition.voters.registry import MOTION_VOTERS
from tests.recognition.strategies import Shape, circle, line, recording, recordings

HANDS = ("left_wrist", "right_wrist")


def moved(poses: PoseSequence) -> Movement:
    return build_movement(Trajectory.from_poses(poses), HANDS)


def distance(voter: MotionVoter, one: Movement, other: Movement) -> float:
    return float(voter.distances(voter.describe(one), voter.describe(other)[None])[0])


def backwards(shape: Shape) -> Shape:
    return lambda share: shape(1 - share)


@pytest.mark.parametrize("voter", MOTION_VOTERS, ids=lambda voter: voter.name)
@given(one=recordings(), other=recordings())
def test_a_distance_is_zero_to_itself_and_the_same_either_way(
    voter: MotionVoter, one: PoseSequence, other: PoseSequence
) -> None:
    first, second = moved(one), moved(other)
    assert distance(voter, first, first) == 0.0
    there, back = distance(voter, first, second), distance(voter, second, first)
    assert there >= 0.0
    # Step costs are roots of numbers in single precision, right to a millionth.
    assert there == pytest.approx(back, abs=3e-3)


@pytest.mark.parametrize("voter", MOTION_VOTERS, ids=lambda voter: voter.name)
@given(poses=recordings(), scale=st.floats(0.3, 3.0), shift=st.floats(-200, 200))
def test_the_camera_does_not_matter(
    voter: MotionVoter, poses: PoseSequence, scale: float, shift: float
) -> None:
    elsewhere = replace(poses, xy=poses.xy * scale + shift, time=poses.time + 7.0)
    assert distance(voter, moved(poses), moved(elsewhere)) == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("voter", [Path(), Velocity()], ids=lambda v: v.name)
@pytest.mark.parametrize("shape", [circle, line])
def test_the_way_round_is_seen(voter: MotionVoter, shape: Shape) -> None:
    shown, turned = moved(recording(shape)), moved(recording(backwards(shape)))
    again = moved(recording(shape, frames=41, jitter=0.005))
    assert distance(voter, shown, again) < 0.4 * distance(voter, shown, turned)


def test_tempo_counts_doublings() -> None:
    slow, quick = moved(recording(circle, rate=15.0)), moved(recording(circle, rate=30.0))
    assert distance(Tempo(), slow, quick) == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize("voter", [Velocity(), Place()], ids=lambda v: v.name)
def test_the_hand_that_moves_is_seen(voter: MotionVoter) -> None:
    right, left = (moved(recording(circle, hand=hand)) for hand in reversed(HANDS))
    again = moved(recording(circle, frames=41, jitter=0.005, hand=HANDS[1]))
    assert distance(voter, right, again) < 0.4 * distance(voter, right, left)


def shifted(poses: PoseSequence, share: float) -> PoseSequence:
    """Move the moving arm's elbow and wrist down by a share of the torso."""
    xy = poses.xy.copy()
    length = poses.torso_length()
    assert length is not None
    for part in ("wrist", "elbow"):
        xy[:, poses.landmarks.index(f"right_{part}"), 1] += share * length
    return replace(poses, xy=xy)


def test_place_sees_where_a_figure_is_drawn_and_no_other_voter_does() -> None:
    high, low = moved(recording(circle)), moved(shifted(recording(circle), 0.5))
    assert distance(Place(), high, low) == pytest.approx(2**0.5 * 0.5, rel=0.15)
    for voter in (Velocity(), Path(), SecondOpinion()):
        assert distance(voter, high, low) == pytest.approx(0.0, abs=1e-6)


def test_without_a_torso_no_place_is_compared_and_there_is_no_second_opinion() -> None:
    wrists = moved(recording(circle).select(HANDS))
    assert distance(Place(), wrists, wrists) == distance(SecondOpinion(), wrists, wrists) == np.inf


def test_the_second_opinion_does_not_know_speed() -> None:
    steady, hurried, other = (
        moved(recording(shape)) for shape in (circle, lambda share: circle(share**1.5), line)
    )
    voter = SecondOpinion()
    assert distance(voter, steady, hurried) < 0.1 * distance(voter, steady, other)


def rested(poses: PoseSequence, frames: int) -> PoseSequence:
    """Repeat the first and the last frame: the arms rest before and after the gesture."""
    index = np.r_[np.zeros(frames, int), np.arange(len(poses)), np.full(frames, len(poses) - 1)]
    step = float(np.median(np.diff(poses.time)))
    return replace(
        poses, xy=poses.xy[index], time=np.arange(float(len(index))) * step, confidence=None
    )


@pytest.mark.parametrize("voter", [Velocity(), Place()], ids=lambda v: v.name)
def test_rests_at_both_ends_do_not_matter(voter: MotionVoter) -> None:
    alone, resting = moved(recording(circle)), moved(rested(recording(circle), 20))
    assert distance(voter, alone, resting) < 0.2 * distance(voter, alone, moved(recording(line)))


def test_a_drifting_diver_is_no_part_of_the_gesture() -> None:
    poses = recording(circle)
    drift = np.linspace(0, 150, len(poses))[:, None, None] * (1.0, 0.4)
    drifting = moved(replace(poses, xy=poses.xy + drift))
    for voter in (Velocity(), Place()):
        assert distance(voter, moved(poses), drifting) == pytest.approx(0.0, abs=1e-6)


def test_a_leaning_body_is_part_of_the_gesture() -> None:
    poses = recording(circle)
    lean = 60 * np.sin(np.linspace(0, np.pi, len(poses)))[:, None, None] * (1.0, 0.0)
    leaning = moved(replace(poses, xy=poses.xy + lean))
    assert distance(Velocity(), moved(poses), leaning) > 0.1
