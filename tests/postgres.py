"""A real PostgreSQL in a folder of the tests' own; skipped where it is not installed."""

from __future__ import annotations

import os
import pwd
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from uuid import uuid4

import pytest

UNPRIVILEGED = "nobody"
"""PostgreSQL refuses to run as root; this user owns nothing."""


def programs() -> Path | None:
    """Return the folder of PostgreSQL's programs, the newest version's; None where there is none.

    Debian keeps them out of the path, one folder a version.
    """
    found = [path.parent for path in Path("/usr/lib/postgresql").glob("*/bin/initdb")]
    if named := shutil.which("initdb"):
        found.append(Path(named).resolve().parent)
    return max(found, key=lambda path: float(path.parent.name), default=None)


class Cluster:
    """A PostgreSQL server on a socket in a folder.

    Parameters
    ----------
    folder
        Folder of its data and socket; its path is short, because a socket's path must be.

    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._data = folder / "data"

    def create(self) -> None:
        """Make the data folder."""
        if os.geteuid() == 0:
            account = pwd.getpwnam(UNPRIVILEGED)
            os.chown(self.folder, account.pw_uid, account.pw_gid)
        self._run("initdb", "-D", self._data, "-U", "osg", "-A", "trust", "-E", "UTF8", "--no-sync")

    def start(self) -> None:
        """Start the server, reachable only by its socket."""
        options = f"-c listen_addresses='' -c unix_socket_directories={self.folder} -c fsync=off"
        log = self.folder / "log"
        self._run("pg_ctl", "-D", self._data, "-l", log, "-w", "-o", options, "start")

    def stop(self, mode: str = "immediate") -> None:
        """End the server, by default as in a crash."""
        self._run("pg_ctl", "-D", self._data, "-m", mode, "-w", "stop")

    def new_database(self) -> str:
        """Make an empty database, and return its URL."""
        name = f"osg{uuid4().hex}"
        self._run("createdb", "-h", self.folder, "-U", "osg", name)
        return f"postgresql+psycopg://osg@/{name}?host={self.folder}"

    def _run(self, program: str, *arguments: str | Path) -> None:
        folder = programs()
        assert folder is not None
        command = [str(folder / program), *map(str, arguments)]
        user = UNPRIVILEGED if os.geteuid() == 0 else None
        # Not captured: the server would hold the pipe open.
        with tempfile.TemporaryFile() as output:
            ended = subprocess.run(
                command, user=user, cwd="/", stdout=output, stderr=subprocess.STDOUT, check=False
            )
            output.seek(0)
            assert ended.returncode == 0, output.read().decode()


@contextmanager
def postgres_cluster() -> Iterator[Cluster]:
    """Run a cluster until the context ends."""
    pytest.importorskip("psycopg")
    if programs() is None:
        pytest.skip("needs PostgreSQL: apt-get install postgresql")
    with tempfile.TemporaryDirectory(prefix="osg-pg-", ignore_cleanup_errors=True) as folder:
        cluster = Cluster(Path(folder))
        cluster.create()
        cluster.start()
        try:
            yield cluster
        finally:
            cluster.stop()
