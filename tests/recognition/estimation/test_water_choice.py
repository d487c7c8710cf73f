"""The choice of a correction: by detection scores, changed seldom, examined seldom."""

from __future__ import annotations

import numpy as np

from app.recognition.estimation.water import (
    CORRECTIONS,
    FIRST_PAUSE,
    LONGEST_PAUSE,
    MARGIN,
    PATIENCE,
    SEARCHING_PAUSE,
    Correction,
    WaterChoice,
    measure_belief,
)
from app.recognition.poses.frame import Body, FrameLandmarks, Hand

NOBODY = FrameLandmarks(None, ())


def seen(score: float, *hands: float) -> FrameLandmarks:
    """Return a body and hands with the given scores."""
    return FrameLandmarks(
        Body(np.zeros((33, 2)), np.ones(33), score),
        tuple(Hand(np.zeros((21, 2)), "left", hand) for hand in hands),
    )


def examination(**better: FrameLandmarks) -> dict[Correction, FrameLandmarks]:
    """Return the result under every correction: nobody, except for the given ones."""
    return {one: better.get(one, NOBODY) for one in CORRECTIONS}


def examined_frames(choice: WaterChoice, found: FrameLandmarks, count: int) -> list[int]:
    return [index for index in range(count) if choice.needs_examination(found)]


def test_nothing_is_corrected_and_nothing_examined_where_body_and_hand_are_seen() -> None:
    choice = WaterChoice()
    assert examined_frames(choice, seen(0.99, 0.9), 1000) == []
    assert choice.correction == "none"


def test_the_first_frame_with_a_doubt_is_examined_at_once() -> None:
    for doubtful in (NOBODY, seen(0.99), seen(0.99, 0.3)):
        assert WaterChoice().needs_examination(doubtful)


def test_a_body_that_is_believed_little_is_a_doubt_when_it_stays_so() -> None:
    choice = WaterChoice()
    assert examined_frames(choice, seen(0.7, 0.9), PATIENCE + 1) == [PATIENCE]


def test_where_no_hands_are_looked_for_their_absence_is_no_doubt() -> None:
    assert not WaterChoice(hands=False).needs_examination(seen(0.99))


def test_the_correction_under_which_most_is_believed_is_chosen() -> None:
    choice = WaterChoice()
    assert choice.choose(examination(balanced=seen(0.6), contrasted=seen(0.9)))
    assert choice.correction == "contrasted"


def test_hands_decide_between_bodies_that_are_believed_alike() -> None:
    choice = WaterChoice()
    choice.choose(examination(none=seen(0.95), lightened=seen(0.95, 0.9)))
    assert choice.correction == "lightened"
    assert measure_belief(seen(0.9)) > measure_belief(FrameLandmarks(None, seen(1, 1, 1).hands))


def test_a_little_more_belief_changes_nothing() -> None:
    choice = WaterChoice()
    assert not choice.choose(examination(none=seen(0.8), balanced=seen(0.8 + MARGIN)))
    assert choice.correction == "none"


def test_one_frame_does_not_outweigh_those_before() -> None:
    choice = WaterChoice()
    for _ in range(3):
        choice.choose(examination(balanced=seen(0.9)))
    assert not choice.choose(examination(lightened=seen(0.99)))
    assert choice.correction == "balanced"


def test_examinations_get_rare_while_the_doubt_stays() -> None:
    frames = examined_frames(WaterChoice(), seen(0.99), 4 * LONGEST_PAUSE)
    pauses = np.diff(frames)
    assert frames[0] == 0
    assert pauses[0] == FIRST_PAUSE
    assert (np.diff(pauses) >= 0).all()
    assert pauses[-1] == LONGEST_PAUSE


def test_while_nobody_is_found_examinations_stay_frequent() -> None:
    frames = examined_frames(WaterChoice(), NOBODY, 4 * LONGEST_PAUSE)
    assert np.diff(frames).max() == SEARCHING_PAUSE


def test_later_a_change_needs_more_belief_than_at_first() -> None:
    better = examination(none=seen(0.8), contrasted=seen(0.8 + 1.5 * MARGIN))
    fresh, settled = WaterChoice(), WaterChoice()
    settled.choose(examination(none=seen(0.8), contrasted=seen(0.8)))
    assert fresh.choose(better)
    assert not settled.choose(better)


def test_frames_without_anybody_do_not_delay_the_choice() -> None:
    choice = WaterChoice()
    for _ in range(10):
        assert not choice.choose(examination())
    assert choice.choose(examination(balanced=seen(0.3)))


def test_a_hand_that_is_hidden_for_a_moment_is_no_reason() -> None:
    choice = WaterChoice()
    assert not choice.needs_examination(seen(0.99, 0.9))
    assert examined_frames(choice, seen(0.99), PATIENCE - 1) == []
    assert choice.needs_examination(seen(0.99))


def test_a_body_that_is_lost_is_examined_soon_again() -> None:
    choice = WaterChoice()
    examined_frames(choice, seen(0.99), 4 * LONGEST_PAUSE)
    assert examined_frames(choice, NOBODY, LONGEST_PAUSE // 2)[:1] <= [FIRST_PAUSE]


def test_after_a_reset_nothing_is_remembered() -> None:
    choice = WaterChoice()
    choice.choose(examination(balanced=seen(0.9)))
    choice.reset()
    assert choice.correction == "none"
    assert choice.needs_examination(NOBODY)
