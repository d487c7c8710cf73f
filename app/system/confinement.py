"""Confinement: takes from this process, where Linux can, the right to files, programs and networks.

Files are limited by Landlock (Linux 5.13; TCP since 6.7, signals since 6.12), sockets and what
Landlock does not know by a filter of system calls (seccomp). Both last until the process has ended.
"""

from __future__ import annotations

import ctypes
import os
import platform
import struct
import sys
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import Final

# landlock(7): rights to files, to folders, and what is done where.
_EXECUTE, _WRITE_FILE, _READ_FILE, _READ_DIR = 1 << 0, 1 << 1, 1 << 2, 1 << 3
_REMOVE_DIR, _REMOVE_FILE, _MAKE_DIR, _MAKE_REG, _MAKE_SYM = 1 << 4, 1 << 5, 1 << 7, 1 << 8, 1 << 12
_TRUNCATE, _IOCTL = 1 << 14, 1 << 15
_OF_FILES: Final = _EXECUTE | _WRITE_FILE | _READ_FILE | _TRUNCATE | _IOCTL

READ: Final = _READ_FILE | _READ_DIR
"""Right to read a file, or all in a folder."""

WRITE: Final = READ | _WRITE_FILE | _TRUNCATE | _MAKE_REG | _REMOVE_FILE
"""Right to write files too. Links are not made: somebody else would follow them."""

UNPACK: Final = WRITE | _MAKE_DIR | _REMOVE_DIR | _MAKE_SYM
"""Right to do in a folder of one's own what unpacking needs."""

DEVICES: Final = READ | _WRITE_FILE | _IOCTL
"""Right to use devices."""

_HANDLED: Final = {1: (1 << 13) - 1, 2: (1 << 14) - 1, 3: (1 << 15) - 1, 5: (1 << 16) - 1}
"""All rights to files that a version of Landlock knows, by the version that brought them."""

_TCP: Final = 0b11
_ABSTRACT_SOCKETS_AND_SIGNALS: Final = 0b11
_CREATE, _ADD, _RESTRICT = 444, 445, 446
_NO_NEW_PRIVILEGES, _DUMPABLE, _SECCOMP, _SECCOMP_FILTER = 38, 4, 22, 2

_SYSTEM: Final = (
    "/usr",
    "/lib",
    "/lib64",
    "/etc/ld.so.cache",
    "/etc/localtime",
    "/etc/timezone",
    "/etc/fonts",
    "/etc/OpenCL",
    "/proc/self",
    "/proc/cpuinfo",
    "/proc/meminfo",
    "/proc/stat",
    "/proc/driver",
    "/sys/bus",
    "/sys/devices",
    "/sys/fs/cgroup",
    "/dev/urandom",
    "/dev/random",
    "/dev/zero",
)
"""What libraries read of a system; nothing here is secret."""

_FILTERED: Final = {"x86_64": 0xC000_003E, "aarch64": 0xC000_00B7}
"""By machine: audit number of its architecture."""

# fmt: off
_DENIED: Final = {
    "x86_64": (
        41,  # socket
        57, 58, 59, 322,  # fork, vfork, execve, execveat
        90, 91, 268,  # chmod, fchmod, fchmodat
        92, 93, 94, 260,  # chown, fchown, lchown, fchownat
        132, 235, 261, 280,  # utime, utimes, futimesat, utimensat
        188, 189, 190, 197, 198, 199,  # setxattr, removexattr, and those of links and files
        29, 64, 68, 240,  # shmget, semget, msgget, mq_open
        141, 142, 144, 203,  # setpriority, sched_setparam, sched_setscheduler, sched_setaffinity
        251, 314,  # ioprio_set, sched_setattr
        253, 294, 300,  # inotify_init, inotify_init1, fanotify_init
        248, 249, 250,  # add_key, request_key, keyctl
    ),
    "aarch64": (
        198,  # socket
        221, 281,  # execve, execveat
        52, 53,  # fchmod, fchmodat
        54, 55,  # fchownat, fchown
        88,  # utimensat
        5, 6, 7, 14, 15, 16,  # setxattr, removexattr, and those of links and files
        180, 186, 190, 194,  # mq_open, msgget, semget, shmget
        140, 118, 119, 122,  # setpriority, sched_setparam, sched_setscheduler, sched_setaffinity
        30, 274,  # ioprio_set, sched_setattr
        26, 262,  # inotify_init1, fanotify_init
        217, 218, 219,  # add_key, request_key, keyctl
    ),
}
"""System calls by machine: sockets, processes, and what Landlock leaves to every process of a user:
owner, rights, times and attributes of all files, the processor's and the disk's time of all
processes, names of files that change, keys, and memory that outlives the process."""
# fmt: on

_DENIED_ANYWHERE: Final = (
    425,  # io_uring_setup
    452,  # fchmodat2
    463,  # setxattrat
    466,  # removexattrat
    469,  # file_setattr
)
"""System calls with the same number on both machines."""

_CLONE: Final = {"x86_64": 56, "aarch64": 220}
_SET_LIMITS: Final = {"x86_64": 302, "aarch64": 261}
"""Numbers of the system calls ``clone`` and ``prlimit64`` by machine."""

_CLONE_3: Final = 435
_THREAD: Final = 0x1_0000
_X32: Final = 0x4000_0000


