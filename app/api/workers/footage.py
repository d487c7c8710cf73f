"""Footage: finds the landmarks of many clips by several processes at a time, each clip once."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from app.api.workers.tasks import FindLandmarks
from app.api.workers.worker_messages import Answered, Failed, Progressed
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
        Their files, or folders of one recording's chapters.
    keep_in
        Folder of the recordings, named by the clips' content; existing ones are not extracted
        again.
    workers
        Starts the processes.
    progress
        Called after every progress.
    options
        How they are read.

    """

    def __init__(
        self,
        clips: Sequence[Path],
        keep_in: Path,
        workers: Workers,
        progress: Callable[[FootageProgress], None],
        options: ReadOptions | None = None,
    ) -> None:
        self._keep_in = keep_in
        self._workers = workers
        self._progress = progress
        self._options = options or ReadOptions()
        self._sizes = {
            clip: sum(file.stat().st_size for file in (clip.iterdir() if clip.is_dir() else [clip]))
            for clip in clips
        }
        self._read = dict.fromkeys(clips, 0)
        self._locks: dict[Path, asyncio.Lock] = {}
        self._ended = 0

    @property
    def total_bytes(self) -> int:
        """Bytes of all clips."""
        return sum(self._sizes.values())

    async def extract(self, count: int) -> list[Extracted]:
        """Find the landmarks of all clips in `count` processes; return the result of each."""
        self._keep_in.mkdir(parents=True, exist_ok=True)
        places = asyncio.Semaphore(count)
        async with asyncio.TaskGroup() as group:
            tasks = [group.create_task(self._work(clip, places)) for clip in self._sizes]
        return sorted((task.result() for task in tasks), key=lambda ended: ended.clip)

    async def _work(self, clip: Path, places: asyncio.Semaphore) -> Extracted:
        async with places:
            try:
                ended = await self._find(clip)
            except (OsgError, OSError) as error:
                ended = Extracted(clip, None, problem=str(error))
        self._ended += 1
        self._advance(clip, 1.0)
        return ended

    async def _find(self, clip: Path) -> Extracted:
        turn = self._options.turn
        recording = await asyncio.to_thread(kept_recording, clip, self._keep_in, turn)
        # Two clips of the same content have one recording.
        async with self._locks.setdefault(recording, asyncio.Lock()):
            if recording.is_file():
                return Extracted(clip, recording)
            task = FindLandmarks(
                source=source_of(clip).name,
                file=clip,
                options=self._options,
                recording=recording,
                threads=THREADS,
            )

            async def hear(step: Progressed | Answered) -> None:
                if isinstance(step, Progressed):
                    self._advance(clip, step.done / max(step.total, 1))

            ended = await self._workers.run(task, hear)
        problem = ended.detail if isinstance(ended, Failed) else ""
        return Extracted(clip, None if problem else recording, not problem, problem)

    def _advance(self, clip: Path, share: float) -> None:
        self._read[clip] = round(share * self._sizes[clip])
        self._progress(FootageProgress(self._ended, sum(self._read.values())))
