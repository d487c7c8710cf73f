"""Recordings of a diver whose right hand draws, between two salutes; made of numbers, not video."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from app.recognition import PoseSequence, Recording
from app.recognition.poses.landmarks import POSE_LANDMARKS
from app.recognition.poses.sequence import FloatArray

if TYPE_CHECKING:
    # The robot's code is tested with these recordings also without the studio, as on Python 3.10.
    from app.api.services.running_studio import Studio

RATE = 20
SALUTE_SECONDS = 0.6
STROKE_SECONDS = 2.0
FRAME_SIZE = (640, 480)


def circle(share: FloatArray) -> FloatArray:
    """Return ``(T, 2)`` points of a circle in radii; `share` in [0, 1] is the way round."""
    angle = 2 * np.pi * share
    return np.stack([np.sin(angle), -np.cos(angle)], axis=1)


def line(share: FloatArray) -> FloatArray:
    """Return ``(T, 2)`` points of a line to the side and a little down."""
    return np.stack([2 * share - 1, 0.3 * share], axis=1)


def backwards(share: FloatArray) -> FloatArray:
    """Return ``(T, 2)`` points of the same circle, the other way round."""
    return circle(1 - share)


def corner(share: FloatArray) -> FloatArray:
    """Return ``(T, 2)`` points of a corner: up, then to the side."""
    return np.stack([np.maximum(0, 2 * share - 1), -np.minimum(1, 2 * share)], axis=1)


def square(share: FloatArray) -> FloatArray:
    """Return ``(T, 2)`` points of the square around the circle."""
    round_one = circle(share)
    return np.asarray(round_one / np.abs(round_one).max(axis=1, keepdims=True))


def narrow(share: FloatArray) -> FloatArray:
    """Return ``(T, 2)`` points of that square, three tenths as wide."""
    return np.asarray(square(share) * (0.3, 1.0))


def rounded(share: FloatArray) -> FloatArray:
    """Return ``(T, 2)`` points of a shape that lies between circle and square."""
    return 0.46 * circle(share) + 0.54 * square(share)


def valley(share: FloatArray) -> FloatArray:
    """Return ``(T, 2)`` points of a V: down and up again, above the hips."""
    down = np.clip(2.5 * np.minimum(share, 1 - share), 0, 1)
    return np.stack([0.3 * down, 0.85 * down], axis=1)


def dip(share: FloatArray) -> FloatArray:
    """Return ``(T, 2)`` points of an arm that is lowered until it hangs, and raised again."""
    return 2 * valley(share)


SHAPES = {
    "circle": circle,
    "circle backwards": backwards,
    "line": line,
    "corner": corner,
    "dip": dip,
    "square": square,
    "narrow square": narrow,
    "rounded square": rounded,
    "valley": valley,
}


def recording_of(*shapes: str) -> Recording:
    """Return a recording of takes, one per shape, with a salute before and after each."""
    paths, scores = [], []
    rest = np.zeros((round(SALUTE_SECONDS * RATE), 2))
    between = np.zeros((RATE // 2, 2))
    for shape in shapes:
        stroke = SHAPES[shape](np.linspace(0, 1, round(STROKE_SECONDS * RATE)))
        for path, score in ((rest, 1.0), (stroke, 0.0), (rest, 1.0), (between, 0.0)):
            paths.append(path)
            scores.append(np.full(len(path), score))
    if not shapes:
        paths, scores = [np.zeros((RATE, 2))], [np.zeros(RATE)]
    return _recording(np.concatenate(paths), np.concatenate(scores))


def add_recorded_clip(
    studio: Studio,
    recording: Recording,
    name: str = "dive.mp4",
    *,
    clip_id: str | None = None,
    running: bool = False,
) -> str:
    """Store a clip whose job is done, under an id if one is given, and return its id.

    With `running`, the job has read these frames so far.
    """
    from app.store import Clip
    from app.store.clips import RECORDING, SO_FAR

    partial = studio.clips.new_partial()
    partial.write_bytes(bytes(range(256)) * 4)
    width, height = recording.poses.frame_size
    clip = Clip(name=name, media_type="video/mp4", size=1024, width=width, height=height)
    clip.id = clip_id or clip.id
    added = studio.clips.add(clip, partial, "test")
    studio.jobs.start(added.job.id)
    recording.save(studio.clips.place(clip.id, SO_FAR if running else RECORDING))
    if running:
        return clip.id
    studio.clips.keep_found(clip)
    studio.jobs.complete(
        added.job.id, len(recording.poses), recording.warnings, recording.salute_warnings
    )
    return clip.id


def _recording(wrist: FloatArray, salute: FloatArray) -> Recording:
    frames = len(wrist)
    xy = np.full((frames, len(POSE_LANDMARKS), 2), np.nan)
    for name, place in {
        "nose": (320, 100),
        "left_shoulder": (370, 160),
        "right_shoulder": (270, 160),
        "left_hip": (350, 320),
        "right_hip": (290, 320),
        "left_wrist": (390, 320),
    }.items():
        xy[:, POSE_LANDMARKS.index(name)] = place
    xy[:, POSE_LANDMARKS.index("right_wrist")] = (200, 200) + 80 * wrist
    poses = PoseSequence(
        landmarks=POSE_LANDMARKS,
        xy=xy,
        confidence=np.ones(xy.shape[:2]),
        time=np.arange(frames) / RATE,
        frame_size=FRAME_SIZE,
    )
    return Recording(poses=poses, hands=((),) * frames, salute=salute)
