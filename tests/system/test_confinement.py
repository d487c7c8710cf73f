"""A confined process opens what it was granted, and nothing else."""

from __future__ import annotations

import platform
import subprocess
import sys
from pathlib import Path

import pytest

from app.system.confinement import confine, landlock_version

linux = pytest.mark.skipif(sys.platform != "linux", reason="only Linux can confine a process")
landlock = pytest.mark.skipif(
    landlock_version() < 1, reason="this kernel has no Landlock, or it is switched off"
)

ATTEMPT = """
import os, socket, subprocess, sys, threading
from pathlib import Path
from app.system.confinement import READ, UNPACK, WRITE, confine
place = Path(sys.argv[1])
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


def attempt(place: Path, expression: str) -> str:
    """Evaluate an expression in a confined process; return its value, or the error's name."""
    command = [sys.executable, "-c", ATTEMPT.format(attempt=expression), str(place)]
    ran = subprocess.run(command, capture_output=True, text=True, check=False)
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
