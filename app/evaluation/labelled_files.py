"""Labelled files: finds clips in a folder and reads label and person from their paths."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from app.clip_sources import is_take
from app.evaluation.kept_recordings import RECORDING_ENDING
from app.recognition.errors import OsgError
from app.recognition.text.look_alikes import compose

LAYOUTS = ("{label}_*", "{label}/*", "{person}/{label}/*")
"""Default layouts for files one, two and three levels deep."""

SEPARATORS = "_-. "
"""Characters that end the label of a file directly in the folder: ``circle-1.mp4``."""

_FIELDS = {
    "{label}": r"(?P<label>[^/]+?)",
    "{person}": r"(?P<person>[^/]+?)",
    "*": r"[^/]*",
    "#": r"\d+",
}


@dataclass(frozen=True)
class LabelledFile:
    """A file with the label and person in its path.

    Attributes
    ----------
    path
        The clip, the saved recording, or the keypoint file (of OpenPose, the folder).
    label
        The gesture it shows.
    person
        Person who shows it; empty where the layout has none.

    """

    path: Path
    label: str
    person: str = ""


def labelled_files(folder: Path, layout: str | None = None) -> tuple[LabelledFile, ...]:
    """Find the clips, recordings and keypoint files of a folder, with their labels.

    Parameters
    ----------
    folder
        Searched with its subfolders; names that begin with a dot are ignored.
    layout
        Pattern of a file's path below the folder, without suffix, such as ``{person}/{label}_#``:
        ``{label}`` and ``{person}`` match as little as possible, ``*`` any text within one level,
        ``#`` a number. None: one of `LAYOUTS` by depth, where the label of a file directly in the
        folder may end in any of `SEPARATORS`.

    Returns
    -------
    The files in the order of their paths.

    Raises
    ------
    OsgError
        When the layout has no label, or no file matches.

    """
    if layout is not None and "{label}" not in layout:
        raise OsgError(f"layout {layout!r} has no {{label}}: add it, as in {{person}}/{{label}}_#")
    found = []
    for path in _readable(folder):
        relative = PurePosixPath(path.relative_to(folder).as_posix())
        name = str(relative if path.is_dir() else relative.with_suffix(""))
        if fields := _read(name, layout):
            label, person = (compose(fields.get(key) or "") for key in ("label", "person"))
            found.append(LabelledFile(path, label, person))
    if not found:
        raise OsgError(
            f"{folder} holds no clip that fits {layout or ' or '.join(LAYOUTS)}; name its files "
            "so, or give their layout with --layout"
        )
    return tuple(found)


def _readable(folder: Path) -> Iterator[Path]:
    """Yield the files that may be takes; a folder of OpenPose is one take, not its frames."""
    for path in sorted(folder.iterdir()):
        if path.name.startswith("."):
            continue
        if is_take(path) or (path.is_file() and path.suffix.lower() == RECORDING_ENDING):
            yield path
        elif path.is_dir():
            yield from _readable(path)


def _read(name: str, layout: str | None) -> dict[str, str] | None:
    """Read label and person from a path without suffix; None where it does not match."""
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
