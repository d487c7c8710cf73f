"""Finding the worker processes of a server, to disturb them."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import pytest

from tests.api.running import until

linux = pytest.mark.skipif(not Path("/proc/self").exists(), reason="finds processes in /proc")


def workers_of(parent: int, command: str = "record") -> list[int]:
    """Return the process ids of the workers of `parent` that run `command`.

    They are its children, or those of its fork server.
    """
    parents = processes(f"osg {command}")
    starting = {parent, *fork_servers_of(parent)}
    return [worker for worker in parents if parents[worker] in starting]


def hold_worker(parent: int, command: str = "record") -> int:
    """Suspend the one worker of `parent` that runs `command` once it has started; return its id."""
    until(lambda: workers_of(parent, command))
    (worker,) = workers_of(parent, command)
    os.kill(worker, signal.SIGSTOP)
    return worker


def fork_servers_of(parent: int) -> list[int]:
    """Return the process ids of the fork servers of `parent`."""
    servers = processes("osg fork server")
    return [server for server in servers if servers[server] == parent]


def processes(name: str) -> dict[int, int]:
    """Return the ids of running processes with this name, each with its parent's id."""
    found = {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            its_name, _, facts = stat.read_text().partition("(")[2].rpartition(") ")
        except OSError:
            continue
        state, parent = facts.split()[:2]
        if its_name == name and state != "Z":
            found[int(stat.parent.name)] = int(parent)
    return found


def alive(process_id: int) -> bool:
    """Return whether a process runs."""
    try:
        os.kill(process_id, 0)
        stat = Path(f"/proc/{process_id}/stat").read_text()
    except OSError:
        return False
    return not stat.rpartition(") ")[2].startswith("Z")
