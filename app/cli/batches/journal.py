"""Batch journal: stores the rows of each finished clip, so that an interrupted batch can go on."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from app.evaluation.take_table import Row


class Journal:
    """File with one JSON line a clip, beside the table; a clip is in it once it is done.

    Parameters
    ----------
    path
        The file; started again if it was written with other settings.
    settings
        All settings that affect a result: language, profile, estimator.

    Attributes
    ----------
    restarted
        Whether a journal with other settings existed.

    """

    def __init__(self, path: Path, settings: dict[str, Any]) -> None:
        self._path = path
        self._clips: dict[str, dict[str, Any]] = {}
        lines = _read_lines(path)
        self.restarted = bool(lines) and lines[0] != {"settings": settings}
        if self.restarted or not lines:
            path.write_text(json.dumps({"settings": settings}) + "\n", encoding="utf-8")
        else:
            self._clips = {line["clip"]: line for line in lines[1:]}

    def find(self, name: str, state: str) -> list[Row] | None:
        """Return the rows of a clip; None if it is not done, or has changed since."""
        line = self._clips.get(name)
        return line["rows"] if line is not None and line["state"] == state else None

    def add(self, name: str, state: str, rows: list[Row]) -> None:
        """Add the rows of a clip.

        Parameters
        ----------
        name
            The clip's name in the folder.
        state
            State of the clip's file; see `describe_state`.
        rows
            Its rows.

        """
        line = {"clip": name, "state": state, "rows": rows}
        self._clips[name] = line
        with self._path.open("a", encoding="utf-8") as file:
            file.write(json.dumps(line, allow_nan=False) + "\n")


def _read_lines(path: Path) -> list[dict[str, Any]]:
    """Return the lines up to the first incomplete one, because a crash can cut the last line."""
    lines = []
    try:
        for text in path.read_text(encoding="utf-8").splitlines():
            lines.append(json.loads(text))
    except (FileNotFoundError, ValueError):
        pass
    return lines


def describe_state(path: Path) -> str:
    """Return a text that changes whenever a file does, or any file of a folder."""
    files = sorted(each for each in path.rglob("*") if each.is_file()) if path.is_dir() else [path]
    stats = [file.stat() for file in files]
    last = max((stat.st_mtime_ns for stat in stats), default=0)
    return f"{len(files)} files, {sum(stat.st_size for stat in stats)} bytes, {last} ns"
