"""Whose body counts where several people are seen: the saluting diver's, take by take."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pytest

from app.recognition.estimation.person_tracker import REUNION_SECONDS
from app.recognition.poses.frame import Body, FrameLandmarks, Hand
from app.recognition.poses.landmarks import HAND_LANDMARKS, POSE_LANDMARKS
from app.recognition.poses.sequence import FloatArray
from app.recognition.recording.live_segmentation import Followed, LiveTakes, PeopleInStream
from app.recognition.recording.people import (
    Choice,
    People,
    keep_person,
    prominence_over,
    see_people,
)
from app.recognition.recording.salute import LONGEST_TAKE, best_salute
from tests.recognition.parametric_hand import hand_xy, salute

RATE = 20
FRAME_SIZE = (1280, 720)
WRIST = POSE_LANDMARKS.index("right_wrist")
Spans = Sequence[tuple[float, float]]


@dataclass(frozen=True)
class Diver:
    """A diver at a place, who salutes at some times and draws circles at others."""

    x: float
    size: float = 200.0
    salutes: Spans = ()
    draws: Spans = ()
    seen: Spans = ((0.0, 1e9),)
    speed: float = 0.0

    def body(self, time: float) -> Body:
        """Return the body: points over a box, the right wrist where the hand is."""
        count = len(POSE_LANDMARKS)
        grid = np.stack([np.arange(count) % 5 / 8, np.arange(count) // 5 / 6], axis=1)
        xy = (self.x + self.speed * time, 200.0) + self.size * grid
        if _within(time, self.draws):
            angle = 2 * np.pi * time
            xy[WRIST] = xy[0] + self.size * (0.3 + 0.3 * np.array([np.cos(angle), np.sin(angle)]))
        return Body(xy, np.ones(count), 0.9)

    def hand(self, time: float) -> Hand:
        """Return the right hand at the wrist."""
        shape = hand_xy(salute()) if _within(time, self.salutes) else flat()
        shape = shape - shape[0]
        scale = 0.3 * self.size / np.linalg.norm(np.ptp(shape, axis=0))
        return Hand(self.body(time).xy[WRIST] + scale * shape, "right", 0.9)


def flat() -> FloatArray:
    """Return a hand with all fingers together."""
    return np.array(
        [[0.02 * (index % 5), 0.1 * (index // 5)] for index in range(len(HAND_LANDMARKS))]
    )


def _within(time: float, spans: Spans) -> bool:
    return any(start <= time < end for start, end in spans)


def frames(*divers: Diver, seconds: float) -> list[tuple[float, FrameLandmarks]]:
    """Return what an estimator sees that follows the first diver in view."""
    result = []
    for index in range(round(seconds * RATE)):
        time = index / RATE
        present = [diver for diver in divers if _within(time, diver.seen)]
        bodies = [diver.body(time) for diver in present]
        hands = tuple(diver.hand(time) for diver in present)
        first = bodies[0] if bodies else None
        result.append((time, FrameLandmarks(first, hands, tuple(bodies[1:]))))
    return result


def choose(seen: list[tuple[float, FrameLandmarks]], *, asked_at: int = 0) -> Choice:
    """Return the choice over all frames; at one of them it may be asked for before."""
    people = People()
    for row, (time, found) in enumerate(seen):
        people.add(time, *see_people(found))
        if row == asked_at:
            people.choose()
    return people.choose()


def owners(seen: list[tuple[float, FrameLandmarks]], choice: Choice, *divers: Diver) -> list[int]:
    """Return, frame by frame, which diver's body is chosen; -1 for none."""
    return [
        -1 if place is None else _whose(found.bodies[place], time, divers)
        for (time, found), place in zip(seen, choice.index, strict=True)
    ]


def _whose(body: Body, time: float, divers: Sequence[Diver]) -> int:
    return next(
        number
        for number, diver in enumerate(divers)
        if np.array_equal(body.xy, diver.body(time).xy)
    )


STILL = Diver(100)
SIGNS = Diver(700, size=150, salutes=((1, 2), (5, 6)), draws=((2.5, 4.5),))


@pytest.mark.parametrize("size", [100.0, 200.0, 400.0])
def test_the_body_is_that_of_the_diver_who_salutes_however_large_others_are(size: float) -> None:
    buddy = Diver(100, size=size)
    seen = frames(buddy, SIGNS, seconds=7)
    choice = choose(seen)
    assert set(owners(seen, choice, buddy, SIGNS)) == {1}
    assert choice.notes == ("two people are seen; the body is that of the diver who salutes",)
    assert set(choice.count.tolist()) == {2}


