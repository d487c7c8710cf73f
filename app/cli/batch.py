"""Batch: recognises a folder of clips into one table, and goes on after an interruption."""

from __future__ import annotations

import io
import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from app import __version__
from app.cli.clip_argument import ClipReading, recognize_clip
from app.cli.terminal import batch_bar, describe_error, tell
from app.clip_sources import CHAPTERS, SOURCES, VIDEO, is_copy, is_take, source_of
from app.evaluation.take_table import COLUMNS, Row, row_of_fault, rows_of_clip, write_csv
from app.recognition import Recognizer
from app.recognition.errors import OsgError, VideoError, explain_missing_package
from app.recognition.language.file import seal
from app.recognition.recording.chapters import tell_pieces
from app.recognition.spotting import Spotter
from app.recognition.text.atomic_files import write_atomically
from app.recognition.text.wording import list_some

MOST_NAMED: Final = 10
"""Most files named that are left out."""

COPY: Final = "a small or unfinished copy of a clip"


def is_folder_of_clips(path: Path) -> bool:
    """Return whether a path is a folder that is not itself a clip, unlike a bag or chapters.

    A folder with JSON files is a clip of OpenPose, unless it also holds videos.
    """
    if not path.is_dir() or CHAPTERS.accepts(path):
        return False
    return not _is_clip(path) or any(VIDEO.is_take(child) for child in path.iterdir())


def list_clips(folder: Path) -> list[Path]:
    """Return the clips in a folder and its subfolders, in the order of their names."""
    return list(_walk(folder))


def tell_left_out(folder: Path, read: Iterable[Path]) -> None:
    """Name the files of a folder that are none of those that are read, nor in one of them."""
    inside = set(read)
    left = [
        path
        for path in sorted(folder.rglob("*"))
        if path.is_file()
        and not any(part.startswith(".") for part in path.relative_to(folder).parts)
        and inside.isdisjoint((path, *path.parents))
    ]
    for reason in ("keypoints already", "no clip by its first bytes", COPY):
        names = [path.relative_to(folder).as_posix() for path in left if _why_left(path) == reason]
        if names:
            tell(f"left out, {reason}: {list_some(names, MOST_NAMED)}")


def _why_left(path: Path) -> str:
    if is_copy(path):
        return COPY
    return "keypoints already" if _is_clip(path) else "no clip by its first bytes"


def measure_bytes(path: Path) -> int:
    """Return the size of a clip, which may be a folder, in bytes."""
    if path.is_dir():
        return sum(each.stat().st_size for each in path.rglob("*") if each.is_file())
    return path.stat().st_size


def _walk(folder: Path) -> Iterator[Path]:
    for path in sorted(folder.iterdir()):
        if path.name.startswith("."):
            continue
        if is_folder_of_clips(path):
            yield from _walk(path)
        elif _is_clip(path):
            yield path


def _is_clip(path: Path) -> bool:
    if is_copy(path):
        return False
    return is_take(path) or any(source.accepts(path, None) for source in SOURCES)


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


PARQUET: Final = ".parquet"

ENDINGS: Final = (".csv", PARQUET)


def check_table(path: Path) -> None:
    """Refuse a table that could not be written at the end.

    Raises
    ------
    OsgError
        When its ending is unknown, its folder is missing, or the library for Parquet is.

    """
    if path.suffix.lower() not in ENDINGS:
        raise OsgError(f"{path} is no table; end its name in {' or '.join(ENDINGS)}")
    if not path.parent.is_dir():
        raise OsgError(f"{path.parent} is no folder; make it, or write the table elsewhere")
    if path.suffix.lower() == PARQUET:
        with explain_missing_package(str(path), "parquet", instead=", or write a .csv"):
            import pyarrow  # noqa: F401


def write_table(path: Path, rows: Sequence[Row]) -> None:
    """Write a table in one step, in place of an existing one."""
    content = (
        _to_parquet(rows) if path.suffix.lower() == PARQUET else write_csv(rows).encode("utf-8")
    )
    write_atomically(path, content)


