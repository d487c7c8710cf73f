"""Rights of a worker process: its environment, and the files that it may read and write.

A worker reads files of strangers, which may take it over. It gets no token, database address or key
of the server; where the system can, it may open nothing but its clip, the models and the
installation (`app.system.confinement`).
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from typing import Final

from app.api.workers.executor import Order
from app.recognition.models.storage import models_dir
from app.system.confinement import READ, UNPACK, WRITE

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


def line_of(order: Order) -> bytes:
    """Return the line that starts a worker on this machine: first its rights, then its work."""
    files, models = order.files, models_dir()
    folders = {path if path.is_dir() else path.parent for path in files.outputs}
    read = [*files.inputs, models]
    # Only the command line reads folders: their owner may have linked what is on another disk.
    linked = [path.resolve() for folder in read for path in folder.glob("*") if path.is_symlink()]
    grants = [
        *((str(path), READ) for path in [*read, *linked]),
        *((str(path), WRITE) for path in sorted(folders)),
        (str(order.scratch), UNPACK),
    ]
    start = {
        "environment": environment_of_workers(),
        "grants": grants,
        "limits": (order.memory_bytes, order.cpu_seconds, order.file_bytes),
        "scratch": str(order.scratch),
        "task": order.task,
    }
    return json.dumps(start).encode() + b"\n"
