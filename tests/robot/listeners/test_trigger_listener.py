"""Salute listener: frame by frame it recognises what the whole recording gives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.cli.robots.channels import describe_event
from app.recognition import Gesture, Language, PoseSequence, Recording, takes_in
from app.recognition.recording.live_segmentation import LONGEST_TRIGGER
from app.recognition.recording.segmentation import LONGEST_TAKE, TakeState
from app.robot import (
    ActiveLanguage,
    Event,
    StateChanged,
    TakeRecognized,
    TakeRejected,
    TriggerListener,
)
from app.robot.listeners.stream_order import MOST_LATE
from app.robot.runtime import build_language_changed
from app.robot.take_result import judge_recognition
from tests.api.recordings import RATE, recording_of
from tests.recognition.held_takes import FIST, FLAT
from tests.recognition.moving_takes import circle, corner, draw
from tests.robot.languages import ambiguous, language_of, moments_of, run_listener, spoken

SHAPES = ("circle", "line", "circle backwards")


def cut(recording: Recording, end: float) -> Recording:
    """Return a recording that stops at `end` seconds."""
    poses = recording.poses.between(0, end)
    return Recording(poses, recording.hands[: len(poses)], recording.salute[: len(poses)])


def moved(poses: PoseSequence, seconds: float) -> PoseSequence:
    return PoseSequence(
        landmarks=poses.landmarks,
        xy=poses.xy,
        confidence=poses.confidence,
        time=poses.time + seconds,
        frame_size=poses.frame_size,
    )


@settings(max_examples=5, deadline=None)
@given(st.lists(st.sampled_from(SHAPES), min_size=1, max_size=2))
def test_the_events_of_a_stream_equal_the_recognitions_of_its_recording(shapes: list[str]) -> None:
    language = spoken("circle", "line")
    recording = recording_of(*shapes)
    emitted = run_listener(TriggerListener(language), recording)
    verdicts = [event for event in emitted if isinstance(event, TakeRecognized | TakeRejected)]
    takes = takes_in(recording)
    assert len(takes) == len(verdicts) == len(shapes)
    for take, verdict in zip(takes, verdicts, strict=True):
        recognition = language.recognizer.recognize(take.poses)
        assert (verdict.start, verdict.end, verdict.closed) == (take.start, take.end, True)
        assert verdict.recognition is not None
        assert verdict.recognition.to_dict() == recognition.to_dict()
        assert isinstance(verdict, TakeRecognized) is (recognition.label is not None)


def test_states_and_recognitions_are_emitted_in_order() -> None:
    emitted = run_listener(TriggerListener(spoken("circle", "line")), recording_of("line"))
    states = [event.state for event in emitted if isinstance(event, StateChanged)]
    assert states == [TakeState.idle, TakeState.recording, TakeState.done]
    (recognition,) = [event for event in emitted if isinstance(event, TakeRecognized)]
    assert (recognition.label, recognition.nearest, recognition.revision) == ("line", "line", 1)
    assert recognition.margin > 0
    assert recognition.sha256 == spoken("circle", "line").sha256
    assert recognition.start < recognition.end < recognition.time


def test_a_gesture_is_heard_the_same_after_any_other() -> None:
    listener = TriggerListener(spoken("circle", "line"))
    run_listener(listener, recording_of("circle"))
    later = [
        event
        for moment, salute in moments_of(recording_of("line"))
        for event in listener.feed(moved(moment, 100), salute)
    ]
    (recognition,) = [event for event in later if isinstance(event, TakeRecognized)]
    alone = run_listener(TriggerListener(spoken("circle", "line")), recording_of("line"))
    (expected,) = [event for event in alone if isinstance(event, TakeRecognized)]
    assert recognition.label == expected.label
    assert recognition.confidence == pytest.approx(expected.confidence, abs=1e-6)


def test_what_is_no_gesture_is_rejected_with_the_nearest_one() -> None:
    emitted = run_listener(TriggerListener(spoken("circle")), recording_of("line"))
    (rejected,) = [event for event in emitted if isinstance(event, TakeRejected)]
    assert "no gesture of 'pool'" in rejected.reason
    assert (rejected.nearest, rejected.margin) == ("circle", np.inf)
    assert rejected.confidence is not None


def test_a_take_between_two_gestures_is_asked_about_and_one_between_three_is_not() -> None:
    emitted = run_listener(TriggerListener(ambiguous()), recording_of("circle"))
    (asked,) = [event for event in emitted if isinstance(event, TakeRejected)]
    assert asked.recognition is not None
    assert asked.pair == asked.recognition.pair
    assert asked.pair is not None
    assert asked.reason == f"{asked.pair[0]} or {asked.pair[1]}? show it again"
    three = [replace(language_of("circle").gestures[0], label=label) for label in "abc"]
    language = replace(language_of("circle"), gestures=three)
    active = ActiveLanguage.from_json(language.to_json())
    emitted = run_listener(TriggerListener(active), recording_of("circle"))
    (rejected,) = [event for event in emitted if isinstance(event, TakeRejected)]
    assert rejected.pair is None
    assert rejected.reason == "it lies between a, b and c"


def test_an_open_take_is_not_asked_about() -> None:
    listener = TriggerListener(ambiguous())
    run_listener(listener, cut(recording_of("circle"), 2.8))
    (rejected,) = listener.finish()
    assert isinstance(rejected, TakeRejected)
    assert rejected.recognition is not None
    assert (rejected.recognition.label, rejected.recognition.pair) == (None, None)


def test_a_take_that_nobody_ends_is_rejected_when_the_stream_does() -> None:
    listener = TriggerListener(spoken("circle"))
    unfinished = cut(recording_of("circle"), 2.5)
    assert not [e for e in run_listener(listener, unfinished) if not isinstance(e, StateChanged)]
    (rejected,) = listener.finish()
    assert isinstance(rejected, TakeRejected)
    (take,) = takes_in(unfinished)
    assert (rejected.start, rejected.end, rejected.closed) == (take.start, take.end, False)
    assert rejected.reason == "the stream ended before a second salute"
    assert rejected.nearest == "circle"
    # Who reads the recording says the same.
    read = listener.language.recognizer.recognize_take(take)
    assert rejected.recognition is not None
    assert rejected.recognition.to_dict() == read.to_dict()
    assert (read.label, read.nearest, read.fault) == (None, "circle", "no second salute ended it")
    assert len(listener) == 0


def test_a_take_that_nobody_ends_is_rejected_after_a_minute_and_memory_stays_bounded() -> None:
    listener = TriggerListener(spoken("circle"))
    *_, (last, _) = moments_of(cut(recording_of("circle"), 2.5))
    run_listener(listener, cut(recording_of("circle"), 2.5))
    emitted: list[Event] = []
    for frame in range(1, round(100 * RATE)):
        emitted += listener.feed(moved(last, frame / RATE), 0.0)
        assert len(listener) <= (LONGEST_TAKE + LONGEST_TRIGGER) * RATE + 2
    (rejected,) = [event for event in emitted if isinstance(event, TakeRejected)]
    assert "no salute ended it within 60 s" in rejected.reason
    assert rejected.end - rejected.start == pytest.approx(LONGEST_TAKE)
    assert listener.state is TakeState.idle


def test_another_picture_or_time_going_back_ends_a_take() -> None:
    begun = cut(recording_of("circle"), 2.5)
    *_, (last, _) = moments_of(begun)
    larger = [
        PoseSequence(
            landmarks=last.landmarks, xy=last.xy, time=last.time + 0.05, frame_size=(1280, 960)
        )
    ]
    earlier = [moved(last, number / RATE - 2) for number in range(MOST_LATE)]
    for following, reason in [(earlier, "time went back"), (larger, "640 x 480 to 1280")]:
        listener = TriggerListener(spoken("circle"))
        run_listener(listener, begun)
        rejected, idle = [event for each in following for event in listener.feed(each, 0.0)]
        assert isinstance(rejected, TakeRejected)
        assert reason in rejected.reason
        assert isinstance(idle, StateChanged)
        assert idle.state is TakeState.idle


@pytest.mark.withstands(row="H27")
def test_late_and_repeated_frames_are_dropped_and_counted_and_the_take_stays() -> None:
    frames = moments_of(recording_of("circle"))
    middle = len(frames) // 2
    disordered = [*frames[:middle], frames[middle - 1], frames[middle - 9], *frames[middle:]]
    disordered[8], disordered[9] = disordered[9], disordered[8]
    listener, alone = TriggerListener(spoken("circle")), TriggerListener(spoken("circle"))
    events = [event for frame in disordered for event in listener.feed(*frame)]
    expected = [event for frame in frames for event in alone.feed(*frame)]
    assert listener.order.late == 3
    (said,) = [event for event in events if isinstance(event, TakeRecognized)]
    (same,) = [event for event in expected if isinstance(event, TakeRecognized)]
    assert (said.label, said.start, said.end) == (same.label, same.start, same.end)


@pytest.mark.parametrize("seconds", [59.0, 61.0, 62.0, 70.0, 3600.0, 1e6])
@pytest.mark.withstands(row="H27")
def test_a_pause_or_a_step_of_the_clock_in_a_take_rejects_it(seconds: float) -> None:
    listener = TriggerListener(spoken("circle"))
    begun = cut(recording_of("circle"), 2.0)
    run_listener(listener, begun)
    *_, (last, _) = moments_of(begun)
    events = [
        event
        for number in range(1, 4 * RATE)
        for event in listener.feed(moved(last, seconds + number / RATE), 0.0)
    ]
    (rejected,) = [event for event in events if isinstance(event, TakeRejected)]
    assert "no salute ended it within 60 s" in rejected.reason
    assert listener.state is TakeState.idle
    # And it goes on.
    later = [
        event
        for moment, salute in moments_of(recording_of("circle"))
        for event in listener.feed(moved(moment, seconds + 100), salute)
    ]
    assert [event.label for event in later if isinstance(event, TakeRecognized)] == ["circle"]


def dive(*shapes: str, rest: float = 3.0) -> list[tuple[PoseSequence, float]]:
    """Return gestures between their salutes, with a rest of still hands after each."""
    frames: list[tuple[PoseSequence, float]] = []
    for shape in shapes:
        began = float(frames[-1][0].time[0]) + 1 / RATE if frames else 0.0
        frames += [(moved(each, began), salute) for each, salute in moments_of(recording_of(shape))]
        last, _ = frames[-1]
        frames += [(moved(last, number / RATE), 0.0) for number in range(1, round(rest * RATE) + 1)]
    return frames


def lower_between(shapes: list[str]) -> list[tuple[PoseSequence, float]]:
    """Return gestures between salutes; after each the arm is lowered, hangs and is raised."""
    lowered = [moment for moment, salute in moments_of(recording_of("dip")) if not salute]
    lowest = len(lowered) * 2 // 5
    arm = [*lowered[:lowest], *[lowered[lowest]] * (2 * RATE), *lowered[lowest:]]
    frames: list[tuple[PoseSequence, float]] = []
    for shape in shapes:
        frames += [*moments_of(recording_of(shape)), *((moment, 0.0) for moment in arm)]
    return [
        (moved(moment, number / RATE - float(moment.time[0])), salute)
        for number, (moment, salute) in enumerate(frames)
    ]


def labels_in(listener: TriggerListener, frames: list[tuple[PoseSequence, float]]) -> list[str]:
    events = [event for frame in frames for event in listener.feed(*frame)]
    return [event.label for event in events if isinstance(event, TakeRecognized)]


@pytest.mark.parametrize("rest", [1.2, 3.0, 12.0])
def test_after_a_missed_salute_the_next_gestures_are_recognised(rest: float) -> None:
    language = spoken("circle", "line")
    frames = dive("circle", "line", "circle", "line", rest=rest)
    assert labels_in(TriggerListener(language), frames) == ["circle", "line", "circle", "line"]
    # Begun after the first salute, as after a restart.
    began = next(index for index, (_, salute) in enumerate(frames) if salute == 0)
    listener = TriggerListener(language)
    assert labels_in(listener, frames[began:]) == ["line", "circle", "line"]
    assert listener.state is TakeState.idle


def test_a_salute_that_was_not_seen_costs_one_gesture() -> None:
    language = spoken("circle", "line")
    frames = dive("circle", "line", "circle", "line")
    for missed in range(8):
        listener, kept, number, before = TriggerListener(language), [], -1, 0.0
        for moment, salute in frames:
            number += salute > before
            before = salute
            kept.append((moment, 0.0 if number == missed else salute))
        recognised = labels_in(listener, kept)
        # Without the salute that ends it, a gesture is recognised at the next one's first salute.
        expected = ["circle", "line", "circle", "line"]
        del expected[min((missed + 1) // 2, 3)]
        assert recognised == expected, missed


def test_arms_lowered_after_a_rejected_gesture_are_no_gesture() -> None:
    # The language has a gesture that is just that movement.
    language = spoken("dip", "circle")
    assert labels_in(TriggerListener(language), lower_between(["dip"])) == ["dip"]
    frames = lower_between(["line", "circle", "line", "line", "circle"])
    assert labels_in(TriggerListener(language), frames) == ["circle", "circle"]


def test_after_a_missed_salute_arms_that_are_lowered_are_no_gesture() -> None:
    listener = TriggerListener(spoken("valley", "line"))
    frames = lower_between(["line", "line", "line"])
    began = next(index for index, (_, salute) in enumerate(frames) if not salute)
    events = [event for frame in frames[began:] for event in listener.feed(*frame)]
    rejected, *recognised = [
        event for event in events if isinstance(event, TakeRecognized | TakeRejected)
    ]
    assert isinstance(rejected, TakeRejected)
    assert rejected.reason == "both arms hang most of the time, so that a salute was missed"
    assert [event.label for event in recognised] == ["line", "line"]


def test_a_rejected_gesture_does_not_turn_the_pairs_around() -> None:
    listener = TriggerListener(spoken("circle"))
    frames = dive("circle", "line", "circle", "line", "circle")
    assert labels_in(listener, frames) == ["circle"] * 3


def test_a_take_is_recognised_by_the_language_at_its_end() -> None:
    listener = TriggerListener(spoken("circle"))
    begun = moments_of(recording_of("line"))
    emitted: list[Event] = []
    for number, frame in enumerate(begun):
        if number == len(begun) // 2:
            listener.set_language(spoken("circle", "line", revision=2))
        emitted += listener.feed(*frame)
    (recognition,) = [event for event in emitted if isinstance(event, TakeRecognized)]
    assert (recognition.label, recognition.revision) == ("line", 2)


def test_undecided_twins_are_told_at_the_start_and_asked_back() -> None:
    circles = [draw(FIST, circle()), draw(FLAT, circle(0.42), seed=1)]
    shown = [
        Gesture.from_demonstration(label, poses)
        for label, poses in zip(("fist", "flat"), circles, strict=True)
    ]
    shown.append(Gesture.from_demonstration("corner", draw(FLAT, corner(), seed=2)))
    language = ActiveLanguage.from_json(Language("pool", shown).to_json())
    told = build_language_changed(0.0, language)
    assert told.undecided_twins == (("fist", "flat"),)
    assert "On purpose?" in describe_event(told)
    for label, asked in (("fist", ("fist", "flat")), ("flat", ("flat", "fist")), ("corner", None)):
        found = language.recognizer.recognize(circles[0])
        read = found.model_copy(update={"label": label, "nearest": label, "pair": None})
        verdict = judge_recognition(language, read, 9.0, 1.0, 2.0)
        pair = verdict.pair if isinstance(verdict, TakeRejected) else None
        assert pair == asked
