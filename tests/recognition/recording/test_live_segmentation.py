"""Takes found while a camera runs are those that are found in the recording afterwards."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from app.recognition.poses.frame import Body, FrameLandmarks, Hand
from app.recognition.poses.sequence import join_sequences
from app.recognition.recording.extraction import build_frame_sequence
from app.recognition.recording.live_segmentation import LONGEST_TRIGGER, LiveTakes, Sight
from app.recognition.recording.recording import Recording
from app.recognition.recording.salute import best_salute
from app.recognition.recording.segmentation import LONGEST_TAKE, TakeState, takes_in
from tests.api.recordings import FRAME_SIZE, recording_of
from tests.recognition.parametric_hand import Finger, hand_xy, salute

SALUTING = Hand(hand_xy(salute()), "right", 0.9)
FLAT = Hand(hand_xy((Finger(3), Finger(0), Finger(-3), Finger(-6))), "right", 0.9)


def frames_of(recording: Recording) -> Iterator[tuple[float, FrameLandmarks]]:
    """Yield what an estimator would find: a hand that salutes where the recording's score is 1."""
    poses = recording.poses
    for time, xy, score in zip(poses.time.tolist(), poses.xy, recording.salute, strict=True):
        hand = SALUTING if score > 0.5 else FLAT
        yield time, FrameLandmarks(Body(xy, np.ones(len(xy)), 1.0), (hand,))


def watched(recording: Recording) -> list[Sight]:
    takes = LiveTakes(FRAME_SIZE)
    return [takes.feed(time, found) for time, found in frames_of(recording)]


def test_the_takes_of_a_camera_are_those_of_its_recording() -> None:
    seen = list(frames_of(recording_of("circle", "line")))
    recording = Recording(
        poses=join_sequences(
            [build_frame_sequence(found, time, FRAME_SIZE) for time, found in seen]
        ),
        hands=tuple(found.hands for _, found in seen),
        salute=np.array([best_salute(found.hands) for _, found in seen]),
    )
    live = [sight.take for sight in watched(recording) if sight.take is not None]
    afterwards = takes_in(recording)
    assert len(live) == len(afterwards) == 2
    for one, other in zip(live, afterwards, strict=True):
        assert (one.start, one.end, one.closed) == (other.start, other.end, True)
        assert (one.stroke_start, one.stroke_end) == (other.stroke_start, other.stroke_end)
        assert one.poses == other.poses


def test_what_goes_on_is_told_with_every_frame() -> None:
    sights = watched(recording_of("circle"))
    states = [sight.state for sight in sights]
    assert states[0] is TakeState.idle
    assert {sight.state for sight in sights if sight.held} == {TakeState.recording, TakeState.done}
    assert sights[states.index(TakeState.done)].score > 0.9


def test_a_salute_held_for_minutes_is_not_remembered_whole() -> None:
    takes = LiveTakes(FRAME_SIZE)
    body = next(found.body for _, found in frames_of(recording_of("circle")))
    rate = 10
    for frame in range(rate * 200):
        takes.feed(frame / rate, FrameLandmarks(body, (SALUTING,)))
    assert len(takes) <= rate * (LONGEST_TAKE + LONGEST_TRIGGER) + 1


def test_a_frame_without_anybody_is_a_frame() -> None:
    sight = LiveTakes(FRAME_SIZE).feed(3.0, FrameLandmarks(None, ()))
    assert (sight.score, sight.held, sight.state, sight.take) == (0.0, False, TakeState.idle, None)


def test_a_take_that_was_begun_is_what_a_recording_cut_there_says() -> None:
    whole = recording_of("circle")
    end = whole.poses.time[-1] - 1.5
    frames = [frame for frame in frames_of(whole) if frame[0] <= end]
    takes = LiveTakes(FRAME_SIZE)
    assert not [each for each in frames if takes.feed(*each).take]
    begun = takes.finish()
    recording = Recording(
        poses=join_sequences(
            [build_frame_sequence(found, time, FRAME_SIZE) for time, found in frames]
        ),
        hands=tuple(found.hands for _, found in frames),
        salute=np.array([best_salute(found.hands) for _, found in frames]),
    )
    (expected,) = takes_in(recording)
    assert begun is not None
    assert (begun.start, begun.end, begun.closed) == (expected.start, expected.end, False)
    assert begun.poses == expected.poses


def test_a_stream_without_frames_has_no_take() -> None:
    assert LiveTakes(FRAME_SIZE).finish() is None


def test_who_waits_for_a_salute_remembers_no_more_than_a_salute() -> None:
    takes = LiveTakes(FRAME_SIZE)
    for frame in range(300):
        takes.feed(frame / 10, FrameLandmarks(None, ()))
    assert len(takes) <= 10 * LONGEST_TRIGGER + 1
