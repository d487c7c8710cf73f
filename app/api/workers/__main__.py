"""Worker process: ``python -m app.api.workers``, or forked by one with ``--fork-server``.

It reads one line from stdin (`app.api.workers.rights.line_of`), gives up all other rights before it
loads the libraries, which begin threads, and does its task. Its messages go to stdout. It ends as
soon as its stdin is closed, which happens when the server dies.

A fork server has loaded the libraries, so that a forked process begins half a second sooner. Its
stdin is a socket with connections to the processes to be forked.
"""

from __future__ import annotations

import contextlib
import ctypes
import gc
import importlib
import json
import mmap
import os
import signal
import socket
import sys
import tempfile
import threading
from pathlib import Path

from app.system.confinement import confine

_SET_NAME = 15
"""Option of prctl(2) that names a process."""

SPARE_BYTES = 128 * 1024 * 1024
"""Memory that a process must have left for its error to be believed: ten pictures in 4K."""


def main() -> None:
    """Do the task that comes by stdin; in a fork server, fork processes that do."""
    with contextlib.suppress(ConnectionError):  # The job was cancelled meanwhile.
        if "--fork-server" in sys.argv:
            importlib.import_module("app.api.workers.tasks")
            fork_workers()
        if line := sys.stdin.buffer.readline():
            start = json.loads(line)
            os.environ.clear()
            os.environ.update(start["environment"])
            with contextlib.suppress(OSError):
                os.nice(5)  # The page stays responsive while a clip is read.
            confine([(Path(path), right) for path, right in start["grants"]])
            run(start["task"], start["scratch"], *start["limits"])


def fork_workers() -> None:
    """Fork a process for each connection received from stdin; return in each of them.

    It sends its process id first; the connection becomes its stdin and stdout.

    Raises
    ------
    SystemExit
        When the server has closed the socket.

    """
    show_name("fork server")
    # The system removes ended processes, because nobody waits for them here.
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)
    # The imported modules stay in memory that all workers share.
    gc.freeze()
    with socket.socket(fileno=os.dup(sys.stdin.fileno())) as requests:
        while True:
            _, descriptors, _, _ = socket.recv_fds(requests, 1, 1)
            if not descriptors:
                sys.exit()
            connection = socket.socket(fileno=descriptors[0])
            try:
                if os.fork() == 0:
                    break
            except OSError as error:
                # No process or memory is left; the connection ends without an answer.
                print(f"osg-studio: a job cannot be started: {error.strerror}", file=sys.stderr)
            connection.close()
    os.setsid()
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    with connection:
        connection.sendall(b"%d\n" % os.getpid())
        for standard in (sys.stdin.fileno(), sys.stdout.fileno()):
            os.dup2(connection.fileno(), standard)


def run(given: str, scratch: str, *limits: int) -> None:
    """Do a task, given as JSON, within the limits, and report how it ended."""
    from app.api.workers.tasks import TASK
    from app.api.workers.worker_messages import Message, dump
    from app.recognition.errors import OsgError

    task = TASK.validate_json(given)
    show_name(task.kind)
    # Libraries that print must not write into the messages.
    channel = os.fdopen(os.dup(sys.stdout.fileno()), "w", buffering=1, encoding="utf-8")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    tempfile.tempdir = scratch
    # First, because the start of a thread may hang once memory is short.
    threading.Thread(target=end_with_server, daemon=True).start()
    limit_resources(*limits)

    def report(message: Message) -> None:
        for line in dump(message):
            channel.write(line + "\n")

    try:
        task.run(report)
    except (MemoryError, OsgError, OSError) as error:
        # Decoders without memory say that the file is damaged.
        report(task.refuse(error if is_memory_left() else MemoryError()))


def is_memory_left() -> bool:
    """Return whether this process may still use `SPARE_BYTES` more."""
    try:
        mmap.mmap(-1, SPARE_BYTES).close()
    except (MemoryError, OSError):
        return False
    return True


def end_with_server() -> None:
    """Wait until stdin is closed, and end this process."""
    with contextlib.suppress(OSError):
        while os.read(sys.stdin.fileno(), 1024):
            pass
    os._exit(1)


def limit_resources(memory_bytes: int, cpu_seconds: int, file_bytes: int) -> None:
    """Set the system's limits for this process; 0 sets none. Without POSIX do nothing."""
    if os.name != "posix":
        return
    import resource

    limits = (
        (resource.RLIMIT_AS, memory_bytes),
        (resource.RLIMIT_CPU, cpu_seconds),
        # Limits each written file: an archive packed a million to one must not fill the disk.
        (resource.RLIMIT_FSIZE, file_bytes),
    )
    for kind, limit in limits:
        if limit:
            _, hard = resource.getrlimit(kind)
            most = limit if hard == resource.RLIM_INFINITY else min(limit, hard)
            # Both, because a process that a file has taken over could raise the first again.
            resource.setrlimit(kind, (most, most))
    # Crashes are expected here, and core dumps of videos are useless.
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def show_name(name: str) -> None:
    """Give this process the name ``osg NAME`` in lists of processes, where that is possible."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_SET_NAME, f"osg {name}".encode())


if __name__ == "__main__":
    main()
