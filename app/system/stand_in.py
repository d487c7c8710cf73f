"""Stand-in: gives a stored file another name for a reader that decides by the name."""

from __future__ import annotations

import os
import shutil
from pathlib import Path


def stand_in(path: Path, place: Path) -> None:
    """Make `place` a stand-in for the file at `path`, without a copy if the system allows it.

    Raises
    ------
    OSError
        When the file can be neither linked nor copied.

    """
    # A link to another folder first: a confined process may not make a second name for a file.
    for way in (os.symlink, os.link):
        try:
            way(path.resolve(), place)
        except OSError:
            continue
        return
    shutil.copyfile(path, place)
