"""Bag export: writes the keypoints and recognitions of a clip as MCAP, for general viewers.

Time is the clip's: its first frame is at 0 s, which players show as the beginning of 1970.
"""

from __future__ import annotations

import base64
import heapq
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from app import __version__
from app.bags import export_schemas, foxglove_overlay
from app.bags.bag import NEEDED
from app.bags.video_writer import packets
from app.recognition.decision.result import Recognition
from app.recognition.errors import explain_missing_package
from app.recognition.poses.sequence import PoseSequence
from app.recognition.recording.extraction import Progress
from app.recognition.recording.recording import Recording
from app.recognition.recording.segmentation import Take, TakeMachine, takes_in
from app.recognition.recording.video import read_frames
from app.recognition.text.wording import ask_which
from app.recognition.triggers.trigger import SALUTE, Trigger

CHANNELS: dict[str, export_schemas.Schema] = {
    "/video": export_schemas.VIDEO,
    "/pose": export_schemas.ANNOTATIONS,
    "/label": export_schemas.ANNOTATIONS,
    "/keypoints": export_schemas.KEYPOINTS,
    "/salute": export_schemas.SALUTE,
    "/takes": export_schemas.TAKE,
    "/recognitions": export_schemas.RECOGNITION,
    "/log": export_schemas.LOG,
}
"""Schema of each topic. A take and a recognition are logged when they end."""

FRAME_ID = "camera"

PIXEL_DIGITS, SCORE_DIGITS = 2, 4
"""Decimals of a coordinate in pixels and of a score: no model resolves a hundredth of a pixel."""

WARNING = 3
"""Foxglove's level of a log message."""


@dataclass(frozen=True, eq=False)
class NamedRecognition:
    """A recognition, with its range and language.

    Attributes
    ----------
    start, end
        Seconds in the clip.
    language, revision
        Name and revision of the language used.
    result
        The recogniser's answer.
    expected
        The expected label, if known.

    """

    start: float
    end: float
    language: str
    revision: int
    result: Recognition
    expected: str | None = None


@dataclass(frozen=True, order=True)
class _Event:
    """One message; ordered only by time, so that messages of one source keep their order."""

    time: float
    topic: str
    content: dict[str, Any]


def write_bag(
    target: Path,
    recording: Recording,
    recognitions: Sequence[NamedRecognition] = (),
    *,
    video: Path | None = None,
    name: str = "",
    trigger: Trigger = SALUTE,
    progress: Progress | None = None,
) -> None:
    """Write keypoints, salute, takes, recognitions and video of a clip to an MCAP file.

    Parameters
    ----------
    target
        The file; incomplete when this raises.
    recording
        Keypoints of the clip.
    recognitions
        Recognitions in the clip.
    video
        The clip's video; None for none.
    name
        Name of the clip.
    trigger
        What begins and ends the takes.
    progress
        ``progress(done, total)`` frames.

    Raises
    ------
    BagError
        When the package that writes MCAP is not installed.
    VideoError
        When the video cannot be read.

    """
    with explain_missing_package("writing MCAP", *NEEDED):
        from mcap.writer import CompressionType, Writer
    with target.open("wb") as file:
        writer = Writer(file, compression=CompressionType.ZSTD)
        writer.start(profile="", library=f"osg-studio {__version__}")
        channels = {}
        for topic, schema in CHANNELS.items():
            data = json.dumps(schema, separators=(",", ":")).encode()
            known = writer.register_schema(schema["title"], "jsonschema", data)
            channels[topic] = writer.register_channel(topic, "json", known)
        about = {"clip": name, "program": "osg-studio", "version": __version__}
        writer.add_metadata("session", about | {"time": "seconds of the clip; first frame at 0"})
        for event in _events(recording, recognitions, video, trigger, progress):
            stamp = round(event.time * 1e9)
            content = json.dumps(event.content, separators=(",", ":"), allow_nan=False).encode()
            writer.add_message(channels[event.topic], stamp, content, stamp)
        writer.finish()  # type: ignore[no-untyped-call]  # the only untyped function


def _events(
    recording: Recording,
    recognitions: Sequence[NamedRecognition],
    video: Path | None,
    trigger: Trigger,
    progress: Progress | None,
) -> Iterator[_Event]:
    """Yield all messages in the order of time."""
    sources = [
        _log(recording.list_warnings(trigger)),
        _frames(recording, trigger, progress),
        _takes(takes_in(recording, trigger=trigger)),
        _recognition_events(recognitions),
        _labels(recognitions),
    ]
    if video is not None:
        sources.append(_video(video))
    yield from heapq.merge(*sources, key=lambda event: event.time)


def _log(warnings: Sequence[str]) -> Iterator[_Event]:
    for warning in warnings:
        content = {"timestamp": stamp_of(0), "level": WARNING, "message": warning}
        yield _Event(0.0, "/log", content | {"name": "osg-studio", "file": "", "line": 0})


