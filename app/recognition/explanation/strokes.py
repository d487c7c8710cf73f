"""Strokes: a movement in words, such as "down right, up right, left".

The path of each moving hand is split where the hand stops or turns sharply, as the trimming splits
it, and where its curve changes its sense. A piece is a straight line in one of eight directions,
an arc or a loop with its sense, or, if it is not clearly one of these, "a curve". Directions are
those of the picture.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Final, Literal

import numpy as np
from pydantic import computed_field

from app.recognition.decision.result import WRITTEN
from app.recognition.features.motion import parse_body_part
from app.recognition.gestures.gesture import Gesture
from app.recognition.poses.landmarks import TORSO
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.recording.trimming import (
    GRID_STEP,
    Motion,
    measure_extent,
    measure_motion,
    split_pieces,
)

DIRECTIONS: Final = (
    "right",
    "down right",
    "down",
    "down left",
    "left",
    "up left",
    "up",
    "up right",
)
"""Directions in steps of an eighth of a turn, from the x axis, x to the right, y down."""

MOST_MOMENTS: Final = 2400
"""Most moments at which a path is followed: 40 s."""

STEP: Final = 1 / 48
"""Step along a path at which it is followed, as a share of the diagonal of its extent."""

SHORTEST: Final = 6
"""Least steps of a piece, an eighth of the extent: less is a wiggle."""

CORNER: Final = math.radians(60)
"""Least turn within `BEND` steps that is a corner."""

BEND: Final = 5

REVERSAL: Final = math.radians(50)
"""Least turn back by which a curve changes its sense."""

STRAIGHT: Final = math.radians(55)
"""Turn from which only a piece as direct as `NEARLY` is a line; arcs of 63 degrees are."""

DIRECT: Final = 0.9
"""Least ratio of distance to path of a straight line."""

NEARLY: Final = 0.95
"""Least such ratio of a straight line whose ends are bent, by a rounded corner."""

LOOP: Final = math.radians(270)
"""Least turn of a loop."""

CLOSED_LOOP: Final = math.radians(225)
"""Least turn of a loop whose ends meet."""

MEETS: Final = 0.06
"""Largest distance at which a path meets itself, as a share of its extent."""

MOST_STEPS: Final = 480
"""Most steps of a path in which a meeting is sought: ten extents."""

CLOSED: Final = 0.3
"""Largest ratio of distance to path of a loop that does not turn so far."""

VAGUE: Final = 0.5
"""Ratio of distance to path below which a curve leads nowhere."""

PAUSE_SECONDS: Final = 0.5
"""Shortest pause that is told."""

OTHER_HAND: Final = 0.4
"""Least extent of a hand's path, as a share of the larger one, that counts as moving too."""

LEAST_MOVING: Final = 0.15
"""Least extent of a movement in torso lengths: 8 cm; a held hand drifts less."""

PieceKind = Literal["line", "arc", "loop", "curve", "pause"]


@dataclass(frozen=True, kw_only=True)
class Piece:
    """One stroke of a hand.

    Attributes
    ----------
    kind
        What it is.
    hand
        The landmark that draws it.
    direction
        Degrees from its start to its end, 0 to the right, 90 down; None of loops, pauses, and
        curves that end near their start.
    turn
        Degrees that it turns, positive: clockwise in the picture; 0 of lines and pauses.
    start, end
        Seconds.

    """

    __pydantic_config__ = WRITTEN

    kind: PieceKind
    hand: str
    direction: float | None
    turn: float
    start: float
    end: float

    @computed_field  # type: ignore[prop-decorator]
    @property
    def words(self) -> str:
        """The piece in words."""
        sense = "clockwise" if self.turn > 0 else "anticlockwise"
        match self.kind:
            case "line":
                return self._way
            case "arc":
                return f"{sense} arc {self._way}"
            case "loop":
                turns = max(1, round(abs(self.turn) / 360))
                return f"{sense} loop" if turns == 1 else f"{turns} {sense} loops"
            case "curve":
                return "a curve" if self.direction is None else f"a curve {self._way}"
            case _:
                return "a pause"

    @property
    def _way(self) -> str:
        assert self.direction is not None
        return DIRECTIONS[round(self.direction / 45) % 8]

    def differs(self, other: Piece) -> bool:
        """Return whether two pieces are clearly not the same stroke."""
        if "curve" in (self.kind, other.kind):
            return "pause" in (self.kind, other.kind)
        if self.kind != other.kind and not {self.kind, other.kind} <= {"line", "arc"}:
            return {self.kind, other.kind} != {"arc", "loop"} or self.turn * other.turn < 0
        if self.kind == "loop":
            return self.turn * other.turn < 0 or round(self.turn / 360) != round(other.turn / 360)
        if self.direction is None or other.direction is None:
            return False
        octants = round(self.direction / 45) - round(other.direction / 45)
        bent = self.kind == other.kind == "arc" and self.turn * other.turn < 0
        return bent or 2 <= octants % 8 <= 6


