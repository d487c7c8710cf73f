"""Rights of a worker process: its environment, and the files that it may read and write.

A worker reads files of strangers, which may take it over. It gets no token, database address or key
of the server; where the system can, it may open nothing but its clip, the models and the
installation (`app.system.confinement`).
"""

from __future__ import annotations

import os
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Final

from app.api.workers.executor import TaskFiles
from app.system.confinement import READ, UNPACK, WRITE, confine

READS, WRITES, SCRATCH = "--reads=", "--writes=", "--scratch="
"""Arguments of a worker process that name what it may read, write, and unpack into."""

MOST_NAMED: Final = 500
"""Most files named one by one, because a command line is limited; of more, their common folder."""

# fmt: off
_PASSED: Final = frozenset(
    {
        # Where programs, libraries, models and temporary files are; language and time zone.
        "PATH", "HOME", "USER", "LANG", "LANGUAGE", "TZ", "TMPDIR", "TEMP", "TMP",
        "LD_LIBRARY_PATH", "DYLD_LIBRARY_PATH", "VIRTUAL_ENV", "XDG_DATA_HOME",
        "XDG_DATA_DIRS", "XDG_CACHE_HOME", "OSG_MODELS_DIR",
        # Without these, Windows starts no Python.
        "SYSTEMROOT", "SYSTEMDRIVE", "WINDIR", "USERPROFILE", "APPDATA", "LOCALAPPDATA",
        "PROGRAMDATA", "PROGRAMFILES", "NUMBER_OF_PROCESSORS", "PROCESSOR_ARCHITECTURE",
    }
)
# fmt: on
_PASSED_BEGINNINGS: Final = (
    "LC_",
    "PYTHON",
    "OMP_",
    "OPENBLAS_",
    "MKL_",
    "ORT_",
    "CUDA_",
    "OPENCV_",
)


def environment_of_workers(environment: Mapping[str, str] = os.environ) -> dict[str, str]:
    """Return the variables that a worker needs; all others may be secret."""
    passed = {
        name: value
        for name, value in environment.items()
        if name.upper() in _PASSED or name.upper().startswith(_PASSED_BEGINNINGS)
    }
    # ONNX Runtime would report its use, and complain that it may not.
    return {**passed, "ORT_DISABLE_TELEMETRY": "1"}


def rights_to(files: TaskFiles) -> list[str]:
    """Return the arguments that let a worker read and write these files."""
    folders = {path if path.is_dir() else path.parent for path in files.outputs}
    # Only the command line reads folders: their owner may have linked what is on another disk.
    linked = [target for path in files.inputs if path.is_dir() for target in _linked(path)]
    return [
        *(f"{READS}{path}" for path in _few([*files.inputs, *linked])),
        *(f"{WRITES}{path}" for path in sorted(folders)),
    ]


def rights_to_models(folder: Path) -> list[str]:
    """Return the arguments that let a worker read the models in a folder."""
    return [f"{READS}{path}" for path in (folder, *_linked(folder))]


def confine_worker(arguments: Sequence[str]) -> None:
    """Confine this process, which has one thread, to the files that its arguments name."""
    confine(list(_grants(arguments)))


def _linked(folder: Path) -> list[Path]:
    """Return where the links in a folder lead."""
    return [path.resolve() for path in folder.glob("*") if path.is_symlink()]


def _few(paths: Collection[Path]) -> Collection[Path]:
    if len(paths) <= MOST_NAMED:
        return paths
    return (Path(os.path.commonpath(paths)),)


def _grants(arguments: Sequence[str]) -> Iterator[tuple[Path, int]]:
    for beginning, rights in ((READS, READ), (WRITES, WRITE), (SCRATCH, UNPACK)):
        for argument in arguments:
            if argument.startswith(beginning):
                yield Path(argument.removeprefix(beginning)), rights
