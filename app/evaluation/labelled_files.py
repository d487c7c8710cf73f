"""A folder of labelled clips, recordings or keypoint files: which shows which gesture, by whom."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from app.keypoint_files import is_keypoint_file
from app.recognition.errors import OsgError

LAYOUTS = ("{label}_*", "{label}/*", "{person}/{label}/*")
"""Layouts assumed for files that lie one, two or three levels deep, when none is given."""

SEPARATORS = "_-. "
"""Where the label of a file directly in the folder ends: ``circle-1.mp4``, ``circle 2.mp4``."""

SUFFIXES = frozenset({".avi", ".m4v", ".mkv", ".mov", ".mp4", ".mpeg", ".mpg", ".webm", ".npz"})
"""Files taken for clips, or (``.npz``) for saved recordings, beside the keypoint files of other
programs; all else is passed over."""

_FIELDS = {
    "{label}": r"(?P<label>[^/]+?)",
    "{person}": r"(?P<person>[^/]+?)",
    "*": r"[^/]*",
    "#": r"\d+",
}


@dataclass(frozen=True)
class LabelledFile:
    """A file with what its place says about it.

    Attributes
    ----------
    path
        The clip, the saved recording, or the keypoint file (of OpenPose, the folder).
    label
        The gesture it shows.
    person
        Who shows it; empty where the layout does not say.

    """

    path: Path
    label: str
    person: str = ""


def labelled_files(folder: Path, layout: str | None = None) -> tuple[LabelledFile, ...]:
    """Find the clips, recordings and keypoint files of a folder, with their labels.

    Parameters
    ----------
    folder
        Searched with its subfolders; what begins with a dot is passed over.
    layout
        How label and person stand in a file's path below the folder, without its suffix:
        ``{label}`` and ``{person}`` are as short as they can be, ``*`` is any text within one
        level, ``#`` a number. As in ``{person}/{label}_#``. None: by depth, `LAYOUTS`, where the
        prefix of a file directly in the folder may end in any of `SEPARATORS`.

    Returns
    -------
    In the order of their paths.

    Raises
    ------
    OsgError
        When the layout has no label, or no file fits.

    """
    if layout is not None and "{label}" not in layout:
        raise OsgError(
            f"layout {layout!r} does not say where the label stands: put {{label}} into it, as in "
            "{person}/{label}_#"
        )
    found = []
    for path in _readable(folder):
        relative = PurePosixPath(path.relative_to(folder).as_posix())
        name = str(relative if path.is_dir() else relative.with_suffix(""))
        if fields := _read(name, layout):
            found.append(LabelledFile(path, fields["label"], fields.get("person") or ""))
    if not found:
        raise OsgError(
            f"{folder} holds no clip that fits {layout or ' or '.join(LAYOUTS)}; name its files "
            "so, or say how they are named with --layout"
        )
    return tuple(found)


def _readable(folder: Path) -> Iterator[Path]:
    """Go through what may be a take; a folder of OpenPose is one, and not each of its frames."""
    for path in sorted(folder.iterdir()):
        if path.name.startswith("."):
            continue
        if is_keypoint_file(path) or (path.is_file() and path.suffix.lower() in SUFFIXES):
            yield path
        elif path.is_dir():
            yield from _readable(path)


def _read(name: str, layout: str | None) -> dict[str, str] | None:
    """Read label and person out of a path without suffix, or None where it does not fit."""
    if layout is None:
        depth = name.count("/")
        if depth >= len(LAYOUTS):
            return None
        if depth == 0:
            return {"label": re.split(f"[{re.escape(SEPARATORS)}]", name, maxsplit=1)[0]}
        layout = LAYOUTS[depth]
    parts = re.split(r"(\{label\}|\{person\}|\*|#)", layout)
    pattern = "".join(_FIELDS.get(part, re.escape(part)) for part in parts)
    match = re.fullmatch(pattern, name)
    return match.groupdict() if match else None
