"""A real server in a process of its own, which may be killed."""

from __future__ import annotations

import random
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TextIO

import httpx

from tests.api.running import client_of

SERVE = """
import sys
from pathlib import Path
from app.server import run
from app.settings import Settings
data = Path(sys.argv[1])
port = int(sys.argv[2]) if len(sys.argv) > 2 else 0
run(Settings(data_dir=data, samples_dir=data / "none", port=port), open_browser=False)
"""
"""Serves a folder, on a free port unless one is given."""


UNASSIGNED = range(20_000, 30_000)
"""Ports that no system assigns by itself: Linux assigns from 32768 on, others from 49152 on."""


def lasting_port() -> int:
    """Return a free port that stays free while a server is killed and restarted."""
    while True:
        port = random.choice(UNASSIGNED)
        with socket.socket() as tried, suppress(OSError):
            tried.bind(("127.0.0.1", port))
            return port


@contextmanager
def served(
    data_dir: Path, errors: TextIO | None = None, *, port: int = 0
) -> Iterator[tuple[subprocess.Popen[str], httpx.Client]]:
    """Serve `data_dir` until the context ends; `errors` gets the process's standard error."""
    command = [sys.executable, "-c", SERVE, str(data_dir), str(port)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=errors, text=True)
    try:
        assert process.stdout is not None
        line = process.stdout.readline()
        address = next(word for word in line.split() if word.startswith("http://"))
        with client_of(address) as client:
            yield process, client
    finally:
        process.kill()
        process.wait()