def transcribe(
    trajectory: Trajectory, salient: Sequence[str] = (), start: float = 0.0
) -> tuple[Piece, ...]:
    """Return the strokes of a movement.

    Parameters
    ----------
    trajectory
        The movement.
    salient
        The landmarks among which the drawing hands are sought; all when not given.
    start
        Second of the clock at which it begins.

    Returns
    -------
    The pieces in their order, one hand after the other; empty where nothing moves. Scale, place and
    clock change nothing but the times.

    """
    drawing = find_drawing_landmarks(trajectory, salient)
    return tuple(piece for name in drawing for piece in _follow(trajectory, name, start))


@lru_cache(1024)
def transcribe_gesture(gesture: Gesture) -> tuple[Piece, ...]:
    """Return the strokes of a gesture's first demonstration; empty for held hand shapes."""
    if gesture.is_held or gesture.trajectory is None or len(gesture.trajectory) < 2:
        return ()
    return transcribe(gesture.trajectory, gesture.salient)


def find_drawing_landmarks(trajectory: Trajectory, salient: Sequence[str] = ()) -> tuple[str, ...]:
    """Return the landmarks that draw: of each moving arm its wrist, or what moves most."""
    parts = {name: parse_body_part(name) for name in trajectory.landmarks}
    names = [name for name in salient or parts if name in parts and name != TORSO]
    arms = {parts[name].partition("_")[0] for name in names}
    wrists = [
        name
        for name, part in parts.items()
        if part.endswith("wrist") and part.partition("_")[0] in arms
    ]
    paths = dict(zip(trajectory.landmarks, np.moveaxis(trajectory.xy, 1, 0), strict=True))
    extents = {name: measure_extent(paths[name]) for name in wrists or names}
    most = max(extents.values(), default=0.0)
    least = OTHER_HAND * most if wrists else most
    return tuple(name for name in extents if extents[name] >= least and most > LEAST_MOVING)


def _follow(trajectory: Trajectory, name: str, start: float) -> list[Piece]:
    """Return the pieces of one landmark's path."""
    count = min(MOST_MOMENTS, math.ceil(float(trajectory.time[-1]) / GRID_STEP) + 1)
    even = trajectory.select([name]).resample_in_time(max(count, 16))
    # In extents, so that a small movement is split as a large one.
    path = even.xy[:, 0] / max(measure_extent(even.xy[:, 0]), 1e-12)
    motion = measure_motion([path], even.time)
    parts = [] if motion is None else _list_runs(motion)
    found: list[Piece] = []
    for part in parts:
        here = part.name(name, start)
        before = found[-1] if found else here
        if here.start - before.end >= PAUSE_SECONDS:
            pause = replace(here, kind="pause", direction=None, turn=0.0)
            found.append(replace(pause, start=before.end, end=here.start))
        elif found and before.kind == here.kind == "line" and before.words == here.words:
            here = replace(here, start=found.pop().start)
        found.append(here)
    return found


def _list_runs(motion: Motion) -> list[_Run]:
    """Return the pieces of a path between its corners and changes of sense; loops stay whole."""
    pieces = [slice(piece.first, piece.last + 1) for piece in split_pieces(motion)]
    runs = [_Run.of(motion.xy[each], motion.time[each]) for each in pieces]
    whole = _join([run for run in runs if run is not None], _Run.continues)
    parts = [part for run in whole for part in run.split()]
    return _join([part for part in parts if len(part.xy) > SHORTEST] or parts[:1], _Run.closes)


def _join(runs: Sequence[_Run], belongs: Callable[[_Run, _Run], bool]) -> list[_Run]:
    """Join each run with the one before it where it belongs to that one."""
    found: list[_Run] = []
    for run in runs:
        found.append(found.pop().join(run) if found and belongs(run, found[-1]) else run)
    return found


