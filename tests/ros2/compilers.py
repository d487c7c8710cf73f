"""Finds what compiles the message packages."""

from __future__ import annotations

import shutil
import sysconfig
from pathlib import Path

PYTHON_HEADERS = Path(sysconfig.get_paths()["include"])


def find_compilers() -> tuple[str, str] | None:
    """Return the C and the C++ compiler, or None where one or Python's headers are missing."""
    c, cpp = shutil.which("gcc"), shutil.which("g++")
    return (c, cpp) if c and cpp and (PYTHON_HEADERS / "Python.h").is_file() else None
