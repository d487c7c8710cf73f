"""Starting, listening to and ending one worker process."""

from __future__ import annotations

import asyncio
import contextlib
import sys
from asyncio.subprocess import PIPE, Process
from collections.abc import AsyncGenerator, AsyncIterator
from contextlib import aclosing, asynccontextmanager
from pathlib import Path

from app.api.extraction.messages import Failed, Finished, Message, Probed, Progressed, parse
from app.settings import Settings

PROBE_SECONDS = 30.0
"""Longest time for looking into a clip; it decodes one frame, which takes milliseconds."""

_PACKAGE_PARENT = Path(__file__).resolve().parents[3]

_DECODER_FAILED = Failed(
    code="decoder",
    detail="the process that read this clip broke off: the clip is damaged, or it needs more "
    "memory or time than a job may use; convert it to an MP4 with H.264 and try again",
)
_DECODER_HANGS = Failed(
    code="decoder",
    detail="the process that read this clip made no progress and was ended; "
    "convert it to an MP4 with H.264 and try again",
)


async def probe(clip: Path, settings: Settings) -> Probed | Failed:
    """Look into a clip, in a process of its own."""
    async with aclosing(_messages(["probe", str(clip)], settings, PROBE_SECONDS)) as messages:
        async for message in messages:
            if isinstance(message, Probed | Failed):
                return message
    return _DECODER_FAILED


async def extract(
    clip: Path, recording: Path, poster: Path, filmstrip: Path, settings: Settings
) -> AsyncGenerator[Progressed | Finished | Failed, None]:
    """Extract a clip, in a process of its own; the last message says how it ended."""
    files = [str(file) for file in (clip, recording, poster, filmstrip)]
    command = ["extract", f"--water={settings.water}", *files]
    silence_seconds = settings.worker_silence_seconds
    async with aclosing(_messages(command, settings, silence_seconds)) as messages:
        async for message in messages:
            if isinstance(message, Progressed):
                yield message
            elif isinstance(message, Finished | Failed):
                yield message
                return
    yield _DECODER_FAILED


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