@dataclass(frozen=True, eq=False)
class _Run:
    """A path at equal steps ``(N, 2)`` and the seconds ``(N,)`` at which each was reached."""

    xy: FloatArray
    time: FloatArray

    @classmethod
    def of(cls, xy: FloatArray, time: FloatArray) -> _Run | None:
        """Follow a path at steps of `STEP`; None where it is shorter than one."""
        way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(xy, axis=0), axis=1))])
        if way[-1] < STEP:
            return None
        even = np.linspace(0, way[-1], round(way[-1] / STEP) + 1)
        at = [np.interp(even, way, column) for column in (*xy.T, time)]
        return cls(np.stack(at[:2], axis=1), at[2])

    @property
    def headings(self) -> FloatArray:
        """``(N - 1,)`` radians of each step, without jumps by a full turn."""
        steps = np.diff(self.xy, axis=0)
        return np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))

    def continues(self, before: _Run) -> bool:
        """Return whether this run goes on where, when and as another one ended: no corner."""
        last, first = before.headings[-BEND:], self.headings[:BEND]
        turn = (float(first.mean() - last.mean()) + math.pi) % (2 * math.pi) - math.pi
        return abs(turn) < CORNER and self.time[0] - before.time[-1] < PAUSE_SECONDS

    def closes(self, before: _Run) -> bool:
        """Return whether this run and the one before it are the two halves of a loop."""
        bent = all(STRAIGHT <= abs(run.turn) < LOOP for run in (before, self))
        follows = self.time[0] - before.time[-1] < PAUSE_SECONDS
        whole = before.join(self)
        return bent and follows and abs(whole.turn) >= CLOSED_LOOP and whole.direct < CLOSED

    @property
    def turn(self) -> float:
        """Radians that it turns, positive: clockwise."""
        headings = self.headings
        return float(headings[-2:].mean() - headings[:2].mean()) if len(headings) > 3 else 0.0

    @property
    def is_one_way(self) -> bool:
        """Whether it turns mostly in one sense."""
        turns = np.diff(self.headings)
        return bool(abs(turns.sum()) >= 0.6 * np.abs(turns).sum())

    @property
    def direct(self) -> float:
        """Distance from its start to its end over its length."""
        way = float(np.linalg.norm(np.diff(self.xy, axis=0), axis=1).sum())
        return float(np.linalg.norm(self.xy[-1] - self.xy[0])) / max(way, 1e-12)

    def join(self, after: _Run) -> _Run:
        """Return both as one."""
        return _Run(np.concatenate([self.xy, after.xy]), np.concatenate([self.time, after.time]))

    def between(self, first: int, last: int) -> _Run:
        """Keep the steps from first to last."""
        return _Run(self.xy[first : last + 1], self.time[first : last + 1])

    def split(self) -> list[_Run]:
        """Split around a loop, at corners, and where the curve turns the other way."""
        corners, end = self._find_corners(), len(self.xy) - 1
        if loop := self._find_loop(corners):
            first, last = loop
            before, after = self.between(0, first), self.between(last, end)
            return [*before.split(), self.between(first, last), *after.split()]
        parts = [self.between(a, b) for a, b in itertools.pairwise([0, *corners, end])]
        return [bent for part in parts for bent in part._split_bends()]

    def _find_loop(self, corners: Sequence[int]) -> tuple[int, int] | None:
        """Return between which points the path meets itself best, around a loop."""
        is_turning_on = not corners and abs(self.turn) >= 3 * math.pi and self.is_one_way
        if is_turning_on or len(self.xy) > MOST_STEPS:
            return None
        gaps = np.linalg.norm(self.xy[:, None] - self.xy, axis=2)
        first, last = np.nonzero(np.triu(gaps < MEETS, SHORTEST + BEND // 2))
        for at in np.argsort(gaps[first, last], kind="stable"):
            loop = int(first[at]), int(last[at])
            inside = any(loop[0] + BEND // 2 < corner < loop[1] - BEND // 2 for corner in corners)
            run = self.between(*loop)
            if not inside and abs(run.turn) >= CLOSED_LOOP and run.is_one_way:
                return loop
        return None

    def _find_corners(self) -> list[int]:
        """Return the points at which the path turns by `CORNER` within `BEND` steps."""
        headings = self.headings
        if len(headings) <= 2 * BEND:
            return []
        # The direction after a point, over as many steps, minus that before it.
        window = np.convolve(headings, np.ones(BEND) / BEND, mode="valid")
        turns = np.abs(window[BEND:] - window[:-BEND])
        corners = []
        while turns.max(initial=0.0) >= CORNER:
            at = int(turns.argmax())
            corners.append(at + BEND)
            turns[max(0, at - 2 * BEND + 1) : at + 2 * BEND] = 0
        return sorted(corners)

    def _split_bends(self) -> list[_Run]:
        """Split where the sense of the curve changes by more than `REVERSAL`."""
        headings = self.headings.tolist()
        cuts, sense, farthest = [0], 0, {-1: 0, 1: 0}
        for at, heading in enumerate(headings):
            for way in (-1, 1):
                back = way * (headings[farthest[way]] - heading)
                if back < 0:
                    farthest[way] = at
                elif back > REVERSAL and sense != -way:
                    cuts += [farthest[way]] * (sense == way)
                    sense, farthest = -way, {-1: at, 1: at}
        cuts.append(len(self.xy) - 1)
        return [self.between(a, b) for a, b in itertools.pairwise(cuts) if b > a]

    def name(self, hand: str, start: float) -> Piece:
        """Return the run as a piece."""
        turn, chord = self.turn, self.xy[-1] - self.xy[0]
        is_bent = abs(turn) >= STRAIGHT and self.is_one_way
        kind: PieceKind = "curve"
        if abs(turn) >= LOOP or (is_bent and self.direct < CLOSED):
            kind = "loop"
        elif self.direct >= (DIRECT if abs(turn) < STRAIGHT else NEARLY):
            kind = "line"
        elif is_bent:
            kind = "arc"
        vague = kind == "loop" or (kind == "curve" and self.direct < VAGUE)
        return Piece(
            kind=kind,
            hand=hand,
            direction=None if vague else math.degrees(math.atan2(chord[1], chord[0])),
            turn=0.0 if kind == "line" else math.degrees(turn),
            start=start + float(self.time[0]),
            end=start + float(self.time[-1]),
        )
