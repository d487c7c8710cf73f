"""Holds: which shapes a take holds one after the other, and when."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.recognition.poses.frame import HandShape
from app.recognition.poses.sequence import PoseSequence
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.holds import Hold, describe_excess, find_holds, keep_holds
from tests.recognition.held_takes import FIST, FLAT, TWO, fingers, follow, hold

SHAPES = {"flat": FLAT, "fist": FIST, "two": TWO, "one": fingers(0)}


def found(poses: PoseSequence) -> tuple[Hold, ...]:
    return find_holds(poses, Trajectory.from_poses(poses))


def shape_of(hand: HandShape) -> str:
    """Return the name of the shape that a hand shows."""
    shown = {name: found(hold(each))[0].hands[0] for name, each in SHAPES.items()}
    return min(shown, key=lambda name: float(np.abs(hand.xy - shown[name].xy).max()))


def changing(share: float) -> PoseSequence:
    """Return a take in which a hand is flat first, and from a share of the time on a fist."""
    frames = round(40 * share)
    return follow(hold(FLAT, frames=frames), hold(FIST, frames=40 - frames), transition=0)


@pytest.mark.parametrize("share", [0.4, 0.5, 0.6])
def test_a_hand_that_changes_its_shape_holds_two(share: float) -> None:
    flat, fist = found(changing(share))
    assert shape_of(flat.hands[0]) == "flat"
    assert shape_of(fist.hands[0]) == "fist"
    assert fist.start == pytest.approx(round(40 * share) / 25)
    assert flat.end == pytest.approx(fist.start - 1 / 25)


@pytest.mark.parametrize("share", [0.2, 0.85])
def test_a_shape_that_is_seen_for_a_moment_is_none(share: float) -> None:
    (only,) = found(changing(share))
    assert shape_of(only.hands[0]) == ("fist" if share < 0.5 else "flat")


@pytest.mark.parametrize("unseen", [False, True])
@pytest.mark.parametrize("transition", [0.1, 0.4, 1.0])
@pytest.mark.parametrize("seconds", [0.8, 2.0])
def test_the_change_may_be_quick_or_slow_and_unseen(
    transition: float, unseen: bool, seconds: float
) -> None:
    takes = (hold(shape, frames=round(25 * seconds), seed=3) for shape in (TWO, FIST))
    first, second = found(follow(*takes, transition=transition, unseen=unseen))
    alone = [found(hold(shape))[0].hands[0] for shape in (TWO, FIST)]
    for seen, shown in zip((first.hands[0], second.hands[0]), alone, strict=True):
        assert np.sqrt(((seen.xy - shown.xy) ** 2).sum(axis=1).mean()) < 0.1
    assert first.start == 0
    assert first.end <= second.start <= first.end + transition + 0.1


def test_a_shape_held_throughout_is_one_however_it_wobbles() -> None:
    takes = [hold(FLAT, roll=roll, frames=20) for roll in (-12, 12, -12, 12)]
    assert len(found(follow(*takes))) == 1


def test_a_shake_is_no_sequence() -> None:
    shaken = [hold(FLAT, roll=roll, frames=20) for roll in (-22, 22)]
    assert len(found(follow(*shaken, transition=0))) == 1
    turned = [hold(FLAT, roll=roll, frames=20) for roll in (-40, 40)]
    assert len(found(follow(*turned, transition=0))) == 2


def test_a_shape_that_is_shown_for_a_fifth_of_a_second_is_not_held() -> None:
    quick = follow(hold(FLAT, frames=6), hold(FIST, frames=6), transition=0)
    assert len(found(quick)) < 2
    slow = follow(hold(FLAT, frames=10), hold(FIST, frames=10), transition=0)
    assert len(found(slow)) == 2


def test_two_shapes_that_are_near_are_two_where_both_are_held_still() -> None:
    assert len(found(follow(hold(TWO), hold(FLAT)))) == 2
    wobbling = [hold(shape, roll=roll, frames=5) for shape in (TWO, FLAT) for roll in 4 * (-20, 20)]
    assert len(found(follow(*wobbling, transition=0))) == 1


@pytest.mark.parametrize("transition", [0.6, 1.0, 1.4])
def test_a_slow_change_between_very_different_shapes_is_no_third_one(transition: float) -> None:
    takes = hold(TWO, roll=-60, frames=25), hold(FIST, roll=100, frames=25)
    assert len(found(follow(*takes, transition=transition))) == 2


@settings(deadline=None, max_examples=30)
@given(seed=st.integers(0, 2**32 - 1), frames=st.integers(3, 40))
def test_hands_at_random_are_divided_without_an_error(seed: int, frames: int) -> None:
    """As when a hand model finds a hand in bubbles; some parts have no frame of their own shape."""
    random = np.random.default_rng(seed)
    take = hold(FLAT, frames=frames)
    assert take.hands is not None
    noise = random.normal(0, random.choice([5.0, 40.0]), take.hands.shape)
    holds = found(replace(take, hands=take.hands + noise))
    assert len(holds) <= 3
    assert all(one.end <= other.start for one, other in pairwise(holds))


@pytest.mark.parametrize("lengths", [(25, 25, 25), (30, 25, 35), (20, 40, 20)])
def test_three_shapes_are_three(lengths: tuple[int, int, int]) -> None:
    takes = [hold(each, frames=n) for each, n in zip((FLAT, FIST, TWO), lengths, strict=True)]
    assert len(found(follow(*takes, transition=0.2))) == 3


def test_the_moments_of_the_changes_are_told() -> None:
    takes = [hold(shape, frames=25) for shape in (FLAT, FIST, TWO)]
    words = describe_excess(found(follow(*takes, transition=0)))
    assert "the second from 1.0 s and the third from 2.0 s on" in words


def test_a_hand_that_keeps_its_shape_beside_one_that_changes_is_in_both() -> None:
    take = follow(hold(FLAT), hold(FIST))
    other = follow(hold(TWO, left=True), hold(TWO, left=True))
    assert take.hands is not None
    assert other.hands is not None
    both = take.hands.copy()
    both[:, 0] = other.hands[:, 0]
    first, second = found(replace(take, hands=both))
    assert [hand.side for hand in first.hands] == [hand.side for hand in second.hands]
    assert [shape_of(hand.hands[0].mirror()) for hand in (first, second)] == ["two", "two"]
    assert [shape_of(hand.hands[1]) for hand in (first, second)] == ["flat", "fist"]
    both[70:, 0] = np.nan
    both[:30, 0] = np.nan
    seen_once = found(replace(take, hands=both))
    assert [[hand.side for hand in each.hands] for each in seen_once] == [["right"], ["right"]]


def test_where_the_hand_moves_clearly_nothing_is_held() -> None:
    around = np.linspace(0, 4 * np.pi, 80)
    path = 0.4 * np.column_stack([np.cos(around), np.sin(around)])
    takes = hold(FLAT, moving=path[:40]), hold(FIST, moving=path[40:])
    assert found(follow(*takes, transition=0)) == ()
    assert found(replace(hold(FLAT), hands=None)) == ()


def test_a_trajectory_keeps_one_shape_or_two_and_no_more() -> None:
    takes = [hold(shape, frames=25) for shape in (FLAT, FIST, TWO)]
    for count, kept in ((0, 0), (1, 1), (2, 2), (3, 0)):
        poses = follow(*takes[:count]) if count else replace(takes[0], hands=None)
        trajectory = Trajectory.from_poses(poses)
        assert len(keep_holds(trajectory, find_holds(poses, trajectory)).held_shapes) == kept
