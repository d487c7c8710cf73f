"""Column names: find the meaning of a keypoint table's columns by their headings."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

from app.recognition.errors import KeypointFileError
from app.recognition.poses.frame import Side
from app.recognition.poses.landmarks import HAND_LANDMARKS, POSE_LANDMARKS

AXES: Final[Mapping[str, str]] = {
    "x": "x",
    "y": "y",
    "z": "z",
    **dict.fromkeys(("v", "vis", "visibility", "confidence", "score", "likelihood", "c"), "v"),
}
"""Headings of values, with their meaning: x, y, z (not used) or visibility."""

SECONDS: Final = ("time", "timestamp", "seconds", "time_s", "timestamp_s", "sec", "t")
MILLISECONDS: Final = ("timestamp_ms", "time_ms", "milliseconds", "ms")
MICROSECONDS: Final = ("timestamp_us", "time_us", "microseconds", "us")
NANOSECONDS: Final = ("timestamp_ns", "time_ns", "nanoseconds", "ns", "stamp_ns")
FRAMES: Final = ("frame", "frame_number", "frame_num", "frame_idx", "frame_index", "frame_id", "")
"""Headings of frame numbers; the empty one is the first column that pandas writes."""

UNITS: Final = (
    (SECONDS, "s"),
    (MILLISECONDS, "ms"),
    (MICROSECONDS, "us"),
    (NANOSECONDS, "ns"),
    (FRAMES, "frames"),
)
"""Headings of times, with the unit that they mean."""

TIMES: Final = frozenset(name for names, _ in UNITS for name in names)

NAMES: Final = ("landmark", "landmark_name", "landmark_id", "name", "joint", "keypoint", "bodypart")
"""Headings of the landmark's name, in tables with one landmark a row."""

PEOPLE: Final = ("track", "track_id", "track_name", "person", "person_id", "individual")
"""Headings of whose keypoints a row holds, in tables with one person a row."""

MOST_LANDMARKS: Final = 600
"""Most landmarks of a frame: MediaPipe's body, hands and face have 553; a file with more holds
something else."""

FACE: Final = (468, 478)
HANDS: Final = 42
"""Landmarks of MediaPipe's face, without and with irises, and of two hands. In tables that number
them all, those of the body come first."""

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


_HAND: Final = re.compile(
    r"(?:(?P<side>left|right)_?hand|hand_?(?P<after>left|right)|(?P<letter>[lr])h(?:and)?)_?"
    r"(?:landmark|point|kp|keypoint)?_?(?P<name>\d+|[a-z].*)"
)
"""``left_hand_0``, ``hand_right_wrist``, ``lh_20``: a landmark of a hand."""


@dataclass(frozen=True)
class Columns:
    """Places of the values in a row.

    Attributes
    ----------
    points
        Places of x, y and, if the table has it, visibility (``"v"``), by landmark name.
    when
        Place of the time, or None.
    unit
        Unit of the time: ``"s"``, ``"ms"``, ``"us"``, ``"ns"`` or ``"frames"``.
    who
        Place of the person's name or number, or None.
    hands
        Places of the 21 landmarks of a hand, in the order of `HAND_LANDMARKS`, by its side.

    """

    points: Mapping[str, Mapping[str, int]]
    when: int | None
    unit: str
    who: int | None = None
    hands: Mapping[Side, Sequence[Mapping[str, int]]] = field(default_factory=dict)


def columns_of(headings: Sequence[str]) -> Columns:
    """Read the headings of a table with one frame a row; unknown columns are skipped.

    Numbered landmarks are named by `name_numbers`.

    Raises
    ------
    KeypointFileError
        When two columns mean the same.

    """
    points: dict[str, dict[str, int]] = {}
    for place, heading in enumerate(headings):
        text = heading.strip()
        if plain(text) in TIMES:
            continue
        match = next((found for each in _PATTERNS if (found := each.fullmatch(text))), None)
        if match:
            places, axis = points.setdefault(match["name"], {}), AXES[match["axis"].lower()]
            if axis in places:
                raise KeypointFileError(
                    f"the column {headings[places[axis]]!r} stands twice, as {heading!r} in column "
                    f"{place + 1}; keep the right one"
                )
            places[axis] = place
    whole = {name: places for name, places in points.items() if {"x", "y"} <= set(places)}
    when, unit = time_column(headings)
    plainly = [plain(heading) for heading in headings]
    who = next((plainly.index(name) for name in PEOPLE if name in plainly), None)
    hands, rest = _split_hands(whole)
    named = name_numbers(rest)
    return Columns({named[name]: rest[name] for name in named}, when, unit, who, hands)


def time_column(headings: Sequence[str]) -> tuple[int | None, str]:
    """Return the place and unit of the time in a row; seconds are preferred to frame numbers."""
    plainly = [plain(heading) for heading in headings]
    for names, unit in UNITS:
        for name in names:
            if name in plainly:
                return plainly.index(name), unit
    return None, "frames"


def plain(heading: str) -> str:
    """Return a heading in lower case, its words joined by underscores."""
    return re.sub(r"[^a-z0-9]+", "_", heading.strip().lower()).strip("_")


def _split_hands(
    points: Mapping[str, Mapping[str, int]],
) -> tuple[Mapping[Side, Sequence[Mapping[str, int]]], Mapping[str, Mapping[str, int]]]:
    """Return the hands of which all landmarks are given, and all points that are of none."""
    found: dict[Side, dict[str, str]] = {"left": {}, "right": {}}
    for name in points:
        if match := _HAND.fullmatch(plain(name)):
            side = match["side"] or match["after"] or {"l": "left", "r": "right"}[match["letter"]]
            found["left" if side == "left" else "right"][match["name"]] = name
    hands: dict[Side, Sequence[Mapping[str, int]]] = {}
    rest = dict(points)
    for which, named in found.items():
        for order in _HAND_ORDERS:
            if set(order) == set(named):
                hands[which] = [rest.pop(named[each]) for each in order]
    return hands, rest


_HAND_ORDERS: Final = (
    HAND_LANDMARKS,
    *([str(first + each) for each in range(len(HAND_LANDMARKS))] for first in (0, 1)),
)


def name_numbers(names: Iterable[str]) -> dict[str, str]:
    """Return the names of landmarks with those of MediaPipe, in the order of their numbers.

    33 numbered landmarks are MediaPipe's, counted from 0 or from 1, also with its hands and face
    after them; with any other count they keep their numbers as names.
    """
    named = {name: name for name in names}
    numbers = {int(name): name for name in named if name.isdecimal()}
    body = len(POSE_LANDMARKS)
    counts = [body + hands + face for hands in (0, HANDS) for face in (0, *FACE)]
    for first in (0, 1):
        if any(set(numbers) == set(range(first, first + count)) for count in counts):
            named |= {numbers[first + place]: name for place, name in enumerate(POSE_LANDMARKS)}
            return named
    return {numbers[number]: numbers[number] for number in sorted(numbers)} | named
