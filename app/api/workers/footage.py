"""Footage: finds the landmarks of many clips by several processes at a time, each clip once."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Callable, Sequence
from contextlib import aclosing
from dataclasses import dataclass
from pathlib import Path

from app.api.workers.worker_messages import Failed, Progressed
from app.api.workers.worker_processes import Workers
from app.clip_sources import ReadOptions, source_of
from app.evaluation.kept_recordings import kept_recording
from app.recognition.errors import OsgError

THREADS = 1
"""Threads of the models in each process: one process per core is faster than fewer processes with
more threads, because clips run in parallel, but body and hands within a clip take turns."""


@dataclass(frozen=True)
class Extracted:
    """Result of one clip.

    Attributes
    ----------
    clip
        The clip's file.
    recording
        The file of its landmarks; None if there is none, for the reason in `problem`.
    new
        Whether the landmarks were extracted now, and not kept from before.
    problem
        One line for a person.

    """

    clip: Path
    recording: Path | None
    new: bool = False
    problem: str = ""


@dataclass(frozen=True)
class FootageProgress:
    """Progress: number of finished clips, and bytes of all clips read so far."""

    clips: int
    done_bytes: int


class Footage:
    """Clips whose landmarks are wanted.

    Parameters
    ----------
    clips
        Their files.
    keep_in
        Folder of the recordings, named by the clips' content; existing ones are not extracted
        again.
    workers
        Starts the processes.
    progress
        Called after every progress.

    """

    def __init__(
        self,
        clips: Sequence[Path],
        keep_in: Path,
        workers: Workers,
        progress: Callable[[FootageProgress], None],
    ) -> None:
        self._waiting = deque(clips)
        self._keep_in = keep_in
        self._workers = workers
        self._progress = progress
        self._sizes = {clip: clip.stat().st_size for clip in clips}
        self._read = dict.fromkeys(clips, 0)
        self._done_bytes = 0
        self._locks: dict[Path, asyncio.Lock] = {}
        self._ended: list[Extracted] = []

    @property
    def total_bytes(self) -> int:
        """Bytes of all clips."""
        return sum(self._sizes.values())

    async def extract(self, count: int) -> list[Extracted]:
        """Find the landmarks of all clips in `count` processes; return the result of each."""
        self._keep_in.mkdir(parents=True, exist_ok=True)
        async with asyncio.TaskGroup() as group:
            for _ in range(min(count, len(self._waiting))):
                group.create_task(self._work())
        return sorted(self._ended, key=lambda ended: ended.clip)

    async def _work(self) -> None:
        while self._waiting:
            clip = self._waiting.popleft()
            try:
                ended = await self._find(clip)
            except (OsgError, OSError) as error:
                ended = Extracted(clip, None, problem=str(error))
            self._ended.append(ended)
            self._advance(clip, 1.0)

    async def _find(self, clip: Path) -> Extracted:
        recording = await asyncio.to_thread(kept_recording, clip, self._keep_in)
        # Two clips of the same content have one recording.
        async with self._locks.setdefault(recording, asyncio.Lock()):
            if recording.is_file():
                return Extracted(clip, recording)
            source, options = source_of(clip), ReadOptions()
            messages = self._workers.find_landmarks(source, clip, options, recording, THREADS)
            async with aclosing(messages) as steps:
                async for step in steps:
                    if isinstance(step, Progressed):
                        self._advance(clip, step.done / max(step.total, 1))
                    elif isinstance(step, Failed):
                        return Extracted(clip, None, problem=step.detail)
        return Extracted(clip, recording, new=True)

    def _advance(self, clip: Path, share: float) -> None:
        read = round(share * self._sizes[clip])
        self._done_bytes += read - self._read[clip]
        self._read[clip] = read
        self._progress(FootageProgress(len(self._ended), self._done_bytes))
