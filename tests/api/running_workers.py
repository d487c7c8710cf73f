"""Finding the worker processes of a server, to disturb them."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

linux = pytest.mark.skipif(not Path("/proc/self").exists(), reason="finds processes in /proc")


def workers_of(parent: int, command: str = "record") -> list[int]:
    """Return the process ids of the workers of server `parent` that do `command`."""
    found = []
    for entry in Path("/proc").iterdir():
        if not entry.name.isdigit():
            continue
        try:
            words = (entry / "cmdline").read_bytes().split(b"\0")
            status = (entry / "stat").read_text().rpartition(")")[2].split()
        except OSError:
            continue
        is_worker = b"app.api.workers.worker" in words and command.encode() in words
        if is_worker and int(status[1]) == parent and status[0] != "Z":
            found.append(int(entry.name))
    return found


def alive(process_id: int) -> bool:
    """Tell whether a process runs."""
    try:
        os.kill(process_id, 0)
        return (Path("/proc") / str(process_id) / "stat").read_text().split()[2] != "Z"
    except OSError:
        return False
