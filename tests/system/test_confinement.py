"""A confined process opens what it was granted, and nothing else."""

from __future__ import annotations

import itertools
import os
import platform
import re
import subprocess
import sys
from pathlib import Path

import pytest

from app.api.workers.rights import environment_of_workers
from app.system.confinement import confine, landlock_version
from tests.conftest import ROOT

linux = pytest.mark.skipif(sys.platform != "linux", reason="only Linux can confine a process")
landlock = pytest.mark.skipif(
    landlock_version() < 1, reason="this kernel has no Landlock, or it is switched off"
)

ATTEMPT = """
import ctypes, os, platform, socket, subprocess, sys, threading
from pathlib import Path
from app.system import confinement
from app.system.confinement import READ, UNPACK, WRITE, confine
place = Path(sys.argv[1])
library = ctypes.CDLL(None)
def copied(descriptor, program):
    os.write(descriptor, Path(program).read_bytes())
    execveat, of_descriptor = {{"x86_64": 322, "aarch64": 281}}[platform.machine()], 0x1000
    nothing = (ctypes.c_char_p * 2)(b"true", None)
    return library.syscall(execveat, descriptor, b"", nothing, None, of_descriptor)
if "without Landlock" in sys.argv[2:]:
    confinement.landlock_version = lambda: 0
if "without Linux" in sys.argv[2:]:
    sys.platform = "darwin"
confine([(place / "clip", READ), (place / "results", WRITE), (place / "scratch", UNPACK)])
done = {attempt}
print("DONE", done)
"""


@pytest.fixture
def place(tmp_path: Path) -> Path:
    (tmp_path / "clip").write_text("the clip")
    (tmp_path / "secret").write_text("a token")
    for name in ("results", "scratch"):
        (tmp_path / name).mkdir()
    return tmp_path


def attempt(place: Path, expression: str, *system: str) -> str:
    """Evaluate an expression in a confined process; return its value, or the error's name."""
    command = [sys.executable, "-c", ATTEMPT.format(attempt=expression), str(place), *system]
    variables = environment_of_workers({**os.environ, "OSG_TOKEN": "a token"})
    ran = subprocess.run(command, capture_output=True, text=True, check=False, env=variables)
    last = (ran.stdout if ran.returncode == 0 else ran.stderr).strip().splitlines()[-1]
    return last.removeprefix("DONE ") if ran.returncode == 0 else last.partition(":")[0]


@landlock
@pytest.mark.parametrize(
    "expression",
    [
        '(place / "secret").read_text()',
        '(place / "secret").unlink()',
        '(place / "secret").rename(place / "results" / "secret")',
        "os.listdir(place)",
        "os.listdir(Path.home())",
        'Path("/etc/passwd").read_text()',
        'Path(f"/proc/{os.getppid()}/environ").read_bytes()',
        '(place / "clip").write_text("other")',
        '(place / "results" / "link").symlink_to(place / "secret")',
        '(place / "scratch" / "link").symlink_to(place / "secret")'
        ' or (place / "scratch" / "link").read_text()',
        'os.rename(place / "scratch", place / "results" / "scratch")',
        'subprocess.run(["/bin/true"])',
    ],
)
def test_what_was_not_granted_is_denied(place: Path, expression: str) -> None:
    assert attempt(place, expression) == "PermissionError"
    assert (place / "secret").read_text() == "a token"


@landlock
@pytest.mark.parametrize(
    ("expression", "value"),
    [
        ('(place / "clip").read_text()', "the clip"),
        ('(place / "results" / "new").write_text("12")', "2"),
        ('(place / "scratch" / "deep").mkdir()', "None"),
        ('(place / "scratch" / "a").symlink_to(place / "clip")', "None"),
        ('Path("/dev/urandom").open("rb").read(1) is not None', "True"),
        ('__import__("sqlite3").connect(":memory:") is not None', "True"),
        ("threading.Thread(target=int).start()", "None"),
    ],
)
def test_what_was_granted_is_allowed(place: Path, expression: str, value: str) -> None:
    assert attempt(place, expression) == value


@linux
@pytest.mark.parametrize("kind", ["AF_INET", "AF_UNIX", "AF_INET, socket.SOCK_DGRAM"])
def test_no_socket_is_made(place: Path, kind: str) -> None:
    assert attempt(place, f"socket.socket(socket.{kind})") == "PermissionError"


filtered = pytest.mark.skipif(
    sys.platform != "linux" or platform.machine() not in ("x86_64", "aarch64"),
    reason="the filter of system calls is for Linux on two machines",
)


@filtered
@pytest.mark.parametrize(
    "expression",
    [
        '(place / "secret").chmod(0o666)',
        '(place / "clip").chmod(0o666)',
        'os.fchmod(os.open(place / "clip", os.O_RDONLY), 0o666)',
        'os.chown(place / "secret", os.getuid(), os.getgid())',
        'os.utime(place / "secret", (0, 0))',
        'os.setxattr(place / "secret", b"user.note", b"1")',
    ],
)
def test_rights_owner_and_times_of_files_are_not_changed(place: Path, expression: str) -> None:
    before = (place / "secret").stat()
    assert attempt(place, expression) == "PermissionError"
    assert (place / "secret").stat() == before


@filtered
@pytest.mark.parametrize(
    "expression",
    ["os.fork()", 'subprocess.run([sys.executable, "-c", ""])', "os.posix_spawn('/x', ['x'], {})"],
)
def test_no_process_is_started_that_would_outlive_the_job(place: Path, expression: str) -> None:
    assert attempt(place, expression) == "PermissionError"