def test_where_the_diver_is_not_seen_yet_nobody_else_takes_the_place() -> None:
    late = Diver(700, salutes=((2, 3), (5, 6)), draws=((3.5, 4.5),), seen=((1.0, 9.0),))
    seen = frames(STILL, late, seconds=7)
    choice = choose(seen)
    assert owners(seen, choice, STILL, late) == [-1] * RATE + [1] * 6 * RATE


def test_without_salutes_the_one_who_moves_counts_among_people_of_one_size() -> None:
    moving = Diver(700, draws=((1, 6),))
    seen = frames(STILL, moving, seconds=7)
    choice = choose(seen)
    assert set(owners(seen, choice, STILL, moving)) == {1}
    assert choice.notes == (
        "two people are seen; the body is that of the person who stands out most",
    )
    assert (choice.salute < 0.5).all()


def test_a_buddy_s_single_salute_is_left_out() -> None:
    buddy = Diver(100, salutes=((3, 4),))
    seen = frames(buddy, SIGNS, seconds=7)
    choice = choose(seen)
    assert set(owners(seen, choice, buddy, SIGNS)) == {1}
    assert (choice.salute[3 * RATE : 4 * RATE] < 0.3).all()
    assert choice.notes[1] == "two people are seen; another diver's salute at 3.0 s is left out"


def test_of_two_who_salute_together_the_one_who_gestures_counts() -> None:
    mimic = Diver(100, size=160, salutes=SIGNS.salutes)
    seen = frames(mimic, SIGNS, seconds=7)
    assert set(owners(seen, choose(seen), mimic, SIGNS)) == {1}


def test_each_take_has_the_body_of_the_diver_who_begins_it() -> None:
    second = Diver(100, salutes=((7, 8), (10, 11)), draws=((8.5, 9.5),))
    seen = frames(second, SIGNS, seconds=12)
    choice = choose(seen)
    assert owners(seen, choice, second, SIGNS) == [1] * 7 * RATE + [0] * 5 * RATE
    assert "more than one salutes" in choice.notes[0]


def test_a_take_between_salutes_of_two_divers_is_told() -> None:
    first, second = Diver(700, salutes=((1, 2),), draws=((2.5, 4),)), Diver(100, salutes=((5, 6),))
    seen = frames(second, first, seconds=7)
    choice = choose(seen)
    assert owners(seen, choice, second, first) == [1] * 5 * RATE + [0] * 2 * RATE
    assert "salutes at 1.0 s and 5.0 s are of different divers" in choice.notes[0]


@pytest.mark.parametrize("asked_at", [RATE, 4 * RATE, 9 * RATE])
def test_a_choice_over_the_first_frames_does_not_change_the_choice_over_all(asked_at: int) -> None:
    late = Diver(100, salutes=((7, 8), (10, 11)), draws=((8.5, 9.5),), seen=((6, 99),))
    early = Diver(700, salutes=((1, 2), (4, 5)), seen=((0, 5.5),))
    seen = frames(early, late, seconds=12)
    once, again = choose(seen), choose(seen, asked_at=asked_at)
    assert (once.index, once.notes) == (again.index, again.notes)
    assert np.array_equal(once.salute, again.salute)


def test_who_is_hidden_for_a_while_is_known_again() -> None:
    hidden = Diver(700, salutes=((1, 2), (6, 7)), seen=((0, 3), (3 + REUNION_SECONDS / 4, 99)))
    seen = frames(STILL, hidden, seconds=8)
    assert set(owners(seen, choose(seen), STILL, hidden)) == {-1, 1}


def test_one_person_is_kept_through_single_frames_with_a_second_one() -> None:
    ghost = Diver(100, size=300, seen=((2.0, 2.2),))
    seen = frames(SIGNS, ghost, seconds=7)
    choice = choose(seen)
    assert set(owners(seen, choice, SIGNS, ghost)) == {0}
    assert choice.notes == ()
    assert choice.count.max() == 1


def test_hands_of_others_are_left_out_and_hands_of_nobody_stay() -> None:
    (_, found), *_ = frames(STILL, SIGNS, seconds=0.1)
    stray = Hand(flat() * 50 + (1200, 700), "left", 0.9)
    crowded = FrameLandmarks(found.body, (*found.hands, stray), found.others)
    kept = keep_person(crowded, 1)
    assert kept.body is found.others[0]
    assert set(map(id, kept.hands)) == {id(found.hands[1]), id(stray)}
    assert kept.others == (found.body,)
    assert keep_person(crowded, None).hands == (stray,)