def confine(grants: Iterable[tuple[Path, int]]) -> bool:
    """Confine this thread and its later children to the system's libraries and what is granted.

    Call it while the process has one thread. It may start no process, make no socket, connect to
    nothing, change neither rights of files nor limits and priority of processes and, with a new
    kernel, signal no process outside.

    Parameters
    ----------
    grants
        Files and folders with the right to each; those that do not exist are left out.

    Returns
    -------
    Whether the files are confined; on Linux sockets and processes are forbidden in any case.

    """
    if sys.platform != "linux":
        return False
    system = ctypes.CDLL(None, use_errno=True)
    _require(system.prctl(_NO_NEW_PRIVILEGES, 1, 0, 0, 0))
    _forbid_calls(system)
    version = landlock_version()
    if version < 1:
        return False
    handled = max(rights for since, rights in _HANDLED.items() if since <= version)
    attributes = struct.pack(
        "=QQQ",
        handled,
        _TCP if version >= 4 else 0,
        _ABSTRACT_SOCKETS_AND_SIGNALS if version >= 6 else 0,
    )
    rules = _call(system, _CREATE, attributes, len(attributes), 0)
    try:
        for path, rights in [*_needed(), *grants]:
            _grant(system, rules, path, rights & handled)
        _call(system, _RESTRICT, rules, 0)
    finally:
        os.close(rules)
    return True


def landlock_version() -> int:
    """Return the version of Landlock that this system has; 0 if it has none."""
    if sys.platform != "linux":
        return 0
    version: int = ctypes.CDLL(None).syscall(_CREATE, None, 0, 1)
    return max(version, 0)


def hide_memory() -> None:
    """Keep other processes of this user from reading this one's memory and environment.

    Only Linux can; the system also writes no core dumps of it.
    """
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_DUMPABLE, 0, 0, 0, 0)


def _needed() -> list[tuple[Path, int]]:
    """Return what every process of this program needs."""
    package = Path(__file__).resolve().parents[1]
    beside = [package, *(package.parent / name for name in ("static", "languages"))]
    # A checkout is not read as a whole: data may lie in it.
    whole = {package.parent} if (package.parent / "pyproject.toml").exists() else set()
    modules = {Path(path).resolve() for path in sys.path if path} - whole
    libraries = filter(None, os.environ.get("LD_LIBRARY_PATH", "").split(":"))
    read: list[str | Path] = [*beside, sys.prefix, sys.base_prefix, *modules, *libraries, *_SYSTEM]
    graphics = [*Path("/dev").glob("nvidia*"), Path("/dev/dri"), Path("/dev/kfd")]
    return [
        *((Path(path), READ) for path in read),
        *((path, DEVICES) for path in graphics),
        (Path("/dev/null"), DEVICES),
    ]


def _grant(system: ctypes.CDLL, rules: int, path: Path, rights: int) -> None:
    # O_PATH opens nothing: it names a place, which may be replaced later without effect.
    with suppress(FileNotFoundError, NotADirectoryError, PermissionError):
        place = os.open(path, os.O_PATH | os.O_CLOEXEC)
        try:
            chosen = rights if path.is_dir() else rights & _OF_FILES
            _call(system, _ADD, rules, 1, struct.pack("=Qi", chosen, place), 0)
        finally:
            os.close(place)


def _forbid_calls(system: ctypes.CDLL) -> None:
    """Let system calls fail that Landlock does not limit, such as sockets of UDP and of files.

    Without effect on other machines than these two, and where the system refuses filters.
    """
    machine = platform.machine()
    if (architecture := _FILTERED.get(machine)) is None:
        return
    load, equal, at_least, any_bit, answer = 0x20, 0x15, 0x35, 0x45, 0x06
    number_at, architecture_at, first_argument_at = 0, 4, 16
    allow, not_permitted, not_known = 0x7FFF_0000, 0x0005_0001, 0x0005_0026  # EPERM, ENOSYS
    deny = (answer, 0, 0, not_permitted)
    steps = [
        (load, 0, 0, architecture_at),
        (equal, 1, 0, architecture),
        deny,
        (load, 0, 0, number_at),
        (at_least, 0, 1, _X32),
        deny,
    ]
    for number in (*_DENIED[machine], *_DENIED_ANYWHERE):
        steps += [(equal, 0, 1, number), deny]
    steps += [
        # Its arguments cannot be read here; C libraries then use clone.
        (equal, 0, 1, _CLONE_3),
        (answer, 0, 0, not_known),
        # New threads are allowed, and new processes are not: these would outlive the job.
        (equal, 0, 4, _CLONE[machine]),
        (load, 0, 0, first_argument_at),
        (any_bit, 1, 0, _THREAD),
        deny,
        (answer, 0, 0, allow),
        # The own limits are allowed, and those of other processes are not.
        (equal, 0, 3, _SET_LIMITS[machine]),
        (load, 0, 0, first_argument_at),
        (equal, 1, 0, 0),
        deny,
        (answer, 0, 0, allow),
    ]
    code = ctypes.create_string_buffer(b"".join(struct.pack("=HBBI", *step) for step in steps))
    program = ctypes.create_string_buffer(struct.pack("@HP", len(steps), ctypes.addressof(code)))
    system.prctl(_SECCOMP, _SECCOMP_FILTER, program, 0, 0)


def _call(system: ctypes.CDLL, number: int, *arguments: bytes | int) -> int:
    result: int = system.syscall(number, *arguments)
    return _require(result)


def _require(result: int) -> int:
    if result < 0:
        number = ctypes.get_errno()
        raise OSError(number, os.strerror(number))
    return result
