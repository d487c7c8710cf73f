"""MediaPipe landmarks as CSV, in the common layouts (MediaPipe itself writes no files).

One frame a row, with numbered columns (``x0,y0,z0,v0,x1,...``) or named ones (``nose_x``,
``LEFT_WRIST.visibility``), or one landmark a row (``frame,landmark,x,y``). Hands are numbered or
named (``left_hand_0_x``). SLEAP's analysis has a column that says whose track a row is of.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from app.keypoint_files.column_names import (
    AXES,
    MOST_LANDMARKS,
    NAMES,
    Columns,
    columns_of,
    name_numbers,
    plain,
    time_column,
)
from app.keypoint_files.keypoint_people import name_points, table_of, tell_track
from app.keypoint_files.keypoint_table import (
    MOST_PEOPLE,
    Facts,
    KeypointFormat,
    KeypointOptions,
    KeypointTable,
    Times,
    hands_of,
    has_no_zero,
    mask_unseen,
    visibility_of,
)
from app.recognition.errors import KeypointFileError
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.skeletons import KeypointSet
from app.recognition.recording.people import prominence_over
from app.recognition.recording.video_limits import VideoLimits
from app.recognition.text.strict_json import is_utf16

SEPARATORS: Final = ",;\t"
"""Separators of a table's cells; Excel writes semicolons where the comma is a decimal one."""

PER_SECOND: Final = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}
"""Units of time in a second, by their names."""


def read_mediapipe_table(
    path: Path, options: KeypointOptions, limits: VideoLimits
) -> KeypointTable:
    """Read a CSV file of either form; see `app.keypoint_files.read_keypoints`."""
    with path.open(newline="", encoding=find_encoding(path)) as file:
        heading = file.readline()
        # By this line a spreadsheet is told the separator, which the heading shows as well.
        if heading.strip().lower() in [f"sep={each}" for each in SEPARATORS]:
            heading = file.readline()
        separator = max(SEPARATORS, key=heading.count)
        headings = next(csv.reader([heading], delimiter=separator, skipinitialspace=True), [])
        # Where a comma separates nothing, it is a decimal one.
        rows = csv.reader(file, delimiter=separator, skipinitialspace=True)
        points = (
            rows if separator == "," else ([cell.replace(",", ".") for cell in row] for row in rows)
        )
        lines = _whole(points, len(headings), path)
        plainly = [plain(heading) for heading in headings]
        if any(name in plainly for name in NAMES) and {"x", "y"} <= set(plainly):
            return _long(lines, headings, path, options, limits)
        try:
            columns = columns_of(headings)
        except KeypointFileError as error:
            raise KeypointFileError(f"{path}: {error}") from error
        if not columns.points or len(columns.points) > MOST_LANDMARKS:
            raise KeypointFileError(
                f"{path} has no columns of keypoints among {_shown(headings)}; expected x0, y0, "
                f"..., or nose_x, nose_y, ..., or frame, landmark, x, y"
            )
        return _wide(lines, columns, path, options, limits)


def find_encoding(path: Path) -> str:
    """Return the encoding of a table: UTF-8, or UTF-16 by its byte-order mark, as Excel writes."""
    with path.open("rb") as file:
        return "utf-16" if is_utf16(file.read(2)) else "utf-8-sig"


def times_of(values: FloatArray, unit: str) -> Times:
    """Return the times of frames from a file's values in the unit, or as numbers of frames.

    Times without a unit are those of which a step is a second or less: frames so far apart would
    show no gesture.
    """
    if unit == "frames":
        return Times(values, counted=True)
    step = float(np.median(np.diff(values))) if len(values) > 1 else 0.0
    units = [PER_SECOND[unit]] if unit != "s" else [*PER_SECOND.values()]
    scale = next((each for each in units if step <= each), units[-1])
    # Nanoseconds since 1970 are beyond the digits of a number of seconds.
    return Times((values - values[:1]) / scale, counted=False, written=values)


