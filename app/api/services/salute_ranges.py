"""Salute ranges: the held salutes of a clip, and those that a demonstration contains by mistake."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from app.api.services.studio import Studio
from app.recognition.recording.recording import Recording
from app.recognition.recording.salute import ENTER_SCORE, HOLD_SECONDS
from app.store import JobStatus

LEAST_OVERLAP = 0.1
"""Seconds of a salute that count as contained: the ends of a take touch its salutes."""

CACHED_CLIPS = 512
"""Clips whose salutes are kept: the demonstrations of several large languages."""

SaluteRange = tuple[float, float]


def find_salutes(recording: Recording) -> tuple[SaluteRange, ...]:
    """Return start and end, in seconds, of every salute that is held long enough."""
    held = np.asarray(recording.salute) >= ENTER_SCORE
    steps = np.flatnonzero(np.diff(np.concatenate([[False], held, [False]])))
    time = recording.poses.time
    ranges = [(float(time[a]), float(time[b - 1])) for a, b in steps.reshape(-1, 2)]
    return tuple((start, end) for start, end in ranges if end - start >= HOLD_SECONDS)


def count_salutes(salutes: tuple[SaluteRange, ...], start: float, end: float) -> int:
    """Return how many salutes a range of seconds contains, wholly or in part."""
    return sum(min(b, end) - max(a, start) >= LEAST_OVERLAP for a, b in salutes)


def count_salutes_in_clip(studio: Studio, clip_id: str, start: float, end: float) -> int:
    """Return how many salutes a range of a clip contains; 0 while its poses are not extracted."""
    if studio.clips.get(clip_id).job.status != JobStatus.DONE:
        return 0
    return count_salutes(_salutes_of(str(studio.clips.recording(clip_id))), start, end)


@lru_cache(CACHED_CLIPS)
def _salutes_of(path: str) -> tuple[SaluteRange, ...]:
    return find_salutes(Recording.load(path))
