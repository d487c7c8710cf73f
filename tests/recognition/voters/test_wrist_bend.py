"""The wrist voter: what it tells apart, and when it has little information."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.features.motion import build_movement
from app.recognition.poses.sequence import FloatArray, PoseSequence
from app.recognition.poses.trajectory import Trajectory
from app.recognition.voters.motion_voters import MotionVoter, Path, WristBend
from tests.recognition.strategies import recording, rest

HANDS = ("left_wrist", "right_wrist")
FRAMES = 60

Bend = Callable[[FloatArray], FloatArray]
"""Maps shares of the duration to radians from the forearm to the hand."""


def held(angle: float) -> Bend:
    return lambda share: np.full_like(share, angle)


def waving(angle: float) -> Bend:
    return lambda share: angle + 0.6 * np.sin(25 * share)


def raised(bend: Bend, *, side: str = "right", resting: float = 0.0) -> PoseSequence:
    """Record an arm that is raised sideways and lowered, its wrist bent; the other one rests.

    `resting`: the bend of the wrist that rests.
    """
    poses = recording(rest, frames=FRAMES)
    xy = poses.xy.copy()
    share = np.linspace(0, 1, FRAMES)
    arms = {"left": 0 * share, "right": 0 * share}
    arms[side] = 1.5 * np.sin(np.pi * share)
    for name, lifted in arms.items():
        outward = 1 if name == "left" else -1
        bent = bend(share) if name == side else held(resting)(share)
        elbow, wrist, index, pinky = (
            poses.landmarks.index(f"{name}_{part}") for part in ("elbow", "wrist", "index", "pinky")
        )
        xy[:, wrist] = xy[:, elbow] + 60 * pointing(lifted, outward)
        xy[:, index] = xy[:, pinky] = xy[:, wrist] + 20 * pointing(lifted + bent, outward)
    return replace(poses, xy=xy)


def pointing(angle: FloatArray, outward: int) -> FloatArray:
    """Point down at 0, outward at a quarter turn."""
    return np.stack([outward * np.sin(angle), np.cos(angle)], axis=1)


def leaning(poses: PoseSequence, angle: float) -> PoseSequence:
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    centre = np.array(poses.frame_size) / 2
    return replace(poses, xy=(poses.xy - centre) @ turn + centre)


def distance(one: PoseSequence, other: PoseSequence, voter: MotionVoter | None = None) -> float:
    voter = voter or WristBend()
    query, reference = (
        voter.describe(build_movement(Trajectory.from_poses(poses), HANDS))
        for poses in (one, other)
    )
    return float(voter.distances(query, reference[None])[0])


def test_a_wrist_bent_up_is_none_bent_down_though_the_paths_agree() -> None:
    up, down = raised(held(0.4)), raised(held(-0.4))
    assert distance(up, down, Path()) == 0.0
    assert distance(up, down) > 2.5
    assert distance(up, raised(held(0.5))) < 0.5


@given(lean=st.floats(-1.2, 1.2))
def test_it_does_not_matter_how_the_diver_leans(lean: float) -> None:
    shown = raised(held(0.4))
    assert distance(shown, leaning(shown, lean)) == pytest.approx(0.0, abs=1e-6)


def test_an_arm_at_rest_may_bend_as_it_likes() -> None:
    relaxed, tense = raised(held(0.4)), raised(held(0.4), resting=1.0)
    assert distance(relaxed, tense) < 0.01


def test_a_wrist_that_waves_has_less_to_tell_than_one_that_is_held() -> None:
    still = distance(raised(held(0.3)), raised(held(-0.3)))
    assert distance(raised(waving(0.3)), raised(waving(-0.3))) < 0.6 * still


def test_the_same_arm_must_be_seen_in_both() -> None:
    shown = raised(held(0.4))
    handless = shown.select((*HANDS, "left_shoulder", "right_shoulder"))
    assert distance(shown, handless) == np.inf
    right = tuple(name for name in shown.landmarks if not name.startswith("left"))
    one_armed = shown.select((*right, "left_shoulder", "left_hip"))
    assert distance(shown, one_armed) == pytest.approx(0.0, abs=1e-9)
