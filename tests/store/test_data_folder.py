"""One server per data folder."""

import subprocess
import sys
from pathlib import Path

import pytest

from app.store import FolderLock, StoreUnavailable

HOLD = """
import sys
from pathlib import Path
from app.store import FolderLock
with FolderLock(Path(sys.argv[1])):
    print("held", flush=True)
    sys.stdin.read()
"""


@pytest.mark.slow
def test_a_second_process_is_refused_until_the_first_one_ends(tmp_path: Path) -> None:
    command = [sys.executable, "-c", HOLD, str(tmp_path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as holder:
        assert holder.stdout is not None
        assert holder.stdout.readline() == b"held\n"
        with pytest.raises(StoreUnavailable, match="in use by another"), FolderLock(tmp_path):
            pass
        holder.kill()
    with FolderLock(tmp_path):
        pass


def test_the_folder_is_free_again_when_the_lock_is_let_go(tmp_path: Path) -> None:
    for _ in range(2):
        with FolderLock(tmp_path / "made" / "on demand"):
            pass


@pytest.mark.withstands(row="H22")
def test_a_folder_that_cannot_be_made_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    with (
        pytest.raises(StoreUnavailable, match="cannot be written to"),
        FolderLock(tmp_path / "file"),
    ):
        pass
