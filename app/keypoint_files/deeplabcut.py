"""DeepLabCut reader: predictions as CSV, with three or four rows of headings and one row a frame.

DeepLabCut writes HDF5 by default, but those files hold pickled Python objects, which can run any
code when read. CSV holds only numbers: ``deeplabcut.analyze_videos_converth5_to_csv`` writes it.
"""

from __future__ import annotations

import codecs
import csv
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import numpy as np

from app.keypoint_files.keypoint_people import Person, table_of_people
from app.keypoint_files.keypoint_table import (
    KeypointFormat,
    KeypointOptions,
    KeypointTable,
    Times,
    has_no_zero,
)
from app.recognition.errors import KeypointFileError
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.skeletons import translate_landmark
from app.recognition.recording.video_limits import VideoLimits

LEAST_LIKELIHOOD: Final = 0.6
"""Likelihood below which a keypoint counts as not seen: DeepLabCut's own default (``pcutoff``).
Less likely keypoints are often at a wrong place altogether."""

MOST_HEADINGS: Final = 4
"""Most rows of headings: scorer, individuals, bodyparts, coords."""

COORDINATES: Final = ("x", "y", "likelihood")

ONLY: Final = "single"
"""Name of the only individual in a file without individuals."""


def begins_as_deeplabcut(head: bytes) -> bool:
    """Return whether a file begins as DeepLabCut's files do."""
    word = head.removeprefix(codecs.BOM_UTF8)[:6].lower()
    return word == b"scorer" and has_no_zero(head)


def read_deeplabcut(path: Path, options: KeypointOptions, limits: VideoLimits) -> KeypointTable:
    """Read a file of predictions; see `app.keypoint_files.read_keypoints`.

    Trackers mix up individuals: of several, one is followed by place and not by name.
    """
    with path.open(newline="", encoding="utf-8-sig") as file:
        lines = csv.reader(file)
        headings = _headings(lines, path)
        rows: list[FloatArray] = []
        for line in lines:
            if line:
                limits.require_frames(len(rows) + 1)
                rows.append(_numbers(line, headings, len(rows), path))
    if not rows:
        raise KeypointFileError(f"{path} has headings and no frame")
    table = np.array(rows)
    columns = [
        *zip(headings["individuals"], headings["bodyparts"], headings["coords"], strict=True)
    ]
    parts: dict[str, list[str]] = {}
    for who, part, _ in columns:
        parts.setdefault(who, []).append(part)
    # Body parts outside of the individuals, as of a buoy, form an individual of their own.
    people = [who for who in parts if _is_person(parts[who], options)] or list(parts)
    names = tuple(dict.fromkeys(part for who in people for part in parts[who]))
    points = np.full((len(table), len(people), len(names), len(COORDINATES)), np.nan)
    for column, (who, part, axis) in enumerate(columns, 1):
        if who in people:
            person, landmark = people.index(who), names.index(part)
            points[:, person, landmark, COORDINATES.index(axis)] = table[:, column]
    points[points[..., 2] < LEAST_LIKELIHOOD] = np.nan
    everybody = [[Person(one) for one in frame] for frame in points]
    times = Times(table[:, 0], counted=True)
    return table_of_people(everybody, times, path, options, names=names)


def _headings(lines: Iterator[list[str]], path: Path) -> dict[str, list[str]]:
    """Return individual, body part and coordinate of every column after the first."""
    rows: dict[str, list[str]] = {}
    for line in lines:
        if line:
            rows[line[0].strip().lower()] = [cell.strip() for cell in line[1:]]
        if "coords" in rows or len(rows) > MOST_HEADINGS:
            break
    coords = rows.get("coords", [])
    complete = {"x", "y"} <= set(coords) <= set(COORDINATES)
    if not complete or len(rows.get("bodyparts", ())) != len(coords):
        raise KeypointFileError(
            f"{path} lacks DeepLabCut's headings scorer, bodyparts, coords (x, y, likelihood); "
            f"write it with deeplabcut.analyze_videos_converth5_to_csv"
        )
    if len(rows.setdefault("individuals", [ONLY] * len(coords))) != len(coords):
        raise KeypointFileError(f"{path} has headings of different lengths; export it again")
    return rows


def _numbers(line: list[str], headings: dict[str, list[str]], row: int, path: Path) -> FloatArray:
    wanted = len(headings["coords"]) + 1
    if len(line) != wanted:
        raise KeypointFileError(f"{path}: row {row} has {len(line)} cells, expected {wanted}")
    try:
        return np.array([float(cell) if cell.strip() else np.nan for cell in line])
    except ValueError as error:
        raise KeypointFileError(
            f"{path}: row {row} is no row of numbers ({error}); labelled pictures are no recording,"
            f" give the predictions for a video"
        ) from error


def _is_person(names: list[str], options: KeypointOptions) -> bool:
    return any(name in options.landmarks or translate_landmark(name) for name in names)


DEEPLABCUT: Final = KeypointFormat(
    (".csv", ".tsv"), begins_as_deeplabcut, read_deeplabcut, is_text=True
)
