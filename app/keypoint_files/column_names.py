"""Meaning of the columns of a keypoint table, by their headings."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from app.recognition.poses.landmarks import POSE_LANDMARKS

AXES: Final[Mapping[str, str]] = {
    "x": "x",
    "y": "y",
    "z": "z",
    **dict.fromkeys(("v", "vis", "visibility", "confidence", "score", "likelihood", "c"), "v"),
}
"""Headings of a coordinate, and whether it is x, y, z (not used) or how well the point is seen."""

SECONDS: Final = ("time", "timestamp", "seconds", "time_s", "timestamp_s", "sec", "t")
MILLISECONDS: Final = ("timestamp_ms", "time_ms", "milliseconds", "ms")
FRAMES: Final = ("frame", "frame_number", "frame_num", "frame_idx", "frame_index", "frame_id", "")
"""Headings of when a row is; nameless is the column that pandas writes first."""

NAMES: Final = ("landmark", "landmark_name", "landmark_id", "name", "joint", "keypoint", "bodypart")
"""Headings of which landmark a row is, in tables of one landmark a row."""

MOST_LANDMARKS: Final = 100
"""Of a frame: body, hands and a few more; beyond it a file is of something else."""

_AXIS: Final = "|".join(AXES)
_PATTERNS: Final = (
    re.compile(rf"(?P<axis>{_AXIS})[_. ]?(?P<name>\d+)", re.IGNORECASE),
    re.compile(
        rf"(?:landmark|pose|point|kp|keypoint)?[_. ]?(?P<name>\d+)[_. ]?(?P<axis>{_AXIS})",
        re.IGNORECASE,
    ),
    re.compile(rf"(?P<name>.*[^_. ])[_. ]+(?P<axis>{_AXIS})", re.IGNORECASE),
    re.compile(rf"(?P<axis>{_AXIS})[_. ]+(?P<name>[^_. ].*)", re.IGNORECASE),
)
"""``x0``; ``landmark_0_x``; ``nose_x``; ``x_nose``."""


@dataclass(frozen=True)
class Columns:
    """Where in a row everything stands.

    Attributes
    ----------
    points
        By landmark name the places of x, y and, where the table has it, visibility (``"v"``).
    when
        Place of the time, or None.
    unit
        Of the time: ``"s"``, ``"ms"`` or ``"frames"``.

    """

    points: Mapping[str, Mapping[str, int]]
    when: int | None
    unit: str


def columns_of(headings: Sequence[str]) -> Columns:
    """Read the headings of a table of one frame a row; columns that mean nothing are passed over.

    Numbered landmarks are MediaPipe's 33, counted from 0 or from 1; of any other count they keep
    their numbers as names.
    """
    points: dict[str, dict[str, int]] = {}
    for place, heading in enumerate(headings):
        text = heading.strip()
        if plain(text) in (*SECONDS, *MILLISECONDS, *FRAMES):
            continue
        match = next((found for each in _PATTERNS if (found := each.fullmatch(text))), None)
        if match:
            points.setdefault(match["name"], {})[AXES[match["axis"].lower()]] = place
    whole = {name: places for name, places in points.items() if {"x", "y"} <= set(places)}
    when, unit = time_column(headings)
    return Columns(_number_points(whole), when, unit)


def time_column(headings: Sequence[str]) -> tuple[int | None, str]:
    """Return where the time of a row stands, and its unit; seconds go before frame numbers."""
    plainly = [plain(heading) for heading in headings]
    for names, unit in ((SECONDS, "s"), (MILLISECONDS, "ms"), (FRAMES, "frames")):
        for name in names:
            if name in plainly:
                return plainly.index(name), unit
    return None, "frames"


def plain(heading: str) -> str:
    """Return a heading in lower case, its words joined by underscores."""
    return re.sub(r"[^a-z0-9]+", "_", heading.strip().lower()).strip("_")


def numbered_landmark(name: str, first: int = 0) -> str:
    """Return MediaPipe's landmark of a number; any other name as it is."""
    if name.isdigit() and 0 <= int(name) - first < len(POSE_LANDMARKS):
        return POSE_LANDMARKS[int(name) - first]
    return name


def _number_points(points: Mapping[str, Mapping[str, int]]) -> Mapping[str, Mapping[str, int]]:
    numbers = {int(name) for name in points if name.isdigit()}
    for first in (0, 1):
        if numbers == set(range(first, first + len(POSE_LANDMARKS))) and len(points) == len(
            numbers
        ):
            return {numbered_landmark(name, first): places for name, places in points.items()}
    return points