@filtered
@pytest.mark.parametrize(
    "expression",
    [
        "os.execv('/bin/true', ['true'])",
        # A program that lies in memory has no path that Landlock could deny.
        "copied(os.memfd_create('program'), '/bin/true')",
    ],
)
def test_no_program_takes_the_place_of_a_process(place: Path, expression: str) -> None:
    assert attempt(place, expression) in ("PermissionError", "-1")


@filtered
def test_limits_of_other_processes_are_not_changed(place: Path) -> None:
    limits = '__import__("resource").prlimit({who}, 7, (64, 64))'
    assert attempt(place, limits.format(who="os.getppid()")) == "PermissionError"
    assert attempt(place, f"{limits.format(who=0)} is not None") == "True"


@filtered
@pytest.mark.parametrize(
    "expression",
    [
        "os.setpriority(os.PRIO_PROCESS, os.getppid(), 19)",
        "os.sched_setaffinity(os.getppid(), {0})",
        "os.sched_setscheduler(os.getppid(), os.SCHED_IDLE, os.sched_param(0))",
    ],
)
def test_no_other_process_gets_less_of_the_processor(place: Path, expression: str) -> None:
    assert attempt(place, expression) == "PermissionError"


@filtered
@pytest.mark.parametrize(
    "call", ["inotify_init1(0)", "syscall({add_key}, b'user', b'k', b'v', 1, -1)"]
)
def test_neither_names_of_files_are_watched_nor_keys_kept(place: Path, call: str) -> None:
    add_key = {"x86_64": 248, "aarch64": 217}[platform.machine()]
    expression = f'__import__("ctypes").CDLL(None).{call.format(add_key=add_key)}'
    assert attempt(place, expression) == "-1"


@filtered
def test_no_memory_is_kept_that_would_outlive_the_job(place: Path) -> None:
    kept = '__import__("ctypes").CDLL(None).shmget(0, 4096, 0o600)'
    assert attempt(place, kept) == "-1"


@linux
def test_a_pair_of_sockets_between_threads_is_allowed(place: Path) -> None:
    assert attempt(place, "len(socket.socketpair())") == "2"


@pytest.mark.skipif(landlock_version() < 6, reason="needs signals in Landlock, from Linux 6.12")
def test_no_other_process_is_signalled(place: Path) -> None:
    assert attempt(place, "os.kill(os.getppid(), 0)") == "PermissionError"


PAGE = ROOT / "docs" / "guides" / "administration.md"

ATTEMPTS = {
    "token, database address, keys in the environment": 'os.environ["OSG_TOKEN"]',
    "memory and environment of the server": 'Path(f"/proc/{os.getppid()}/environ").read_bytes()',
    "other files: database, `tokens.json`, others' clips": '(place / "secret").read_text()',
    "writing outside the clip's folder": '(place / "beside").write_text("x")',
    "network, other programs' sockets": "socket.socket()",
    "starting programs": 'subprocess.run(["/bin/true"]) and os.execv("/bin/echo", ["e", "DONE"])',
    "processes or memory that outlive the job": "library.shmctl(library.shmget(0, 64, 384), 0, 0)",
    "rights, owner and times of files, limits of other processes": '(place / "clip").chmod(384)',
    "signals to other processes": "os.kill(os.getppid(), 0)",
}
"""What a process tries for each row of the table of what it can reach."""

SYSTEMS = ("", "without Landlock", "without Linux")


def table_of_reach() -> dict[str, list[str]]:
    """Return the cells of each row of the table, for each of `SYSTEMS`."""
    _, table = PAGE.read_text(encoding="utf-8").split("What it can reach then:\n\n")
    rows = [re.findall(r"[^|]+", line) for line in table.partition("\n\n")[0].splitlines()[2:]]
    return {row[0].strip(): [cell.strip() for cell in row[1:]] for row in rows}


def test_every_row_of_the_table_is_tried() -> None:
    assert list(table_of_reach()) == list(ATTEMPTS)


@landlock
@filtered
@pytest.mark.parametrize(
    ("row", "system"), itertools.product(ATTEMPTS, SYSTEMS), ids=lambda each: each or "Linux"
)
def test_a_process_reaches_what_the_table_says(place: Path, row: str, system: str) -> None:
    says = table_of_reach()[row][SYSTEMS.index(system)]
    tried = attempt(place, ATTEMPTS[row], system)
    reached = tried not in ("PermissionError", "KeyError", "-1")
    match says:
        case "yes" | "no":
            assert reached is (says == "yes"), tried
        case "no, from Linux 6.12":
            assert reached is (landlock_version() < 6), tried
        case "no, unless it runs as root":
            # This process does not hide; the kernel shows it to its own user.
            assert reached, tried
        case _:
            assert says == "as the system allows"


@landlock
def test_later_threads_are_confined_too(place: Path) -> None:
    thread = '__import__("concurrent.futures").futures.ThreadPoolExecutor(1)'
    expression = f'{thread}.submit((place / "secret").read_text).result()'
    assert attempt(place, expression) == "PermissionError"


def test_without_linux_nothing_changes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "platform", "darwin")
    assert not confine([])
    assert list(Path("/").iterdir())


@linux
def test_the_memory_of_a_process_is_hidden_from_others_of_its_user() -> None:
    shown = (
        "import ctypes; from app.system.confinement import hide_memory; "
        "dumpable = lambda: ctypes.CDLL(None).prctl(3, 0, 0, 0, 0); "
        "before = dumpable(); hide_memory(); print(before, dumpable())"
    )
    ran = subprocess.run([sys.executable, "-c", shown], capture_output=True, text=True, check=True)
    assert ran.stdout == "1 0\n"
