"""Held hands: which takes hold a shape, and with which hand."""

from dataclasses import replace

import numpy as np

from app.recognition.poses.frame import HandShape
from app.recognition.poses.sequence import PoseSequence
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.holds import find_held_hands, rests_between_ends
from tests.recognition.held_takes import FIST, FLAT, hold


def found(poses: PoseSequence) -> tuple[HandShape, ...]:
    return find_held_hands(poses, Trajectory.from_poses(poses))


def test_a_still_hand_beside_the_face_is_held() -> None:
    assert [hand.side for hand in found(hold(FIST))] == ["right"]
    assert [hand.side for hand in found(hold(FIST, left=True))] == ["left"]


def test_a_hand_that_moves_clearly_is_not_held() -> None:
    turned = np.linspace(0, 2 * np.pi, 40)
    circle = 0.3 * np.column_stack([np.cos(turned), np.sin(turned)])
    assert found(hold(FLAT, moving=circle)) == ()


def test_a_hand_may_come_and_go_at_both_ends() -> None:
    coming = np.zeros((40, 2))
    coming[:6, 1], coming[-6:, 1] = np.linspace(0.5, 0, 6), np.linspace(0, 0.5, 6)
    poses = hold(FLAT, moving=coming)
    assert len(found(poses)) == 1
    assert rests_between_ends(Trajectory.from_poses(poses))
    assert rests_between_ends(Trajectory.from_poses(hold(FLAT)))


def test_a_small_movement_does_not_rest() -> None:
    there = 0.13 * np.sin(np.linspace(0, 2 * np.pi, 40))
    nod = hold(FLAT, moving=np.column_stack([0 * there, there]))
    assert not rests_between_ends(Trajectory.from_poses(nod))


def test_a_hanging_hand_shows_nothing() -> None:
    poses = hold(FLAT)
    assert poses.hands is not None
    both = poses.hands.copy()
    both[:, 0] = both[:, 1] + (240, 330)
    assert [hand.side for hand in found(replace(poses, hands=both))] == ["right"]


def test_a_hand_that_turns_round_has_no_shape() -> None:
    poses = hold(FLAT)
    assert poses.hands is not None
    turning = poses.hands.copy()
    for frame in range(len(poses)):
        wrist = turning[frame, 1, 0]
        angle = 2 * np.pi * frame / len(poses)
        turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        turning[frame, 1] = wrist + (turning[frame, 1] - wrist) @ turn
    assert found(replace(poses, hands=turning)) == ()


def test_a_hand_seen_in_a_few_frames_is_not_held() -> None:
    poses = hold(FIST)
    assert poses.hands is not None
    rare = poses.hands.copy()
    rare[10:] = np.nan
    assert found(replace(poses, hands=rare)) == ()
    assert found(replace(poses, hands=None)) == ()


def without_body(poses: PoseSequence) -> PoseSequence:
    """Return a take of which the right wrist and hand alone are seen."""
    return poses.select(["right_wrist"])


def test_a_hand_that_is_lifted_and_lowered_again_is_held() -> None:
    way = np.concatenate([np.linspace(0.7, 0, 10), np.zeros(20), np.linspace(0, 0.7, 10)])
    lifted = without_body(hold(FIST, moving=np.column_stack([0 * way, way])))
    (shape,) = found(lifted)
    (still,) = found(without_body(hold(FIST)))
    assert np.abs(shape.xy - still.xy).max() < 0.05


def test_a_hand_that_pauses_in_a_figure_is_not_held() -> None:
    way = np.concatenate([np.linspace(2.5, 0, 10), np.zeros(20), np.linspace(0, 2.5, 10)])
    assert found(without_body(hold(FIST, moving=np.column_stack([way, 0 * way])))) == ()
