"""Checkout: the committed files of this repository, and when they were committed."""

from __future__ import annotations

import io
import subprocess
import tarfile
from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).resolve().parents[1]


class ReleaseError(Exception):
    """Raised when a release cannot be built; one line that says what to do."""


def run_git(*arguments: str) -> bytes:
    """Run git in the repository and return its output.

    Raises
    ------
    ReleaseError
        When git is missing or fails.

    """
    try:
        # safe.directory: in CI the checkout may belong to another user.
        command = ["git", "-c", "safe.directory=*", *arguments]
        return subprocess.run(command, cwd=ROOT, check=True, capture_output=True).stdout
    except (OSError, subprocess.CalledProcessError) as error:
        raise ReleaseError(f"a release needs a git checkout: {error}") from error


def commit_seconds() -> int:
    """Return the time of the last commit, in seconds since 1970."""
    return int(run_git("log", "-1", "--format=%ct"))


def export_commit(folder: Path) -> None:
    """Write only the files of the last commit to a folder."""
    archive = run_git("archive", "--format=tar", "HEAD")
    with tarfile.open(fileobj=io.BytesIO(archive)) as files:
        files.extractall(folder, filter="tar")
