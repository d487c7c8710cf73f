"""Starting, listening to and ending one worker process."""

from __future__ import annotations

import asyncio
import contextlib
import sys
import tempfile
from asyncio.subprocess import PIPE, Process
from collections.abc import AsyncGenerator, AsyncIterator, Iterator
from contextlib import aclosing, asynccontextmanager
from pathlib import Path
from typing import TypeVar

from app.api.extraction.clip_files import ClipFiles
from app.api.extraction.keypoint_source import KeypointSource
from app.api.extraction.messages import (
    BagProbed,
    Failed,
    Finished,
    KeypointsProbed,
    Message,
    Probed,
    Progressed,
    parse,
)
from app.settings import Settings

Answer = TypeVar("Answer", Probed, BagProbed, KeypointsProbed, Finished)

PROBE_SECONDS = 30.0
"""Longest time for looking into a clip; it decodes one frame, which takes milliseconds."""

PROBE_BAG_SECONDS = 120.0
"""Longest time for looking into a dive recording. All of it is read once to know how long its
topics are, and unpacked before: the largest there may be (`app.bags.staging.MOST_BYTES`) at
20 MB/s, the slowest disk that is still sold."""

_PACKAGE_PARENT = Path(__file__).resolve().parents[3]

_DECODER_FAILED = Failed(
    code="decoder",
    detail="the process that read this clip broke off: the clip is damaged, or it needs more "
    "memory or time than a job may use; convert it to an MP4 with H.264 and try again",
)
_BAG_FAILED = Failed(
    code="bag_unreadable",
    detail="the process that read this dive recording broke off: the recording is damaged, or it "
    "needs more memory or time than a job may use; cut out the part with the gestures",
)
_KEYPOINTS_FAILED = Failed(
    code="keypoints_unreadable",
    detail="the process that read this keypoint file broke off: the file is damaged, or it needs "
    "more memory or time than a job may use; cut out the part with the gestures",
)
_DECODER_HANGS = Failed(
    code="decoder",
    detail="the process that read this clip made no progress and was ended; "
    "convert it to an MP4 with H.264 and try again",
)


async def probe(clip: Path, settings: Settings) -> Probed | Failed:
    """Look into a clip, in a process of its own."""
    command = ["probe", str(clip)]
    return await _answer(Probed, command, settings, PROBE_SECONDS) or _DECODER_FAILED


async def probe_bag(bag: Path, settings: Settings) -> BagProbed | Failed:
    """Look into a dive recording, in a process of its own."""
    with _scratch(bag.parent) as scratch:
        command = [_place(scratch), "probe-bag", str(bag)]
        return await _answer(BagProbed, command, settings, PROBE_BAG_SECONDS) or _BAG_FAILED


async def probe_keypoints(
    file: Path, told: KeypointSource, settings: Settings
) -> KeypointsProbed | Failed:
    """Look into a keypoint file, in a process of its own."""
    with _scratch(file.parent) as scratch:
        command = [_place(scratch), "probe-keypoints", _how(told), str(file)]
        answer = await _answer(KeypointsProbed, command, settings, PROBE_BAG_SECONDS)
    return answer or _KEYPOINTS_FAILED


async def extract(
    files: ClipFiles, settings: Settings
) -> AsyncGenerator[Progressed | Finished | Failed, None]:
    """Extract a clip, in a process of its own; the last message says how it ended."""
    command = ["extract", f"--water={settings.water}", *files.arguments]
    async with aclosing(_extraction(command, settings)) as messages:
        async for message in messages:
            yield message


async def extract_bag(
    bag: Path, topic: str | None, files: ClipFiles, settings: Settings
) -> AsyncGenerator[Progressed | Finished | Failed, None]:
    """Extract a topic of a dive recording as `extract` does, and write its video."""
    chosen = [] if topic is None else [f"--topic={topic}"]
    with _scratch(bag.parent) as scratch:
        command = [_place(scratch), "extract-bag", f"--water={settings.water}", *chosen]
        command += [str(bag), *files.arguments]
        async with aclosing(_extraction(command, settings)) as messages:
            async for message in messages:
                yield message


async def extract_keypoints(
    file: Path, told: KeypointSource, files: ClipFiles, settings: Settings
) -> AsyncGenerator[Progressed | Finished | Failed, None]:
    """Read a keypoint file, and write its recording and a video of the skeleton."""
    with _scratch(file.parent) as scratch:
        command = [_place(scratch), "extract-keypoints", _how(told), str(file), *files.arguments]
        async with aclosing(_extraction(command, settings)) as messages:
            async for message in messages:
                yield message


async def write_session(
    wishes: bytes, session: Path, files: ClipFiles, settings: Settings
) -> Finished | Failed:
    """Write a clip's session as MCAP to `session`, in a process of its own."""
    with _scratch(session.parent) as scratch:
        wanted = scratch / "wishes.json"
        await asyncio.to_thread(wanted.write_bytes, wishes)
        command = [_place(scratch), "session", str(wanted), str(session), *files.arguments]
        silence = settings.worker_silence_seconds
        return await _answer(Finished, command, settings, silence) or _DECODER_FAILED


async def _answer(
    kind: type[Answer], command: list[str], settings: Settings, silence_seconds: float
) -> Answer | Failed | None:
    """Return the answer of a worker that is asked for one, or None where it ends without."""
    async with aclosing(_messages(command, settings, silence_seconds)) as messages:
        async for message in messages:
            if isinstance(message, (kind, Failed)):
                return message
    return None


async def _extraction(
    command: list[str], settings: Settings
) -> AsyncGenerator[Progressed | Finished | Failed, None]:
    async with aclosing(_messages(command, settings, settings.worker_silence_seconds)) as messages:
        async for message in messages:
            if isinstance(message, Progressed):
                yield message
            elif isinstance(message, Finished | Failed):
                yield message
                return
    yield _DECODER_FAILED


@contextlib.contextmanager
def _scratch(folder: Path) -> Iterator[Path]:
    """Give a worker a folder of its own, which goes even when the worker is killed."""
    # Beside the recording: on the same disk, and swept at the next start if this process dies.
    with tempfile.TemporaryDirectory(prefix=".unpacked-", dir=folder) as made:
        yield Path(made)


def _how(told: KeypointSource) -> str:
    return f"--told={told.model_dump_json()}"


def _place(scratch: Path) -> str:
    return f"--scratch={scratch}"


async def _messages(
    command: list[str], settings: Settings, silence_seconds: float
) -> AsyncGenerator[Message, None]:
    async with _worker(command, settings) as process:
        assert process.stdout is not None
        while True:
            try:
                line = await asyncio.wait_for(process.stdout.readline(), silence_seconds)
                if not line:
                    return
                yield parse(line)
            except TimeoutError:
                yield _DECODER_HANGS
                return
            except ValueError:
                return  # A line torn by a crash.


@asynccontextmanager
async def _worker(command: list[str], settings: Settings) -> AsyncIterator[Process]:
    process = await asyncio.create_subprocess_exec(
        sys.executable,
        "-m",
        "app.api.extraction.worker",
        f"--memory-bytes={settings.worker_memory_bytes}",
        f"--cpu-seconds={settings.worker_cpu_seconds}",
        f"--file-bytes={settings.worker_file_bytes}",
        *command,
        stdin=PIPE,
        stdout=PIPE,
        cwd=_PACKAGE_PARENT,
        # Ctrl-C in the terminal is for the server, which then ends its workers in order.
        start_new_session=True,
    )
    try:
        yield process
    finally:
        with contextlib.suppress(ProcessLookupError):
            process.kill()
        await process.wait()