def _wide(
    lines: Iterator[list[str]],
    columns: Columns,
    path: Path,
    options: KeypointOptions,
    limits: VideoLimits,
) -> KeypointTable:
    names = tuple(columns.points)
    places = [columns.points[name] for name in names]
    sides = tuple(columns.hands)
    places += [each for side in sides for each in columns.hands[side]]
    rows: list[list[list[float]]] = []
    times: list[float] = []
    people: list[str] = []
    for number, line in enumerate(lines):
        limits.require_frames(1 + number // (1 if columns.who is None else MOST_PEOPLE))
        rows.append(
            [
                [_number(line, each.get(axis), number, path) for axis in ("x", "y", "v")]
                for each in places
            ]
        )
        times.append(
            float(number) if columns.when is None else _number(line, columns.when, number, path)
        )
        if columns.who is not None:
            people.append(line[columns.who].strip() if columns.who < len(line) else "")
    points, moments = _points(rows, len(places)), np.array(times)
    facts = Facts()
    if len(set(people)) > 1:
        chosen, moments, facts = _choose_person(points[:, : len(names)], moments, people, path)
        limits.require_frames(len(moments))
        points = np.where(chosen[:, None, None] < 0, np.nan, points[chosen])
    return table_of(
        _kind(names, path, options),
        points[:, : len(names)],
        times_of(moments, columns.unit),
        path,
        hands_of(points[:, len(names) :], sides),
        **facts,
    )


def _choose_person(
    points: FloatArray, moments: FloatArray, people: Sequence[str], path: Path
) -> tuple[npt.NDArray[np.int64], FloatArray, Facts]:
    """Choose the most prominent of several people, each in rows of their own.

    Returns
    -------
    The rows ``(T,)`` of that person, -1 where there is none, the ``(T,)`` times of all, and what
    is told of them.

    Raises
    ------
    KeypointFileError
        When somebody has two rows of one time, so that it is not told who is who.

    """
    times, at = np.unique(moments, return_inverse=True)
    by_name: dict[str, list[int]] = {}
    for row, name in enumerate(people):
        by_name.setdefault(name, []).append(row)
    for name, rows in by_name.items():
        if len(set(at[rows].tolist())) < len(rows):
            raise KeypointFileError(
                f"{path} has two rows of {name or 'nobody by name'} at one time; export each "
                "person's track by its own name"
            )
    confidence = visibility_of(points)
    xy = mask_unseen(points[..., :2], confidence)
    # The rows of a track follow each other in time, as its movement is measured.
    ordered = {name: sorted(rows, key=lambda row: at[row]) for name, rows in by_name.items()}
    name = max(
        ordered, key=lambda name: prominence_over(xy[ordered[name]], confidence[ordered[name]])
    )
    followed = np.full(len(times), -1)
    followed[at[ordered[name]]] = ordered[name]
    seen = np.asarray(np.isfinite(xy).all(axis=2)).any(axis=1)
    notes = tell_track(len(ordered), name)
    return followed, times, Facts(people=np.bincount(at[seen], minlength=len(times)), notes=notes)


def _long(
    lines: Iterator[list[str]],
    headings: Sequence[str],
    path: Path,
    options: KeypointOptions,
    limits: VideoLimits,
) -> KeypointTable:
    plainly = [plain(heading) for heading in headings]
    named = next(plainly.index(name) for name in NAMES if name in plainly)
    when, unit = time_column(headings)
    if when is None:
        raise KeypointFileError(
            f"{path} has one landmark a row and no column that tells the frame, among "
            f"{_shown(headings)}; add one named frame or time"
        )
    axes = {AXES[name]: place for place, name in enumerate(plainly) if name in AXES}
    frames: dict[float, dict[str, list[float]]] = {}
    for number, line in enumerate(lines):
        at = _number(line, when, number, path)
        landmarks = frames.setdefault(at, {})
        limits.require_frames(len(frames))
        name = line[named].strip() if named < len(line) else ""
        if name in landmarks or len(landmarks) >= MOST_LANDMARKS:
            raise KeypointFileError(
                f"{path}: row {number} is the second for {name} at {at:g}; keep one person's rows"
            )
        landmarks[name] = [_number(line, axes.get(axis), number, path) for axis in ("x", "y", "v")]
    names = name_numbers(name for landmarks in frames.values() for name in landmarks)
    unseen = [np.nan] * 3
    rows = [[landmarks.get(name, unseen) for name in names] for landmarks in frames.values()]
    return table_of(
        _kind(tuple(names.values()), path, options),
        _points(rows, len(names)),
        times_of(np.array(list(frames)), unit),
        path,
    )


def _kind(names: tuple[str, ...], path: Path, options: KeypointOptions) -> KeypointSet:
    """Return the set of keypoints with these names, all of which may be numbers."""
    if names and all(name.isdecimal() for name in names):
        return name_points(names, path, options)
    return KeypointSet("", names)


def _points(rows: list[list[list[float]]], count: int) -> FloatArray:
    """Return T rows of `count` landmarks of x, y and visibility as ``(T, count, 3)``."""
    return np.array(rows, dtype=np.float64).reshape(len(rows), count, 3)


def _whole(lines: Iterator[list[str]], cells: int, path: Path) -> Iterator[list[str]]:
    """Skip empty lines, and refuse those with more or fewer cells than the heading has."""
    for number, line in enumerate(lines):
        if any(cell.strip() for cell in line[cells:]):
            raise KeypointFileError(
                f"{path}: rows have {len(line)} cells, the heading {cells}; where commas are "
                "decimal ones, separate the cells by semicolons"
            )
        if not any(cell.strip() for cell in line):
            continue
        if len(line) < cells:
            raise KeypointFileError(
                f"{path}: row {number} has {len(line)} cells, the heading {cells}; write an empty "
                "cell for each keypoint that was not found, and remove a row that breaks off"
            )
        yield line


def _number(line: Sequence[str], place: int | None, row: int, path: Path) -> float:
    """Return a cell's number; NaN for an empty cell or a missing column."""
    if place is None:
        return np.nan
    cell = line[place].strip() if place < len(line) else ""
    try:
        return float(cell) if cell and cell.lower() not in ("none", "null") else np.nan
    except ValueError as error:
        raise KeypointFileError(
            f"{path}: row {row} has {cell[:40]!r} in column {place + 1}, expected a number"
        ) from error


def _shown(headings: Sequence[str]) -> str:
    return ", ".join(heading[:20] for heading in headings[:6]) or "none"


MEDIAPIPE_TABLE: Final = KeypointFormat(
    (".csv", ".tsv"),
    lambda head: has_no_zero(head) or is_utf16(head),
    read_mediapipe_table,
    is_text=True,
)
"""A spreadsheet may write UTF-16, whose text has zero bytes."""
