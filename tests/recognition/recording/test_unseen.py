"""Unseen time: no label across a hole in which a salute may have been missed."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition import Language, Recognizer, Recording, takes_in
from app.recognition.poses.sequence import FloatArray
from app.recognition.recording.clip_range import find_clip_range
from app.recognition.recording.extraction import explain_missing_salutes
from app.recognition.recording.recording import (
    LONGER_HELD,
    find_holes,
    find_missable,
    find_unseen,
    tell_clock,
)
from app.recognition.recording.salute import HOLD_SECONDS, SHORTEST_TAKE
from app.recognition.recording.segmentation import TakeMachine, TakeState, list_unseen
from tests.conftest import RECORDINGS

LINE = Recording.load(RECORDINGS / "avx2" / "line-test-2.npz")
(TAKE,) = takes_in(LINE)
MIDDLE = (TAKE.stroke_start + TAKE.stroke_end) / 2
HELD = HOLD_SECONDS + LONGER_HELD
STEADY = np.arange(100) / 25


@pytest.fixture(scope="module")
def recognizer() -> Recognizer:
    return Recognizer(Language.load("languages/osg-table-2.json"))


def paused(recording: Recording, at: float, seconds: float) -> Recording:
    """Return a recording whose camera stalled: the frames after a moment come later."""
    time = recording.poses.time
    later = np.where(time > at, time + seconds, time)
    return replace(recording, poses=replace(recording.poses, time=later), warnings=())


@given(
    st.lists(st.floats(0.02, 1.5), min_size=1, max_size=60),
    st.lists(st.booleans(), min_size=61, max_size=61),
)
def test_a_salute_of_the_shortest_length_is_seen_or_its_span_is_found(
    steps: list[float], salutes: list[bool]
) -> None:
    """Wherever it may lie: of its frames none is clear, so that its span is found or it counts."""
    time = np.concatenate([[0.0], np.cumsum(steps)]).tolist()
    clear = [each for each, salute in zip(time, salutes, strict=False) if not salute]
    found = find_unseen(clear, time[0], time[-1])
    for start, end in pairwise([time[0], *clear, time[-1]]):
        hidden = end - start > HELD + 0.2
        assert not hidden or any(each.start <= start and end <= each.end for each in found)


@given(st.floats(2 * SHORTEST_TAKE + 1, 59), st.floats(0, 1))
def test_a_take_without_a_clear_frame_for_long_may_hide_a_salute(long: float, share: float) -> None:
    machine = TakeMachine()
    for time in np.arange(0, 1, 0.04).tolist():
        machine.update(time, 0.9)
    after = 1.0 + share * 0.3
    for time in np.concatenate([np.arange(after, 1.8, 0.04), [after + long]]).tolist():
        machine.update(time, 0.0)
    brackets = [machine.update(after + long + 0.04 * k, 0.9) for k in range(20)]
    (bracket,) = [each for each in brackets if each]
    assert bracket.unseen


@pytest.mark.parametrize("seconds", [2.0, 10.0, 48.0])
def test_no_gesture_is_read_across_a_hole(recognizer: Recognizer, seconds: float) -> None:
    stalled = paused(LINE, MIDDLE, seconds)
    (take,) = takes_in(stalled)
    result = recognizer.recognize_take(take)
    assert result.label is None
    assert "a salute may have been missed" in (result.fault or "")
    assert f"from {take.unseen[0].start:.2f}" in (result.fault or "")
    by_hand = find_clip_range(stalled, MIDDLE - 0.5, MIDDLE + seconds + 0.5)
    assert recognizer.recognize(by_hand.poses, by_hand.unseen).label is None
    assert list_unseen(stalled)
    assert "no frame from" in stalled.warnings[0]
    assert ("no gesture is read across it" in stalled.warnings[0]) == (seconds > 3)


def test_a_short_hole_in_the_stroke_is_told_with_its_place(recognizer: Recognizer) -> None:
    (take,) = takes_in(paused(LINE, MIDDLE, 0.4))
    result = recognizer.recognize_take(take)
    assert result.label == "line"
    assert any(f"no frame from {MIDDLE:.1f}"[:-2] in told for told in result.findings)


def test_a_whole_recording_is_recognised_as_before(recognizer: Recognizer) -> None:
    assert recognizer.recognize_take(TAKE).label == "line"
    assert (TAKE.unseen, list_unseen(LINE), LINE.warnings) == ((), (), ())


def test_two_salutes_with_a_hole_between_are_not_one() -> None:
    """All of a take falls into the hole: the second salute ends it, and begins no other one."""
    time = LINE.poses.time
    machine = TakeMachine()
    found = [
        machine.update(moment, score)
        for moment, score in zip(time.tolist(), LINE.salute.tolist(), strict=True)
        if not TAKE.start - 0.1 < moment < TAKE.end + 0.1
    ]
    (bracket,) = [each for each in found if each]
    assert bracket.closed
    assert machine.state is not TakeState.recording


def test_salutes_near_the_own_ones_are_these() -> None:
    assert find_missable((), 0.0, 2 * SHORTEST_TAKE + HELD) == ()
    assert find_missable((), 0.0, 2 * SHORTEST_TAKE + 2 * HELD)


def times(*steps: float) -> FloatArray:
    return np.concatenate([STEADY, STEADY[-1] + np.cumsum(steps)])


@pytest.mark.parametrize(
    ("time", "words"),
    [
        (STEADY, ""),
        (times(0.2, 0.04), ""),
        (times(3.0, 0.04), "no frame from 3.96 to 6.96 s:"),
        (times(3.0, 0.04, 4.0), "from 7.00 to 11.00 s, the longest of 2 holes"),
        (STEADY / 20, "100 of 100 frames are crammed together, 500 a second"),
        (STEADY * 25, "1.0 frames a second are too few"),
        (STEADY[:1], ""),
    ],
)
def test_what_is_odd_about_a_clock_is_told(time: FloatArray, words: str) -> None:
    told = " ".join(tell_clock(time))
    assert words in told
    assert bool(words) == bool(told)
    assert "sort" not in told
    assert "hold" not in told
    assert all(each.end > each.start for each in find_holes(time))


def test_what_is_odd_about_the_file_speaks_before_the_salutes() -> None:
    clear = np.zeros(len(LINE.poses))
    (told,) = explain_missing_salutes(LINE.poses, clear, LINE.hands, odd=["the picture turns"])
    assert told == "two salutes were not seen, and something else is odd: the picture turns"
    assert not list(explain_missing_salutes(LINE.poses, LINE.salute, LINE.hands, odd=["x"]))


def test_a_wrist_outside_of_the_picture_is_told_where_no_salute_was_seen() -> None:
    clear, count = np.zeros(len(LINE.poses)), len(LINE.poses)
    (told,) = explain_missing_salutes(LINE.poses, clear, LINE.hands)
    assert "outside" not in told
    wrist = LINE.poses.landmarks.index("right_wrist")
    shift = np.array([np.nanmax(LINE.poses.xy[:, wrist, 0]) + 1, 0])
    beyond = replace(LINE.poses, xy=LINE.poses.xy - shift)
    (told,) = explain_missing_salutes(beyond, clear, LINE.hands)
    assert f"the right wrist lies outside of the picture in {count} of {count} frames" in told