def _frames(recording: Recording, trigger: Trigger, progress: Progress | None) -> Iterator[_Event]:
    poses, machine = recording.poses, TakeMachine.of(trigger)
    begin, end = (each.tolist() for each in trigger.score(poses, recording.salute))
    for index, time in enumerate(poses.time.tolist()):
        machine.update(time, begin[index], end[index])
        score = max(begin[index], end[index])
        stamp = stamp_of(time)
        yield _Event(time, "/keypoints", _keypoints(recording, index, stamp))
        drawn = foxglove_overlay.skeleton(poses.xy[index], poses.landmarks, poses.frame_size, stamp)
        yield _Event(time, "/pose", drawn)
        salute = {"timestamp": stamp, "score": round(score, SCORE_DIGITS)}
        state = {"held": machine.held, "state": machine.state.value}
        yield _Event(time, "/salute", salute | state)
        if progress is not None:
            progress(index + 1, len(poses))


def _keypoints(recording: Recording, index: int, stamp: dict[str, int]) -> dict[str, Any]:
    poses = recording.poses
    width, height = poses.frame_size
    hands = [
        {"side": hand.side, "score": round(hand.score, SCORE_DIGITS), "keypoints": points}
        for hand in recording.hands[index]
        if (points := foxglove_overlay.points(hand.xy))
    ]
    return {
        "timestamp": stamp,
        "image_width": width,
        "image_height": height,
        "body": _body(poses, index),
        "hands": hands,
    }


def _body(poses: PoseSequence, index: int) -> list[dict[str, Any]]:
    confidence = np.ones(len(poses.landmarks))
    if poses.confidence is not None:
        confidence = poses.confidence[index]
    return [
        {
            "name": poses.landmarks[row],
            "x": round(float(poses.xy[index, row, 0]), PIXEL_DIGITS),
            "y": round(float(poses.xy[index, row, 1]), PIXEL_DIGITS),
            "confidence": round(float(confidence[row]), SCORE_DIGITS),
        }
        for row in np.flatnonzero(poses.seen[index]).tolist()
    ]


def _takes(takes: Sequence[Take]) -> Iterator[_Event]:
    for take in takes:
        content = {"start": take.start, "end": take.end, "closed": take.closed}
        stroke = {"stroke_start": take.stroke_start, "stroke_end": take.stroke_end}
        yield _Event(take.end, "/takes", content | stroke)


def _recognition_events(recognitions: Sequence[NamedRecognition]) -> Iterator[_Event]:
    for each in sorted(recognitions, key=lambda one: one.end):
        result = each.result
        votes = [
            {"voter": voter, "label": label, "weight": float(result.weights[voter])}
            for voter, label in result.votes.items()
        ]
        distances = [
            {"voter": voter, "gesture": gesture, "distance": float(result.distances[row, column])}
            for row, voter in enumerate(result.voters)
            for column, gesture in enumerate(result.gestures)
            if np.isfinite(result.distances[row, column])
        ]
        yield _Event(
            each.end,
            "/recognitions",
            {
                "start": each.start,
                "end": each.end,
                "language": each.language,
                "revision": each.revision,
                "profile": result.profile,
                "label": result.label or "",
                "pair": list(result.pair or ()),
                "nearest": result.nearest,
                "rejected": result.outcome == "rejected",
                "reason": result.fault or "",
                "confidence": result.confidence,
                "expected": each.expected or "",
                "votes": votes,
                "distances": distances,
            },
        )


def _labels(recognitions: Sequence[NamedRecognition]) -> Iterator[_Event]:
    """Yield messages that show each label from the end of its take to the start of the next one."""
    events = []
    for each in recognitions:
        shown = each.result.label or f"no gesture, nearest {each.result.nearest}"
        if each.result.pair is not None:
            shown = ask_which(each.result.pair)
        text = f"{shown}  {each.result.confidence:.2f}"
        for time, drawn in ((each.start, ""), (each.end, text)):
            events.append(_Event(time, "/label", foxglove_overlay.label(drawn, stamp_of(time))))
    yield from sorted(events, key=lambda event: event.time)


def _video(video: Path) -> Iterator[_Event]:
    with read_frames(video) as frames:
        for time, packet in packets(frames):
            content = {"timestamp": stamp_of(time), "frame_id": FRAME_ID, "format": "h264"}
            yield _Event(
                time, "/video", content | {"data": base64.b64encode(packet).decode("ascii")}
            )


def stamp_of(seconds: float) -> dict[str, int]:
    """Return a moment of the clip in whole seconds and nanoseconds."""
    whole, rest = divmod(max(0, round(seconds * 1e9)), 1_000_000_000)
    return {"sec": whole, "nsec": rest}
