"""Forked worker: a worker process that the fork server of this process has started."""

from __future__ import annotations

import asyncio
import atexit
import contextlib
import functools
import json
import os
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Sequence
from typing import Final, Self

from app.api.workers.executor import PACKAGE_PARENT
from app.api.workers.rights import environment_of_workers

FORK_SERVER: Final = ("-m", "app.api.workers.fork_server")
"""Arguments of Python that start a fork server."""

END_SECONDS: Final = 5.0
"""Longest wait in seconds for the end of the fork server, which takes some milliseconds."""


@functools.cache
def can_fork() -> bool:
    """Return whether this system has file descriptors of processes, as Linux since 5.3."""
    try:
        os.close(os.pidfd_open(os.getpid()))
    except (AttributeError, OSError):
        return False
    return True


class ForkedWorker:
    """A running worker process.

    Parameters
    ----------
    process
        Its file descriptor (pidfd), which unlike a process id is never reused for another process.
    lines, connection
        Its output, and the connection without which it ends.

    """

    def __init__(
        self, process: int, lines: asyncio.StreamReader, connection: asyncio.StreamWriter
    ) -> None:
        self._process = process
        self._lines = lines
        self._connection = connection

    @classmethod
    async def begin(cls, arguments: Sequence[str]) -> Self | None:
        """Begin a worker; return None if none can be forked now, with the reason on stderr."""
        lines, connection = await asyncio.open_unix_connection(sock=_fork_server.connect())
        process = None
        try:
            process = await _open_process(lines)
        finally:
            if process is None:
                connection.close()
        if process is None:
            return None
        command = {"arguments": list(arguments), "environment": environment_of_workers()}
        connection.write(json.dumps(command).encode() + b"\n")
        return cls(process, lines, connection)

    async def readline(self, silence_seconds: float | None = None) -> bytes:
        """Return the next line; see `Lines`."""
        try:
            return await asyncio.wait_for(self._lines.readline(), silence_seconds)
        except ConnectionResetError:  # The process ended before it had read its command.
            return b""

    async def end(self) -> None:
        """End the process, and wait until it has ended."""
        loop = asyncio.get_running_loop()
        ended = asyncio.Event()
        loop.add_reader(self._process, ended.set)
        try:
            with contextlib.suppress(ProcessLookupError):
                signal.pidfd_send_signal(self._process, signal.SIGKILL)
            await ended.wait()
        finally:
            loop.remove_reader(self._process)
            os.close(self._process)
            self._connection.close()


async def _open_process(lines: asyncio.StreamReader) -> int | None:
    """Return the file descriptor of the process that sends its id; None if it is gone."""
    try:
        # The process waits for its command after sending its id, so the id is still its own.
        said = await lines.readline()
        return os.pidfd_open(int(said)) if said else None
    except (ConnectionResetError, ProcessLookupError):
        return None


class _ForkServer:
    """Fork server of this process, started with the first worker."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._requests: socket.socket | None = None

    def connect(self) -> socket.socket:
        """Return a connection to a process that is about to be forked."""
        ours, its = socket.socketpair()
        with its, self._lock:
            if self._requests is None or not _give(self._requests, its):
                self._requests = self._restart()
                _give(self._requests, its)
        return ours

    def end(self) -> None:
        """End the fork server if it runs; a later connection starts another one."""
        with self._lock:
            if self._process is not None and self._requests is not None:
                self._requests.close()
                self._requests = None
                try:
                    self._process.wait(END_SECONDS)
                except subprocess.TimeoutExpired:
                    self._process.kill()

    def _restart(self) -> socket.socket:
        if self._process is not None:
            self._process.kill()
            self._process.wait()
        ours, its = socket.socketpair(type=socket.SOCK_SEQPACKET)
        with its:
            self._process = subprocess.Popen(
                [sys.executable, *FORK_SERVER],
                stdin=its.fileno(),
                stdout=subprocess.DEVNULL,
                cwd=PACKAGE_PARENT,
                env=environment_of_workers(),
                # Ctrl-C in the terminal is for the server, which then ends its workers in order.
                start_new_session=True,
            )
        return ours


def _give(requests: socket.socket, connection: socket.socket) -> bool:
    """Send a connection to the fork server; return False if it is gone."""
    try:
        socket.send_fds(requests, [b"+"], [connection.fileno()])
    except OSError:
        requests.close()
        return False
    return True


_fork_server: Final = _ForkServer()
atexit.register(_fork_server.end)
