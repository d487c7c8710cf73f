"""Local processes: the executor that runs worker processes on this machine.

On Linux a fork server of this process forks them. That of Python (`multiprocessing`) would not do:
it has the environment of the server, which a child can read in ``/proc/self/environ``; each child
loads the server's main module again, and has a pipe by which it can have files of shared memory
removed; and an ended child's id can be killed when it is another process's already.
"""

from __future__ import annotations

import asyncio
import atexit
import contextlib
import functools
import os
import signal
import socket
import subprocess
import sys
import threading
from asyncio.subprocess import PIPE
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from app.api.workers.executor import COMMAND, PACKAGE_PARENT, Lines, Order
from app.api.workers.rights import environment_of_workers, line_of

END_SECONDS: Final = 5.0
"""Longest wait in seconds for the end of the fork server, which takes some milliseconds."""


LOOK_SECONDS: Final = 0.5
"""Seconds between two looks at the memory of all processes; each has a limit of its own."""


class LocalProcesses:
    """Runs worker processes on this machine.

    Parameters
    ----------
    most_bytes
        Most memory of all processes together, beyond which the largest is ended; 0 for no limit.

    """

    def __init__(self, most_bytes: int = 0) -> None:
        self._most = most_bytes
        self._running: list[_Worker] = []
        self._watching: asyncio.Task[None] | None = None

    @asynccontextmanager
    async def start(self, order: Order) -> AsyncIterator[Lines]:
        """Run a task; see `Executor`."""
        line = await asyncio.to_thread(line_of, order)
        # None can be forked while the fork server dies.
        worker = (await _fork_worker() if can_fork() else None) or await _start_worker()
        self._running.append(worker)
        if self._most and (self._watching is None or self._watching.done()):
            self._watching = asyncio.create_task(self._watch())
        try:
            worker.orders.write(line)
            yield worker
        finally:
            self._running.remove(worker)
            await worker.end()

    async def close(self) -> None:
        """Do nothing: every process ends with its context."""

    async def _watch(self) -> None:
        """End the largest process while all together hold too much, as long as any runs."""
        while self._running:
            held = {worker.process: memory_of(worker.process) for worker in self._running}
            if sum(held.values()) > self._most:
                largest = max(self._running, key=lambda worker: held[worker.process])
                with contextlib.suppress(ProcessLookupError):
                    largest.kill()
            await asyncio.sleep(LOOK_SECONDS)


def memory_of(process: int) -> int:
    """Return the bytes of memory that a process has in use; 0 where the system does not tell."""
    try:
        resident = Path(f"/proc/{process}/statm").read_text().split()[1]
    except (OSError, IndexError):
        return 0
    return int(resident) * os.sysconf("SC_PAGE_SIZE")


@functools.cache
def can_fork() -> bool:
    """Return whether this system has file descriptors of processes, as Linux since 5.3."""
    try:
        os.close(os.pidfd_open(os.getpid()))
    except (AttributeError, OSError):
        return False
    return True


@dataclass(frozen=True)
class _Worker:
    """A running worker process; `end` kills it, and waits until it has ended."""

    process: int
    lines: asyncio.StreamReader
    orders: asyncio.StreamWriter
    kill: Callable[[], None]
    end: Callable[[], Awaitable[None]]

    async def readline(self, silence_seconds: float | None = None) -> bytes:
        try:
            return await asyncio.wait_for(self.lines.readline(), silence_seconds)
        except ConnectionResetError:  # The process ended before it had read its order.
            return b""


async def _start_worker() -> _Worker:
    """Start a worker from the beginning."""
    process = await asyncio.create_subprocess_exec(
        sys.executable,
        *COMMAND,
        stdin=PIPE,
        stdout=PIPE,
        cwd=PACKAGE_PARENT,
        env=environment_of_workers(),
        # Ctrl-C in the terminal is for the server, which then ends its workers in order.
        start_new_session=True,
    )

    async def end() -> None:
        with contextlib.suppress(ProcessLookupError):
            process.kill()
        await process.wait()

    assert process.stdin is not None
    assert process.stdout is not None
    return _Worker(process.pid, process.stdout, process.stdin, process.kill, end)


async def _fork_worker() -> _Worker | None:
    """Fork a worker; return None if that is impossible now, with the reason on stderr."""
    lines, connection = await asyncio.open_unix_connection(sock=_fork_server.connect())
    process: int | None = None
    try:
        # The process waits for its order after sending its id, so the id is still its own.
        said = await lines.readline()
        number = int(said or 0)
        process = os.pidfd_open(number) if said else None
    except (ConnectionResetError, ProcessLookupError):
        return None
    finally:
        if process is None:
            connection.close()
    if process is None:
        return None
    kill = functools.partial(signal.pidfd_send_signal, process, signal.SIGKILL)
    end = functools.partial(_end, process, connection)
    return _Worker(number, lines, connection, kill, end)


async def _end(process: int, connection: asyncio.StreamWriter) -> None:
    """Kill a process by its file descriptor, which is never reused for another one."""
    loop = asyncio.get_running_loop()
    ended = asyncio.Event()
    loop.add_reader(process, ended.set)
    try:
        with contextlib.suppress(ProcessLookupError):
            signal.pidfd_send_signal(process, signal.SIGKILL)
        await ended.wait()
    finally:
        loop.remove_reader(process)
        os.close(process)
        connection.close()


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
            if not self._give(its):
                self._restart()
                self._give(its)
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

    def _restart(self) -> None:
        if self._process is not None:
            self._process.kill()
            self._process.wait()
        self._requests, its = socket.socketpair(type=socket.SOCK_SEQPACKET)
        with its:
            self._process = subprocess.Popen(
                [sys.executable, *COMMAND, "--fork-server"],
                stdin=its.fileno(),
                stdout=subprocess.DEVNULL,
                cwd=PACKAGE_PARENT,
                env=environment_of_workers(),
                start_new_session=True,
            )

    def _give(self, connection: socket.socket) -> bool:
        """Send a connection to the fork server; return False if it is not there."""
        if self._requests is None:
            return False
        try:
            socket.send_fds(self._requests, [b"+"], [connection.fileno()])
        except OSError:
            self._requests.close()
            self._requests = None
            return False
        return True


_fork_server: Final = _ForkServer()
atexit.register(_fork_server.end)
