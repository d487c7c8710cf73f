"""Spotting in a stream: each gesture once, soon after it ended, and nothing else."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from app.recognition import (
    Gesture,
    Language,
    OsgError,
    PoseError,
    PoseSequence,
    Recognizer,
)
from app.recognition.recording.trimming import Span
from app.recognition.spotting import Spotted, Spotter, TriggerGate
from app.recognition.triggers.trigger import Trigger
from tests.recognition.held_takes import TWO, hold
from tests.recognition.motions import (
    Movement,
    circle,
    perform,
    still,
)

DOWN = np.array([-0.5, 0.6])
TOP = np.array([-0.9, -0.4])
CORNERS = np.array([[-0.4, -0.4], [-0.4, 0.3], [-0.9, 0.3], [-0.9, -0.4]])
ZIGZAG = np.array([[-0.5, -0.3], [-0.9, -0.1], [-0.5, 0.1], [-0.9, 0.3]])
SHAPES = {"circle": circle(TOP), "square": CORNERS, "zigzag": ZIGZAG}


def demonstration(label: str) -> Gesture:
    shown = perform([Movement(TOP, 0.001), Movement(SHAPES[label], 1.6)], noise=0.003)
    return Gesture.from_demonstration(label, shown.poses.between(0.04, 2))


@pytest.fixture(scope="module")
def recognizer() -> Recognizer:
    return Recognizer(Language(name="three", gestures=[demonstration(label) for label in SHAPES]))


def stream(labels: Sequence[str], seed: int = 1) -> tuple[PoseSequence, list[tuple[float, float]]]:
    """Let a diver rest, reach, pause, show each gesture, pause and rest again."""
    random = np.random.default_rng(seed)
    moves, spans = [Movement(DOWN, 0.5), still(DOWN, 1.0)], []
    for label in labels:
        moves += [Movement(TOP, 0.7), still(TOP, 0.3)]
        start = sum(move.seconds for move in moves)
        moves.append(Movement(SHAPES[label], random.uniform(1.3, 2.0)))
        spans.append((start, start + moves[-1].seconds))
        moves += [still(np.atleast_2d(SHAPES[label])[-1], 0.3), Movement(DOWN, 0.7)]
        moves.append(still(DOWN, random.uniform(1.0, 2.0)))
    return perform(moves, noise=0.003, seed=seed).poses, spans


def spotted(recognizer: Recognizer, poses: PoseSequence) -> list[tuple[float, Spotted]]:
    """Feed frame by frame: when each gesture was reported, and what."""
    spotter = Spotter(recognizer)
    found = [
        (moment, each)
        for moment in poses.time.tolist()
        for each in spotter.feed(poses.between(moment, moment))
    ]
    return found + [(float(poses.time[-1]), each) for each in spotter.finish()]


@pytest.mark.parametrize("labels", [["circle"], ["square", "circle", "zigzag", "circle"]])
def test_every_gesture_is_reported_once_where_it_was(
    recognizer: Recognizer, labels: list[str]
) -> None:
    poses, spans = stream(labels)
    found = [each for _, each in spotted(recognizer, poses)]
    assert [each.recognition.label for each in found] == labels
    for each, (start, end) in zip(found, spans, strict=True):
        assert (each.start, each.end) == pytest.approx((start, end), abs=0.35)


@pytest.mark.parametrize(
    ("start", "stop", "heard"),
    [
        ("zigzag", "", ["square", "circle"]),
        ("zigzag", "circle", ["square"]),
        ("circle", "", ["zigzag", "square"]),
    ],
)
def test_between_trigger_gestures_alone_gestures_are_reported(
    recognizer: Recognizer, start: str, stop: str, heard: list[str]
) -> None:
    trigger = Trigger("gesture", start_label=start, stop_label=stop)
    poses, _ = stream(["circle", "zigzag", "square", "circle", "zigzag", "square"])
    triggered = Recognizer(replace(recognizer.language, trigger=trigger))
    assert [each.recognition.label for _, each in spotted(triggered, poses)] == heard
    everywhere = Spotter(triggered, triggered=False).listen(poses)
    assert len(everywhere) == 6


def test_a_trigger_gesture_that_is_forgotten_confirms_nothing_a_minute_later(
    recognizer: Recognizer,
) -> None:
    gate = TriggerGate(Trigger("gesture", start_label="zigzag"))
    poses, _ = stream(["zigzag", "circle"])
    opened, between = (each for _, each in spotted(recognizer, poses))
    closing = replace(opened, start=opened.end + 60, end=opened.end + 61)
    assert gate.admit((opened, between)) == ()
    assert gate.admit((closing,)) == ()
    later = replace(between, start=closing.end + 1, end=closing.end + 3)
    again = replace(opened, start=later.end + 1, end=later.end + 3)
    assert gate.admit((later, again)) == (later,)


def test_a_gesture_is_reported_soon_after_it_ended(recognizer: Recognizer) -> None:
    poses, spans = stream(["circle", "zigzag"])
    for (moment, _), (_, end) in zip(spotted(recognizer, poses), spans, strict=True):
        assert end < moment < end + 2.5


def test_an_arm_that_rests_or_reaches_is_no_gesture(recognizer: Recognizer) -> None:
    resting = perform([Movement(DOWN, 0.5), still(DOWN, 8.0)], noise=0.005).poses
    assert spotted(recognizer, resting) == []
    reaching = perform([Movement(DOWN, 0.6), Movement(TOP, 0.6), still(TOP, 1)] * 4).poses
    assert spotted(recognizer, reaching) == []


def test_a_stream_that_shows_nobody_is_waited_through(recognizer: Recognizer) -> None:
    poses, _ = stream(["circle"])
    xy = poses.xy.copy()
    xy[:20] = np.nan
    seen = PoseSequence(landmarks=poses.landmarks, xy=xy, time=poses.time, frame_size=(640, 640))
    assert [each.recognition.label for _, each in spotted(recognizer, seen)] == ["circle"]
    nobody = PoseSequence(
        landmarks=poses.landmarks,
        xy=np.full_like(xy, np.nan),
        time=poses.time,
        frame_size=(640, 640),
    )
    assert spotted(recognizer, nobody) == []


def test_frames_may_come_in_chunks(recognizer: Recognizer) -> None:
    poses, _ = stream(["square", "zigzag"])
    spotter = Spotter(recognizer)
    found: list[Spotted] = []
    for start in np.arange(0, poses.duration, 0.08):
        found += spotter.feed(poses.between(start, start + 0.0799))
    labels = [each.recognition.label for each in (*found, *spotter.finish())]
    assert labels == ["square", "zigzag"]


def test_memory_and_work_are_bounded(
    recognizer: Recognizer, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A hand that never rests: at most one recognition a frame, and no frame is kept for ever."""
    asked = 0
    recognize = recognizer.recognize

    def counted(poses: PoseSequence, unseen: Sequence[Span]) -> object:
        nonlocal asked
        asked += 1
        return recognize(poses, unseen)

    monkeypatch.setattr(recognizer, "recognize", counted)
    restless = perform([Movement(ZIGZAG[::step], 0.9) for step in (1, -1)] * 3).poses
    spotter = Spotter(recognizer)
    for moment in restless.time.tolist():
        before = asked
        spotter.feed(restless.between(moment, moment))
        assert asked - before <= 1
        assert len(spotter) < 8 * 25
    assert asked > 20


