"""How the suite fits a machine, and what it says about tests that it left out."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.conftest import GIB, LONG_TESTS, ROOT, WITHOUT_BROWSER, choose_file, workers


@pytest.mark.parametrize(
    ("cores", "gib", "expected"), [(2, 24, 4), (16, 64, 32), (16, 8, 4), (1, 1, 1)]
)
def test_workers_are_as_many_as_cores_and_memory_allow(cores: int, gib: int, expected: int) -> None:
    assert workers(cores, gib * GIB) == expected


def test_a_worker_takes_files_of_its_own_group_first() -> None:
    files = ["tests/browser/test_page.py", "tests/store/test_clips.py", "tests/cli/test_check.py"]
    assert choose_file(files, browses=True) == files[0]
    assert choose_file(files, browses=False) == files[1]
    assert choose_file(files[1:], browses=True) == files[1]
    assert choose_file(files[:1], browses=False) == files[0]


def test_long_tests_are_listed_by_the_names_they_have() -> None:
    gone = [
        name
        for name in LONG_TESTS
        if f"def {name.rpartition('::')[2]}("
        not in (ROOT / name.partition("::")[0]).read_text("utf-8")
    ]
    assert gone == []


def environment_with(name: str, folder: Path) -> dict[str, str]:
    """Return the environment of a run of its own, which has none of this run's options."""
    of_this_run = ("PYTEST_ADDOPTS", "PYTEST_XDIST_WORKER")
    inherited = {key: value for key, value in os.environ.items() if key not in of_this_run}
    return inherited | {name: str(folder)}


@pytest.mark.slow
@pytest.mark.models
def test_a_run_without_chromium_ends_with_the_command_that_brings_it(tmp_path: Path) -> None:
    file = "tests/browser/page/test_toasts.py"
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", file]
    run = subprocess.run(
        command,
        cwd=ROOT,
        env=environment_with("PATH", tmp_path),
        capture_output=True,
        text=True,
        check=True,
    )
    *_, listed, summary, last = run.stdout.splitlines()
    count = summary.split()[0]
    assert listed == f"left out {count}: {WITHOUT_BROWSER}"
    assert summary.split()[1] == "skipped"
    assert (
        last == f"{count} browser tests were left out; this brings them: apt-get install chromium"
    )


@pytest.mark.slow
def test_a_run_that_a_worker_breaks_ends_with_what_broke_there(tmp_path: Path) -> None:
    broken = "def pytest_runtest_logfinish(): raise RuntimeError('broken within')\n"
    (tmp_path / "broken.py").write_text(broken)
    command = [sys.executable, "-m", "pytest", "-q", "-n", "1", "-p", "broken", "-k", "own_group"]
    run = subprocess.run(
        [*command, "-p", "no:cacheprovider", __file__],
        cwd=ROOT,
        env=environment_with("PYTHONPATH", tmp_path),
        capture_output=True,
        text=True,
        check=False,
    )
    _, ended, told = run.stdout.rpartition("the first internal error ends with:")
    assert ended
    assert "RuntimeError: broken within" in told
