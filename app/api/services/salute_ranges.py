"""Salute ranges: the held salutes of a clip, its other parts, and those that a range contains."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from app.api.services.running_studio import Studio
from app.recognition.poses.landmarks import WRISTS
from app.recognition.poses.sequence import PoseSequence
from app.recognition.recording.recording import Recording
from app.recognition.recording.salute import ENTER_SCORE, HOLD_SECONDS
from app.recognition.recording.segmentation import takes_in
from app.recognition.triggers.arm_pose import HOLD_SECONDS as POSE_SECONDS
from app.recognition.triggers.trigger import SALUTE, Trigger
from app.store import JobStatus

LEAST_OVERLAP = 0.1
"""Least seconds of a salute in a range for it to count as contained, because the ends of a take
touch its salutes."""

CACHED_CLIPS = 512
"""Number of clips whose salutes are cached: the demonstrations of several large languages."""

WINDOW_SECONDS = 0.2
"""Step at which a wrist's speed is measured to find rests: longer than jitter of the pose model,
shorter than any rest that matters."""

RESTING_SPEED = 0.1
"""Share of the highest speed below which the wrists rest: above sway in water."""

SaluteRange = tuple[float, float]


def find_salutes(recording: Recording, trigger: Trigger = SALUTE) -> tuple[SaluteRange, ...]:
    """Return start and end, in seconds, of every salute, or other trigger, held long enough."""
    scores = np.maximum(*trigger.score(recording.poses, recording.salute))
    held, hold = scores >= ENTER_SCORE, POSE_SECONDS if trigger.start else HOLD_SECONDS
    steps = np.flatnonzero(np.diff(np.concatenate([[False], held, [False]])))
    time = recording.poses.time
    ranges = [(float(time[a]), float(time[b - 1])) for a, b in steps.reshape(-1, 2)]
    return tuple((start, end) for start, end in ranges if end - start >= hold)


def count_salutes(salutes: tuple[SaluteRange, ...], start: float, end: float) -> int:
    """Return how many salutes a range of seconds contains, wholly or in part."""
    return sum(min(b, end) - max(a, start) >= LEAST_OVERLAP for a, b in salutes)


def count_salutes_in_clip(
    studio: Studio, clip_id: str, start: float, end: float, trigger: Trigger = SALUTE
) -> int:
    """Return how many salutes a range of a clip contains; 0 while its poses are not extracted."""
    outline = outline_of(studio, clip_id, trigger)
    return 0 if outline is None else count_salutes(outline.salutes, start, end)


@dataclass(frozen=True)
class Outline:
    """The parts of a clip, in seconds.

    Attributes
    ----------
    salutes
        The held salutes, or other triggers.
    strokes
        The gesture of each take, without transit.
    start, end
        First and last frame.
    moving
        First and last moment at which a wrist moves.

    """

    salutes: tuple[SaluteRange, ...]
    strokes: tuple[tuple[float, float], ...]
    start: float
    end: float
    moving: tuple[float, float]


def outline_of(studio: Studio, clip_id: str, trigger: Trigger = SALUTE) -> Outline | None:
    """Return the parts of a clip; None while its poses are not extracted."""
    if studio.clips.get(clip_id).job.status != JobStatus.DONE:
        return None
    return _outline_of(str(studio.clips.recording(clip_id)), trigger)


@lru_cache(CACHED_CLIPS)
def _outline_of(path: str, trigger: Trigger) -> Outline:
    recording = Recording.load(path)
    time = recording.poses.time
    return Outline(
        salutes=find_salutes(recording, trigger),
        strokes=tuple(
            (take.stroke_start, take.stroke_end) for take in takes_in(recording, trigger=trigger)
        ),
        start=float(time[0]),
        end=float(time[-1]),
        moving=_find_movement(recording.poses),
    )


def _find_movement(poses: PoseSequence) -> tuple[float, float]:
    """Return the first and the last moment at which a wrist moves; the whole clip if none does."""
    time = poses.time
    rows = [poses.landmarks.index(name) for name in WRISTS if name in poses.landmarks]
    grid = np.arange(float(time[0]), float(time[-1]), WINDOW_SECONDS)
    if not rows or len(grid) < 3:
        return float(time[0]), float(time[-1])
    speed = np.zeros(len(grid) - 1)
    for row in rows:
        seen = np.isfinite(poses.xy[:, row]).all(axis=1)
        if seen.any():
            path = [np.interp(grid, time[seen], poses.xy[seen, row, axis]) for axis in (0, 1)]
            speed = np.maximum(speed, np.hypot(*np.diff(path, axis=1)))
    moving = np.flatnonzero(speed > RESTING_SPEED * speed.max())
    if not len(moving):
        return float(time[0]), float(time[-1])
    return float(grid[moving[0]]), float(grid[moving[-1] + 1])