def test_prominence_grows_with_size_time_and_movement() -> None:
    still = np.stack([STILL.body(index / RATE).xy for index in range(40)])
    mover = Diver(100, draws=((0, 9),))
    moving = np.stack([mover.body(index / RATE).xy for index in range(40)])
    assert prominence_over(moving) > 2 * prominence_over(still)
    assert prominence_over(2 * still) == pytest.approx(4 * prominence_over(still))
    assert prominence_over(still[:20]) == pytest.approx(prominence_over(still) / 2)
    assert prominence_over(np.full((3, 4, 2), np.nan)) == 0


def follow(*divers: Diver, seconds: float, by_salute: bool = True) -> list[Followed]:
    people = PeopleInStream(by_salute=by_salute)
    return [people.follow(time, found) for time, found in frames(*divers, seconds=seconds)]


def test_a_stream_turns_to_the_diver_who_salutes_and_says_so_once() -> None:
    followed = follow(STILL, SIGNS, seconds=7)
    whose = [
        _whose(one.frames[0][1].body, one.frames[0][0], (STILL, SIGNS))
        for one in followed
        if one.frames[0][1].body
    ]
    assert whose == [0] * RATE + [1] * 6 * RATE
    (change,) = [one.change for one in followed if one.change]
    assert change == "another diver salutes; the body is that diver's from now on"
    assert not any(one.restarts for one in followed)


def test_a_stream_without_salutes_stays_with_the_person_it_follows() -> None:
    followed = follow(STILL, SIGNS, seconds=7, by_salute=False)
    assert all(
        np.array_equal(one.frames[0][1].body.xy, STILL.body(one.frames[0][0]).xy)
        for one in followed
        if one.frames[0][1].body
    )


def live_takes(*divers: Diver, seconds: float) -> list[tuple[float, float, int]]:
    """Return start, end and diver of the takes in a stream, as a robot cuts them."""
    takes, people = LiveTakes(FRAME_SIZE), PeopleInStream()
    found = []
    for time, seen in frames(*divers, seconds=seconds):
        followed = people.follow(time, seen)
        if followed.restarts:
            takes = LiveTakes(FRAME_SIZE)
        for moment, person in followed.frames:
            take = takes.feed(moment, person).take
            if take is not None:
                middle = len(take.untrimmed) // 2
                at, xy = take.untrimmed.time[middle], take.untrimmed.xy[middle]
                whose = [np.array_equal(xy, diver.body(at).xy) for diver in divers]
                found.append((take.start, take.end, whose.index(True)))
    return found


def test_a_salute_of_a_buddy_during_a_take_changes_nothing_in_a_stream() -> None:
    buddy = Diver(100, salutes=((3, 4),))
    (take,) = live_takes(buddy, SIGNS, seconds=7)
    assert take == pytest.approx((2, 5, 1), abs=0.1)


def test_a_buddy_s_salute_before_a_take_does_not_hide_it_in_a_stream() -> None:
    buddy = Diver(100, salutes=((0.2, 0.8),))
    signs = Diver(700, salutes=((2, 3), (6, 7)), draws=((3.5, 5.5),))
    (take,) = live_takes(buddy, signs, seconds=8)
    assert take == pytest.approx((3, 6, 1), abs=0.1)


def test_a_forgotten_salute_is_forgotten_after_the_longest_take() -> None:
    forgetful = Diver(100, salutes=((0.2, 0.8),))
    late = LONGEST_TAKE + 2
    signs = Diver(700, salutes=((late, late + 1), (late + 4, late + 5)))
    takes = live_takes(forgetful, signs, seconds=late + 6)
    assert takes[-1] == pytest.approx((late + 1, late + 4, 1), abs=0.1)


def test_memory_of_a_stream_does_not_grow_with_people_who_pass() -> None:
    people = PeopleInStream()
    for index in range(400):
        passing = Diver(100.0 * (index % 50), seen=((0, 1e9),))
        people.follow(float(index), FrameLandmarks(passing.body(0), (passing.hand(0),)))
    assert len(people._divers) <= REUNION_SECONDS + 2
    assert best_salute((SIGNS.hand(1.5),)) > 0.5 > best_salute((SIGNS.hand(3),))
