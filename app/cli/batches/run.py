"""Batch of ``osg-studio recognize FOLDER``: every clip once, and one table of all takes."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from app import __version__
from app.cli.batches.folder import list_clips, measure_bytes
from app.cli.batches.journal import Journal, describe_state
from app.cli.batches.table import check_table, write_table
from app.cli.clip_argument import ClipReading, recognize_clip
from app.cli.terminal import batch_bar, describe_error, people
from app.clip_sources import source_of
from app.evaluation.take_table import COLUMNS, Row, row_of_fault, rows_of_clip
from app.recognition import Recognizer
from app.recognition.errors import OsgError, VideoError
from app.recognition.language.file import seal
from app.recognition.spotting import Spotter


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
            text = f"{self._journal_file}: of another language or settings; begun anew"
            people.print(text, markup=False, soft_wrap=True)
        states = {clip: describe_state(clip) for clip in clips}
        done = {clip: journal.find(self._name(clip), states[clip]) for clip in clips}
        left = {clip: measure_bytes(clip) for clip in clips if done[clip] is None}
        if len(left) < len(clips):
            people.print(f"{len(clips) - len(left)} of {len(clips)} clips are done already")
        with batch_bar(len(left), sum(left.values())) as advance:
            for clip, size in left.items():
                rows = done[clip] = self._recognize(clip)
                journal.add(self._name(clip), states[clip], rows)
                advance(size, f"{self._name(clip)}: {_summarise(rows)}")
        table = [row for rows in done.values() for row in rows or ()]
        write_table(self.table, table)
        recognised = sum(row["label"] is not None for row in table)
        people.print(
            f"{self.table}: {len(clips)} clips, {recognised} gestures recognised",
            markup=False,
            soft_wrap=True,
        )
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
            "reading": {
                name: value for name, value in asdict(self.reading).items() if name != "trigger"
            },  # the language has its own trigger
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
    return ", ".join(_summarise_take(row) for row in rows)


def _summarise_take(row: Row) -> str:
    return str(row["label"] or (f"{row['pair']}?" if row["pair"] else "rejected"))
