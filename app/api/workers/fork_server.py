"""Fork server: ``python -m app.api.workers.fork_server``, a process that forks worker processes.

It has imported the modules of the workers, which would take each worker half a second on a laptop,
so that a forked process begins its command in some milliseconds. Its stdin is a socket by which
`app.api.workers.forked_worker` requests a process.
"""

from __future__ import annotations

import gc
import json
import os
import signal
import socket
import sys

from app.api.workers import worker
from app.api.workers.rights import confine_worker


def serve(requests: socket.socket) -> socket.socket:
    """Fork a process for each connection received from `requests`; return in the forked process.

    Raises
    ------
    SystemExit
        When the server has closed the socket.

    """
    while True:
        _, descriptors, _, _ = socket.recv_fds(requests, 1, 1)
        if not descriptors:
            sys.exit()
        connection = socket.socket(fileno=descriptors[0])
        try:
            if os.fork() == 0:
                return connection
        except OSError as error:
            # No process or memory is left; the connection ends without an answer.
            print(f"osg-studio: a job cannot be started: {error.strerror}", file=sys.stderr)
        connection.close()


def become_worker(connection: socket.socket) -> list[str]:
    """Take a forked process's command from its connection, which becomes its stdin and stdout.

    It sends its process id first, and ends if no command follows.

    Returns
    -------
    list of str
        The arguments of `worker.main`.

    """
    os.setsid()
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    try:
        connection.sendall(b"%d\n" % os.getpid())
        with connection.makefile("rb") as lines:
            line = lines.readline()
    except ConnectionError:  # The job was cancelled meanwhile.
        line = b""
    if not line:
        sys.exit()
    command = json.loads(line)
    os.environ.clear()
    os.environ.update(command["environment"])
    for standard in (sys.stdin.fileno(), sys.stdout.fileno()):
        os.dup2(connection.fileno(), standard)
    connection.close()
    arguments: list[str] = command["arguments"]
    return arguments


def main() -> None:
    """Fork workers until the server is gone."""
    worker.show_command("fork server")
    # The system removes ended processes, because nobody waits for them here.
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)
    # The imported modules stay in memory that all workers share.
    gc.freeze()
    with socket.socket(fileno=os.dup(sys.stdin.fileno())) as requests:
        connection = serve(requests)
    arguments = become_worker(connection)
    confine_worker(arguments)
    worker.main(arguments)


if __name__ == "__main__":
    main()
