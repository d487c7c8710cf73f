"""Salute listener: frame by frame it recognises what the whole recording gives."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.recognition import PoseSequence, Recording, takes_in
from app.recognition.recording.live_segmentation import LONGEST_SALUTE
from app.recognition.recording.segmentation import LONGEST_TAKE, TakeState
from app.robot import Event, Listener, StateChanged, TakeRecognized, TakeRejected
from tests.api.recordings import RATE, recording_of
from tests.robot.languages import moments_of, run_listener, spoken

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
    emitted = run_listener(Listener(language), recording)
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
    emitted = run_listener(Listener(spoken("circle", "line")), recording_of("line"))
    states = [event.state for event in emitted if isinstance(event, StateChanged)]
    assert states == [TakeState.idle, TakeState.recording, TakeState.done]
    (recognition,) = [event for event in emitted if isinstance(event, TakeRecognized)]
    assert (recognition.label, recognition.nearest, recognition.revision) == ("line", "line", 1)
    assert recognition.margin > 0
    assert recognition.sha256 == spoken("circle", "line").sha256
    assert recognition.start < recognition.end < recognition.time


def test_a_gesture_is_heard_the_same_after_any_other() -> None:
    listener = Listener(spoken("circle", "line"))
    run_listener(listener, recording_of("circle"))
    later = [
        event
        for moment, salute in moments_of(recording_of("line"))
        for event in listener.feed(moved(moment, 100), salute)
    ]
    (recognition,) = [event for event in later if isinstance(event, TakeRecognized)]
    alone = run_listener(Listener(spoken("circle", "line")), recording_of("line"))
    (expected,) = [event for event in alone if isinstance(event, TakeRecognized)]
    assert recognition.label == expected.label
    assert recognition.confidence == pytest.approx(expected.confidence, abs=1e-6)


def test_what_is_no_gesture_is_rejected_with_the_nearest_one() -> None:
    emitted = run_listener(Listener(spoken("circle")), recording_of("line"))
    (rejected,) = [event for event in emitted if isinstance(event, TakeRejected)]
    assert "no gesture of 'pool'" in rejected.reason
    assert (rejected.nearest, rejected.margin) == ("circle", np.inf)
    assert rejected.confidence is not None


def test_a_take_that_nobody_ends_is_rejected_when_the_stream_does() -> None:
    listener = Listener(spoken("circle"))
    unfinished = cut(recording_of("circle"), 2.5)
    assert not [e for e in run_listener(listener, unfinished) if not isinstance(e, StateChanged)]
    (rejected,) = listener.finish()
    assert isinstance(rejected, TakeRejected)
    (take,) = takes_in(unfinished)
    assert (rejected.start, rejected.end, rejected.closed) == (take.start, take.end, False)
    assert rejected.reason == "the stream ended before a second salute"
    assert rejected.nearest == "circle"
    assert len(listener) == 0


def test_a_take_that_nobody_ends_is_rejected_after_a_minute_and_memory_stays_bounded() -> None:
    listener = Listener(spoken("circle"))
    *_, (last, _) = moments_of(cut(recording_of("circle"), 2.5))
    run_listener(listener, cut(recording_of("circle"), 2.5))
    emitted: list[Event] = []
    for frame in range(1, round(100 * RATE)):
        emitted += listener.feed(moved(last, frame / RATE), 0.0)
        assert len(listener) <= (LONGEST_TAKE + LONGEST_SALUTE) * RATE + 2
    (rejected,) = [event for event in emitted if isinstance(event, TakeRejected)]
    assert "no salute ended it within 60 s" in rejected.reason
    assert rejected.end - rejected.start == pytest.approx(LONGEST_TAKE)
    assert listener.state is TakeState.idle


def test_another_picture_or_time_going_back_ends_a_take() -> None:
    begun = cut(recording_of("circle"), 2.5)
    *_, (last, _) = moments_of(begun)
    larger = PoseSequence(
        landmarks=last.landmarks, xy=last.xy, time=last.time + 0.05, frame_size=(1280, 960)
    )
    for following, reason in [(moved(last, -1), "time went back"), (larger, "640 x 480 to 1280")]:
        listener = Listener(spoken("circle"))
        run_listener(listener, begun)
        rejected, idle = listener.feed(following, 0.0)
        assert isinstance(rejected, TakeRejected)
        assert reason in rejected.reason
        assert isinstance(idle, StateChanged)
        assert idle.state is TakeState.idle


def test_a_take_is_recognised_by_the_language_at_its_end() -> None:
    listener = Listener(spoken("circle"))
    begun = moments_of(recording_of("line"))
    emitted: list[Event] = []
    for number, frame in enumerate(begun):
        if number == len(begun) // 2:
            listener.set_language(spoken("circle", "line", revision=2))
        emitted += listener.feed(*frame)
    (recognition,) = [event for event in emitted if isinstance(event, TakeRecognized)]
    assert (recognition.label, recognition.revision) == ("line", 2)
