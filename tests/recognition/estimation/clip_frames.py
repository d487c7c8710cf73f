"""Frames of a clip, as an estimator takes them."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice
from pathlib import Path

from app.recognition.recording.video import VideoFrame, read_frames


def clip_frames(clip: Path, count: int, *, every: int = 1) -> Iterator[VideoFrame]:
    """Yield up to `count` frames of `clip`: the first, and then every `every`-th one."""
    with read_frames(clip) as frames:
        yield from islice(frames, 0, count * every, every)