def test_time_must_go_on(recognizer: Recognizer) -> None:
    poses, _ = stream(["circle"])
    spotter = Spotter(recognizer)
    assert spotter.feed(poses.between(-2, -1)) == ()
    spotter.feed(poses.between(0, 1))
    with pytest.raises(PoseError, match="must increase"):
        spotter.feed(poses.between(0.5, 1.5))
    with pytest.raises(PoseError, match="must keep its 6 landmarks"):
        spotter.feed(poses.between(1.01, 1.5).select(["right_wrist"]))


def test_profile_paper_cannot_listen(recognizer: Recognizer) -> None:
    with pytest.raises(OsgError, match="use profile full"):
        Spotter(Recognizer(recognizer.language, "paper"))


def test_a_gesture_may_last_as_long_as_any_of_its_demonstrations() -> None:
    def shown(seconds: float) -> PoseSequence:
        moves = [Movement(TOP, 0.001), Movement(SHAPES["circle"], seconds)]
        return perform(moves, noise=0.003).poses.between(0.04, seconds + 0.5)

    quick = Gesture.from_demonstration("circle", shown(0.8))
    moves = [
        *(Movement(DOWN, 0.5), still(DOWN, 1.0), Movement(TOP, 0.7), still(TOP, 0.5)),
        *(Movement(SHAPES["circle"], 3.0), still(TOP, 0.5), Movement(DOWN, 0.7), still(DOWN, 2.0)),
    ]
    poses = perform(moves, noise=0.003).poses
    for gesture, found in ((quick, []), (quick.with_demonstration(shown(2.6)), ["circle"])):
        recognizer = Recognizer(Language("one", [gesture, demonstration("zigzag")]))
        labels = [each.recognition.label for _, each in spotted(recognizer, poses)]
        assert labels == found


def test_a_language_of_held_shapes_alone_needs_salutes() -> None:
    held = Language("signs", [Gesture.from_demonstration("two", hold(TWO))])
    with pytest.raises(OsgError, match="only held hand shapes, which are found between salutes"):
        Spotter(Recognizer(held))
