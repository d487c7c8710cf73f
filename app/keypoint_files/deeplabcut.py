"""DeepLabCut reader: predictions as CSV, with three or four rows of headings and one row a frame.

DeepLabCut writes HDF5 by default, but those files hold pickled Python objects, which can run any
code when read. CSV holds only numbers: ``deeplabcut.analyze_videos_converth5_to_csv`` writes it.
"""

from __future__ import annotations

import codecs
import csv
from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from app.keypoint_files.keypoint_table import (
    MOST_PEOPLE,
    KeypointOptions,
    KeypointTable,
    Times,
    mask_unseen,
    visibility_of,
)
from app.recognition.errors import KeypointFileError
from app.recognition.estimation.person_tracker import find_boxes
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.skeletons import translate_landmark
from app.recognition.recording.people import prominence_over
from app.recognition.recording.video_limits import VideoLimits

LEAST_LIKELIHOOD: Final = 0.6
"""Likelihood below which a keypoint counts as not seen: DeepLabCut's own default (``pcutoff``).
Less likely keypoints are often at a wrong place altogether."""

MOST_HEADINGS: Final = 4
"""Most rows of headings: scorer, individuals, bodyparts, coords."""

COORDINATES: Final = ("x", "y", "likelihood")

MOST_CROSSED: Final = 4.0
"""How many times as far two individuals must have moved if they stayed who they are than if they
changed places, besides a body's size, to be taken for mixed up."""

LONGEST_GAP: Final = 10
"""Most frames from the last in which both are seen to the next, in which they may be mixed up."""

ONLY: Final = "single"
"""Name of the only individual in a file without individuals."""


def is_deeplabcut(path: Path) -> bool:
    """Return whether a CSV file begins as DeepLabCut's files do."""
    with path.open("rb") as file:
        return file.read(9).removeprefix(codecs.BOM_UTF8).lower().startswith(b"scorer")


def read_deeplabcut(path: Path, options: KeypointOptions, limits: VideoLimits) -> KeypointTable:
    """Read a file of predictions; of several individuals the most prominent is taken.

    See `app.keypoint_files.read_keypoints`.
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
    everybody = {
        each: _individual(table, headings, each) for each in dict.fromkeys(headings["individuals"])
    }
    # Body parts outside of the individuals, as of a buoy, form an individual of their own.
    people = {
        who: one for who, one in everybody.items() if _is_person(one.names, options)
    } or everybody
    people, swapped = _undo_swaps(people)
    chosen = max(people, key=lambda who: prominence_over(people[who].xy, people[who].confidence))
    seen = [np.asarray(np.isfinite(one.xy).all(axis=2)).any(axis=1) for one in people.values()]
    return replace(
        people[chosen],
        notes=(*_notes(len(people), chosen), *swapped),
        people=np.sum(seen, axis=0, dtype=np.int64),
    )


def _individual(table: FloatArray, headings: dict[str, list[str]], who: str) -> KeypointTable:
    """Return one individual's table from the rows ``(T, 1 + columns)``."""
    columns = [
        (part, axis, column)
        for column, (individual, part, axis) in enumerate(
            zip(headings["individuals"], headings["bodyparts"], headings["coords"], strict=True), 1
        )
        if individual == who
    ]
    names = tuple(dict.fromkeys(part for part, _, _ in columns))
    points = np.full((len(table), len(names), len(COORDINATES)), np.nan)
    for part, axis, column in columns:
        points[:, names.index(part), COORDINATES.index(axis)] = table[:, column]
    confidence = visibility_of(points)
    return KeypointTable(
        names=names,
        xy=mask_unseen(points[..., :2], confidence, LEAST_LIKELIHOOD),
        confidence=confidence,
        times=Times(table[:, 0], counted=True),
    )


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


def _is_person(names: tuple[str, ...], options: KeypointOptions) -> bool:
    return any(name in options.landmarks or translate_landmark(name) for name in names)


def _undo_swaps(
    people: dict[str, KeypointTable],
) -> tuple[dict[str, KeypointTable], tuple[str, ...]]:
    """Exchange the rest of two individuals who change places from one frame to the next.

    Trackers mix up identities; nobody moves by a body's size in a frame to where another one was.
    """
    found, notes = dict(people), list[str]()
    for one, other in combinations(list(found)[:MOST_PEOPLE], 2):
        first, second = found[one], found[other]
        if first.names != second.names:
            continue
        both = np.stack([first.xy, second.xy])
        seen = np.asarray(np.isfinite(both).all(axis=3)).any(axis=2).all(axis=0)
        rows = np.flatnonzero(seen)
        if len(rows) < 2:
            continue
        centres = np.nanmedian(both[:, rows], axis=2)
        boxes = find_boxes(both[0, rows])
        size = float(np.median(np.linalg.norm(boxes[:, 1] - boxes[:, 0], axis=1)))
        stay = np.linalg.norm(centres[:, 1:] - centres[:, :-1], axis=2).sum(axis=0)
        cross = np.linalg.norm(centres[:, 1:] - centres[::-1, :-1], axis=2).sum(axis=0)
        near = np.diff(rows) <= LONGEST_GAP
        swaps = rows[1:][near & (stay > MOST_CROSSED * cross + size)]
        if not len(swaps):
            continue
        flipped = np.searchsorted(swaps, np.arange(len(first.xy)), side="right") % 2 == 1
        found[one], found[other] = (
            _take_rows(*pair, flipped) for pair in ((first, second), (second, first))
        )
        notes.append(
            f"{one!r} and {other!r} change places within a frame, first at frame "
            f"{int(first.times.values[swaps[0]])}; each is followed by place"
        )
    return found, tuple(notes)


def _take_rows(
    own: KeypointTable, other: KeypointTable, rows: npt.NDArray[np.bool_]
) -> KeypointTable:
    """Return a table with the other's values in these rows."""
    assert own.confidence is not None
    assert other.confidence is not None
    return replace(
        own,
        xy=np.where(rows[:, None, None], other.xy, own.xy),
        confidence=np.where(rows[:, None], other.confidence, own.confidence),
    )


def _notes(count: int, chosen: str) -> tuple[str, ...]:
    if count == 1:
        return ()
    return (f"of {count} individuals {chosen!r} stands out most and is followed",)