def _to_parquet(rows: Sequence[Row]) -> bytes:
    import pyarrow
    from pyarrow import parquet

    kinds = {
        str: pyarrow.string(),
        int: pyarrow.int64(),
        float: pyarrow.float64(),
        bool: pyarrow.bool_(),
    }
    schema = pyarrow.schema([(name, kinds[kind]) for name, kind in COLUMNS.items()])
    written = io.BytesIO()
    parquet.write_table(pyarrow.Table.from_pylist(list(rows), schema), written)
    return written.getvalue()


@dataclass(frozen=True, eq=False)
class FolderBatch:
    """Batch of all clips of a folder, into one table.

    Clips that an earlier run with the same settings has done are taken from its journal beside the
    table. A clip that cannot be read becomes a row with its fault.

    Attributes
    ----------
    folder
        Folder of clips.
    table
        File to write, ``.csv`` or ``.parquet``.
    recognizer
        Recogniser of the language.
    reading
        How clips are read.
    spotter
        Finds gestures without salutes; None for recognition with salutes.
    excluded
        Files of the folder to leave out, such as the language.

    """

    folder: Path
    table: Path
    recognizer: Recognizer
    reading: ClipReading
    spotter: Spotter | None = None
    excluded: Sequence[Path] = ()

    def run(self) -> int:
        """Recognise the remaining clips and write the table.

        Returns
        -------
        Number of recognised takes, including those of earlier runs.

        Raises
        ------
        OsgError
            When the table cannot be written, or the folder holds no clip.

        """
        check_table(self.table)
        clips = self._list_clips()
        journal = Journal(self._journal_file, self._settings())
        if journal.restarted:
            tell(f"{self._journal_file}: of another language or settings; begun anew")
        states = {clip: describe_state(clip) for clip in clips}
        done = {clip: journal.find(self._name(clip), states[clip]) for clip in clips}
        left = {clip: measure_bytes(clip) for clip in clips if done[clip] is None}
        tell_left_out(self.folder, (*clips, *self.excluded, self.table, self._journal_file))
        for told in tell_pieces(clips):
            tell(told)
        if len(left) < len(clips):
            tell(f"{len(clips) - len(left)} of {len(clips)} clips are done already")
        with batch_bar(len(left), sum(left.values())) as advance:
            for clip, size in left.items():
                rows = done[clip] = self._recognize(clip)
                journal.add(self._name(clip), states[clip], rows)
                advance(size, f"{self._name(clip)}: {_summarise(rows)}")
        table = [row for rows in done.values() for row in rows or ()]
        write_table(self.table, table)
        recognised = sum(row["label"] is not None for row in table)
        tell(f"{self.table}: {len(clips)} clips, {recognised} gestures recognised")
        return recognised

    @property
    def _journal_file(self) -> Path:
        return self.table.with_name(f"{self.table.name}.journal")

    def _list_clips(self) -> list[Path]:
        others = {path.resolve() for path in (*self.excluded, self.table, self._journal_file)}
        clips = [clip for clip in list_clips(self.folder) if clip.resolve() not in others]
        if not clips:
            # For a folder without clips, the error names the kinds of clips.
            try:
                source_of(self.folder)
            except VideoError as error:
                raise OsgError(f"{error}, or a folder of clips") from error
        return clips

    def _settings(self) -> dict[str, Any]:
        """Return all settings that affect a result, as plain JSON types."""
        return {
            "version": __version__,
            "columns": list(COLUMNS),
            "language": seal(json.loads(self.recognizer.language.to_json())),
            "profile": self.recognizer.profile,
            "salutes": self.spotter is None,
            "reading": self.reading.options(None).model_dump(mode="json"),
            "models": [self.reading.estimator, self.reading.hands],
        }

    def _name(self, clip: Path) -> str:
        return clip.relative_to(self.folder).as_posix()

    def _recognize(self, clip: Path) -> list[Row]:
        name = self._name(clip)
        try:
            recording, results = recognize_clip(
                clip, None, self.reading, self.recognizer, self.spotter
            )
        except (OsgError, OSError) as error:
            return [row_of_fault(name, self.recognizer, describe_error(error))]
        return rows_of_clip(name, self.recognizer, recording, results)


def _summarise(rows: Sequence[Row]) -> str:
    if rows[0]["take"] is None:
        return str(rows[0]["faults"])
    return ", ".join(
        str(row["label"] or (f"{row['pair']}?" if row["pair"] else "rejected")) for row in rows
    )
