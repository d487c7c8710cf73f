"""Workers: runs one process for each clip to probe, record or export, in an executor."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import tempfile
from collections.abc import AsyncGenerator, Callable, Collection, Iterator
from contextlib import AbstractContextManager, aclosing, nullcontext
from pathlib import Path

from app.api.observation.metrics import Metrics
from app.api.workers.clip_files import ClipFiles
from app.api.workers.executor import Executor, ExecutorLost, Lines, TaskFiles
from app.api.workers.local_processes import LocalProcesses
from app.api.workers.rights import SCRATCH
from app.api.workers.test_takes import RecognizedTake, TestRunRequest, answer_file
from app.api.workers.worker_messages import Failed, Finished, Message, Probed, Progressed, parse
from app.clip_sources import VIDEO, ClipSource, ReadOptions, Refusal
from app.settings import DASK, Settings

Step = Progressed | Finished | Failed

MOST_SHORT_WORKERS = 2
"""Most processes that probe files or write bags at the same time: a hundred uploads must not start
a hundred processes."""

MOST_CHECKS = 2
"""Most health checks and test runs at the same time; further ones wait."""

IMPORT_SECONDS = 120
"""Most processor time for reading a language file: the largest one allowed takes a minute."""

CHECK_SECONDS = 1800
"""Most processor time for a health report: one of twenty gestures takes twenty seconds,
one of a thousand two minutes."""

CHECK_SILENCE_SECONDS = 600.0
"""Most seconds between two reports of a check: its recogniser is prepared without one."""

AGAIN_SECONDS = 2.0
"""Wait in seconds before a job whose executor was lost is repeated."""

logger = logging.getLogger(__name__)

_DECODER_HANGS = Failed(
    code="decoder",
    detail="the process that read this clip made no progress and was ended; "
    "convert it to an MP4 with H.264 and try again",
)


_TOO_LONG = Failed(
    code="language_too_large",
    detail="this language takes more time or memory than one job may use; "
    "split it into languages with fewer gestures",
)


_BROKEN_OFF = Failed(
    code="test_run_broken_off",
    detail="the process that recognises the takes ended or took too long; what is done is kept, "
    "start it again for the rest",
)


PROBES = 2
"""Processes that may die while they probe a file until it is refused."""


def _hold_nothing(_files: Collection[Path]) -> AbstractContextManager[None]:
    return nullcontext()


class Workers:
    """Starts worker processes with the limits of the settings, by the executor of the settings.

    Parameters
    ----------
    settings
        Limits of memory, time and file size, and whether colours are corrected.
    metrics
        Counts the processes that are ended because they report no progress.
    hold
        Keeps files on this machine for processes that wait for their turn.

    """

    def __init__(
        self,
        settings: Settings,
        metrics: Metrics | None = None,
        hold: Callable[[Collection[Path]], AbstractContextManager[None]] = _hold_nothing,
    ) -> None:
        self._settings = settings
        self._metrics = metrics or Metrics()
        self._hold = hold
        self._here = LocalProcesses()
        self._executor = _executor_of(settings, self._here)
        self._short = asyncio.Semaphore(MOST_SHORT_WORKERS)
        self._checks = asyncio.Semaphore(MOST_CHECKS)

    async def close(self) -> None:
        """Release the connections to other machines."""
        await self._executor.close()

    async def probe(self, source: ClipSource, file: Path, options: ReadOptions) -> Probed | Failed:
        """Probe a received file; see `ClipSource.probe`.

        A process that dies without an outcome may have been killed from outside, for example for
        lack of memory: the file is refused only if it happens twice.
        """
        command = ["probe", source.name, str(file)]
        for _ in range(PROBES):
            # On this machine: the sender waits for the result, and the file may be only here.
            messages = self._run(
                command,
                file.parent,
                source.probe_seconds,
                TaskFiles((file,), ()),
                options,
                executor=self._here,
            )
            async with self._short, aclosing(messages):
                async for message in messages:
                    if isinstance(message, Probed | Failed):
                        return message
        return _failure(source.broken_off)

    async def record(
        self, source: ClipSource, file: Path, options: ReadOptions, files: ClipFiles
    ) -> AsyncGenerator[Step, None]:
        """Record a clip; the last message is the outcome. See `ClipSource.record`."""
        options = options.model_copy(update={"water": self._settings.water})
        command = ["record", source.name, str(file), *files.arguments]
        silence = self._settings.limits.worker_silence_seconds
        made = (files.video,) if source.makes_video else ()
        used = TaskFiles((file,), (*made, files.recording, files.poster, files.filmstrip))
        messages = self._run(command, file.parent, silence, used, options)
        async with aclosing(_steps(messages)) as steps:
            async for step in steps:
                yield step

    async def find_landmarks(
        self, source: ClipSource, file: Path, options: ReadOptions, recording: Path, threads: int
    ) -> AsyncGenerator[Step, None]:
        """Write only a clip's recording; the last message is the outcome.

        `threads` limits the threads of the models if several processes share a machine.
        """
        command = ["landmarks", source.name, str(file), str(recording), f"--threads={threads}"]
        silence = self._settings.limits.worker_silence_seconds
        used = TaskFiles((file,), (recording,))
        messages = self._run(command, recording.parent, silence, used, options)
        async with aclosing(_steps(messages)) as steps:
            async for step in steps:
                yield step

    async def write_bag(
        self, request: bytes, bag: Path, files: ClipFiles
    ) -> AsyncGenerator[Step, None]:
        """Write a clip and its recognitions as MCAP; `request`: a `BagExportRequest` as JSON."""
        parts = files.video, files.recording
        with _scratch_folder(bag.parent) as folder, self._hold(parts):
            wanted, written = folder / "request.json", folder / bag.name
            await asyncio.to_thread(wanted.write_bytes, request)
            command = ["session", str(wanted), str(written), *files.arguments]
            used = TaskFiles((wanted, *parts), (written,))
            messages = self._run(
                command, folder, self._settings.limits.worker_silence_seconds, used
            )
            async with self._short, aclosing(_steps(messages)) as steps:
                async for step in steps:
                    if isinstance(step, Finished):
                        written.replace(bag)
                    yield step

    async def import_language(self, file: Path, name: str) -> str | Failed:
        """Read a language file; return an `ImportedLanguage` as JSON."""
        with _scratch_folder(file.parent) as folder:
            target = folder / "language.json"
            command = ["import", str(file), str(target), f"--name={name}"]
            messages = self._run(
                command,
                folder,
                IMPORT_SECONDS,
                TaskFiles((file,), (target,)),
                cpu_seconds=IMPORT_SECONDS,
                hangs=_TOO_LONG,
            )
            async with self._short, aclosing(messages):
                async for message in messages:
                    if isinstance(message, Failed):
                        return message
            if not target.is_file():
                return _TOO_LONG
            return await asyncio.to_thread(target.read_text, "utf-8")

    async def check_language(
        self, document: str, folder: Path
    ) -> AsyncGenerator[Progressed | Failed | str, None]:
        """Check a language; the last item is the health report as JSON, or the failure."""
        with _scratch_folder(folder) as scratch:
            file, target = scratch / "language.json", scratch / "report.json"
            await asyncio.to_thread(file.write_text, document, "utf-8")
            messages = self._run(
                ["check", str(file), str(target)],
                scratch,
                CHECK_SILENCE_SECONDS,
                TaskFiles((file,), (target,)),
                cpu_seconds=CHECK_SECONDS,
                hangs=_TOO_LONG,
            )
            async with self._checks, aclosing(messages):
                async for message in messages:
                    if isinstance(message, Progressed | Failed):
                        yield message
                    if isinstance(message, Failed):
                        return
            if target.is_file():
                yield await asyncio.to_thread(target.read_text, "utf-8")
            else:
                yield _TOO_LONG

    async def recognize_takes(
        self, request: TestRunRequest, folder: Path
    ) -> AsyncGenerator[RecognizedTake | Failed, None]:
        """Recognise takes; yield the answers in order, and last the failure if some are missing."""
        recordings = tuple(dict.fromkeys(take.recording for take in request.takes))
        with _scratch_folder(folder) as scratch, self._hold(recordings):
            wanted, answers = scratch / "request.json", scratch / "answers"
            answers.mkdir()
            await asyncio.to_thread(wanted.write_text, request.model_dump_json(), "utf-8")
            command = ["test", str(wanted), str(answers)]
            used = TaskFiles((wanted, *recordings), (answers,))
            messages = self._run(command, scratch, CHECK_SILENCE_SECONDS, used, hangs=_BROKEN_OFF)
            done = 0
            async with self._checks, aclosing(messages):
                async for message in messages:
                    if isinstance(message, Failed):
                        yield message
                        return
                    # A repeated process reports its earlier answers again.
                    while isinstance(message, Progressed) and done < message.done:
                        file = answer_file(answers, done)
                        content = await asyncio.to_thread(file.read_bytes)
                        yield RecognizedTake.model_validate_json(content)
                        done += 1
            if done < len(request.takes):
                yield _BROKEN_OFF

    async def _run(
        self,
        command: list[str],
        folder: Path,
        silence_seconds: float,
        files: TaskFiles,
        options: ReadOptions | None = None,
        *,
        cpu_seconds: int | None = None,
        hangs: Failed = _DECODER_HANGS,
        executor: Executor | None = None,
    ) -> AsyncGenerator[Message, None]:
        """Run a worker, which unpacks archives in `folder`, and yield its messages.

        A worker whose executor is lost is repeated from the beginning.
        """
        given = (options or ReadOptions()).model_dump_json(exclude_defaults=True)
        limits = {
            "memory-bytes": self._settings.limits.worker_memory_bytes,
            "cpu-seconds": cpu_seconds or self._settings.limits.worker_cpu_seconds,
            "file-bytes": self._settings.limits.worker_file_bytes,
        }
        arguments = [f"--{name}={value}" for name, value in limits.items()]
        executor = executor or self._executor
        while True:
            with _scratch_folder(folder) as scratch:
                own = [f"{SCRATCH}{scratch}", f"--options={given}"]
                try:
                    async with executor.start([*arguments, *own, *command], files) as lines:
                        async with aclosing(_messages(lines, silence_seconds)) as messages:
                            async for message in messages:
                                yield message
                        return
                except TimeoutError:
                    self._metrics.stalls.inc()
                    yield hangs
                    return
                except ExecutorLost as error:
                    logger.warning("a job is run again: %s", error)
            await asyncio.sleep(AGAIN_SECONDS)


async def _messages(lines: Lines, silence_seconds: float) -> AsyncGenerator[Message, None]:
    """Yield the messages of a process to its end; raise TimeoutError after a long silence."""
    while True:
        try:
            if not (line := await lines.readline(silence_seconds)):
                return
            message = parse(line)
        except ValueError:
            return  # A line torn by a crash, or longer than any of ours.
        yield message


async def _steps(messages: AsyncGenerator[Message, None]) -> AsyncGenerator[Step, None]:
    """Yield progress and the outcome; a process that dies without an outcome has failed."""
    async with aclosing(messages):
        async for message in messages:
            if isinstance(message, Progressed):
                yield message
            elif isinstance(message, Finished | Failed):
                yield message
                return
    # For every kind of file: while landmarks are found, the part that crashes is the decoder.
    yield _failure(VIDEO.broken_off)


def _failure(refusal: Refusal) -> Failed:
    return Failed(code=refusal.code, detail=refusal.detail)


def _executor_of(settings: Settings, here: LocalProcesses) -> Executor:
    if settings.executor is None:
        return here
    from app.api.workers.dask_cluster import DaskCluster
    from app.api.workers.task_folders import OwnFolders

    own = None
    if settings.objects is not None:
        own = OwnFolders(settings.data_dir, settings.clips, settings.objects)
    return DaskCluster(settings.executor.removeprefix(DASK), own)


@contextlib.contextmanager
def _scratch_folder(folder: Path) -> Iterator[Path]:
    """Create a folder that is removed even if the worker is killed."""
    # Beside the clip, so that it is on the same disk, and removed at the next start after a crash.
    with tempfile.TemporaryDirectory(prefix=".unpacked-", dir=folder) as made:
        yield Path(made)
