"""Confinement: takes from this process, where Linux can, the right to files, programs and networks.

Files are limited by Landlock (Linux 5.13; TCP since 6.7, signals since 6.12), sockets by a filter
of system calls (seccomp). Both last until the process and all its children have ended.
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

_FILTERED: Final = {"x86_64": (0xC000_003E, 41), "aarch64": (0xC000_00B7, 198)}
"""By machine: audit number of its architecture, and number of the system call ``socket``."""

_IO_URING_SETUP: Final = 425
_X32: Final = 0x4000_0000


def confine(grants: Iterable[tuple[Path, int]]) -> bool:
    """Confine this thread and its later children to the system's libraries and what is granted.

    Call it while the process has one thread. It may start no program, make no socket, connect to
    nothing and, with a new kernel, signal no process outside.

    Parameters
    ----------
    grants
        Files and folders with the right to each; those that do not exist are left out.

    Returns
    -------
    Whether the files are confined; on Linux sockets are forbidden in any case.

    """
    if sys.platform != "linux":
        return False
    system = ctypes.CDLL(None, use_errno=True)
    _require(system.prctl(_NO_NEW_PRIVILEGES, 1, 0, 0, 0))
    _forbid_sockets(system)
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


def _forbid_sockets(system: ctypes.CDLL) -> None:
    """Let new sockets fail, also those of UDP and of files, which Landlock does not know.

    Without effect on other machines than these two, and where the system refuses filters.
    """
    if (known := _FILTERED.get(platform.machine())) is None:
        return
    architecture, socket_call = known
    load, equal, at_least, answer = 0x20, 0x15, 0x35, 0x06
    allow, deny = 0x7FFF_0000, 0x0005_0001  # the second fails with EPERM
    steps = [
        (load, 0, 0, 4),
        (equal, 0, 4, architecture),
        (load, 0, 0, 0),
        (at_least, 2, 0, _X32),
        (equal, 1, 0, socket_call),
        (equal, 0, 1, _IO_URING_SETUP),
        (answer, 0, 0, deny),
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
