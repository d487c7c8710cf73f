"""CADDY's gestures: pairs of pictures of a diver who holds a hand sign, with boxes of the hands.

``CADDY_gestures_all_true_positives_release_v2.csv`` lists the pictures in the order in which they
were taken, with ``scenario``, ``stereo left`` (path below the folder), ``label name``, and
``synthetic`` (0: as the camera gave it); ``..._true_negatives_...`` those of divers who show no
sign. Only the left pictures are used. Layout as described by Gomez Chavez et al. 2019, Sec. 4.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import cv2
import numpy as np

from app.evaluation.labelled_takes import ClipRecorder
from app.recognition import OsgError
from app.recognition.poses.frame import Image
from app.recognition.recording.video import VideoFrame, VideoInfo
from benchmarks.sets.divers.diver_take import DiverTake, find_runs

SIGNS: Final = "*true_positives*.csv"
NO_SIGNS: Final = "*true_negatives*.csv"

COLUMNS: Final = ("scenario", "stereo left", "label name", "synthetic")
"""Columns of the table that are read."""

RATE: Final = 10.0
"""Pictures a second, about as fast as they were taken."""

LONGEST: Final = 10
"""Most pictures in a take: the following ones of a run are nearly the same."""


@dataclass(frozen=True)
class Row:
    """One picture of the set."""

    scenario: str
    label: str | None
    path: Path


class Pictures:
    """Frames from picture files, `RATE` a second."""

    def __init__(self, paths: tuple[Path, ...]) -> None:
        self._paths = paths
        first = _read_picture(paths[0])
        self.info = VideoInfo(
            width=first.shape[1],
            height=first.shape[0],
            duration=len(paths) / RATE,
            frames=len(paths),
            rotation=0,
            codec="mjpeg",
        )
        self.warnings: tuple[str, ...] = ()

    def __iter__(self) -> Iterator[VideoFrame]:
        """Read the pictures one after the other."""
        for index, path in enumerate(self._paths):
            yield VideoFrame(index, index / RATE, _read_picture(path))


def find_tables(folder: Path) -> tuple[Path, ...]:
    """Find the tables of pictures with signs and without."""
    return tuple(sorted([*folder.glob(SIGNS), *folder.glob(NO_SIGNS)]))


def read_takes(folder: Path, recorder: ClipRecorder) -> Iterator[DiverTake]:
    """Yield one take for each run of pictures of one scenario with the same sign.

    Raises
    ------
    OsgError
        When a table lacks a column, a picture cannot be read, or the models are not installed.

    """
    for table in find_tables(folder):
        rows = _read_rows(table, folder)
        keys = [f"{row.scenario}/{row.label}" for row in rows]
        for _, first, last in find_runs(keys):
            shown = rows[first : min(last + 1, first + LONGEST)]
            yield DiverTake(
                source=f"{shown[0].path.name} to {shown[-1].path.name}",
                label=shown[0].label,
                setting=shown[0].scenario,
                poses=recorder.record_frames(Pictures(tuple(row.path for row in shown))).poses,
            )


def _read_rows(table: Path, folder: Path) -> list[Row]:
    """Return the pictures as the camera gave them, in order."""
    negative = table.match(NO_SIGNS)
    with table.open(encoding="utf-8", newline="") as file:
        reader = csv.DictReader(file)
        if missing := set(COLUMNS) - set(reader.fieldnames or ()):
            raise OsgError(f"{table.name} has no column {', '.join(sorted(missing))}")
        return [
            Row(
                scenario=row["scenario"],
                label=None if negative else row["label name"],
                path=folder / row["stereo left"].strip().lstrip("/"),
            )
            for row in reader
            if row["synthetic"].strip() == "0"
        ]


def _read_picture(path: Path) -> Image:
    stored = cv2.imread(str(path), cv2.IMREAD_COLOR)
    if stored is None:
        raise OsgError(f"{path} is no picture that can be read")
    return np.asarray(cv2.cvtColor(stored, cv2.COLOR_BGR2RGB), np.uint8)
