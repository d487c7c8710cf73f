"""Server identity: an id that survives restarts, so that a server knows the jobs it ran before."""

from __future__ import annotations

import re
from pathlib import Path

from app.store.atomic_files import PARTIAL_SUFFIX, publish
from app.store.models import new_id

FILE = "server"
"""Name of the file in the data folder, which one server at a time uses."""


def identity_of(folder: Path) -> str:
    """Return the id of a data folder's server, created at its first start."""
    path = folder / FILE
    if path.is_file() and re.fullmatch("[0-9a-f]{32}", known := path.read_text("ascii", "replace")):
        return known
    made, partial = new_id(), path.with_suffix(PARTIAL_SUFFIX)
    partial.write_text(made, "ascii")
    publish(partial, path)
    return made
