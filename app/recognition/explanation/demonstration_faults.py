"""Demonstration faults: what is wrong with a demonstration, seen where it is made.

A gesture is as good as its one demonstration. From the recording and the range that it was saved
from is seen whether the range holds a salute, a rest or the ways from and to the salutes, whether
keypoints jump or are missing in the stroke, whether another body was read, and whether the hand
whose shape counts is seen.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Final, Literal

import numpy as np

from app.recognition.poses.landmarks import WRISTS
from app.recognition.poses.sequence import FloatArray, PoseSequence, fill_all_gaps
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.moving_hands import find_moving_hands, list_moving_sides
from app.recognition.preprocessing.outliers import find_other_body, find_unsteady
from app.recognition.preprocessing.repair import repair_poses
from app.recognition.preprocessing.salience import find_salient_landmarks
from app.recognition.recording.clip_range import find_clip_range
from app.recognition.recording.recording import Recording
from app.recognition.recording.salute import FEW_HANDS, HOLD_SECONDS, find_held
from app.recognition.recording.segmentation import Bracket, find_brackets, takes_in
from app.recognition.recording.trimming import measure_extent
from app.recognition.triggers.trigger import POSE_SECONDS, SALUTE, Trigger

Remedy = Literal["set_range", "show_again", "arm_trigger"]
"""What mends a fault: another range of the clip, another take, or a trigger of the arms."""

LEAST_OVERLAP = 0.1
"""Least seconds of a trigger in a range for it to count as contained, because the ends of a take
touch its triggers."""

WINDOW_SECONDS = 0.2
"""Step at which a wrist's speed is measured to find rests: longer than jitter of the pose model,
shorter than any rest that matters."""

RESTING_SPEED = 0.1
"""Share of the highest speed below which the wrists rest: above sway in water."""

CUT_SHARE = 0.2
"""Missing share of a stroke from which a demonstration counts as cut short: the rest is another
gesture."""

REST_SHARE = 1 / 3
"""Share of rest before and after the movement from which it counts as a fault of a demonstration:
divers' tempos differ by less than a third of the duration."""

LEAST_REST = 0.5
"""Shortest rest that counts, in seconds; a hand stops for less between two strokes."""

AT_SALUTE = 0.15
"""Seconds of a salute within which a stroke that begins or ends still holds the way from it."""

LONGEST_WAY = 1.3
"""Most seconds of a way from or to a salute; in water it takes 0.5 to 1 s."""

LEAST_WAY = 0.1
"""Least torso lengths of such a way; a gesture that begins nearer has none."""

STRAIGHT = 0.75
"""Least ratio of distance to path of such a way."""

SLOWED = 0.5
"""Speed at its end, as a share of its highest speed: the hand stops or turns there."""

MOST_UNSTEADY = 0.03
"""Largest share of a stroke's moments at which keypoints may jump or another body may be read."""

MOST_REPAIRED = 0.25
"""Largest share of a stroke's frames that may have been repaired."""

LEAST_FOLLOWED = 0.8
"""Least share of a stroke's frames in which each salient keypoint is seen."""


class FaultKind(str, Enum):
    """What is wrong with a demonstration, the gravest first, and that as a clause about it."""

    told: str

    def __new__(cls, value: str, told: str) -> FaultKind:
        """Return the kind of that value."""
        made = str.__new__(cls, value)
        made._value_, made.told = value, told
        return made

    whole_clip = "whole_clip", "is the whole clip, with its salutes"
    contains_salute = "contains_salute", "contains a salute"
    reaches_salute = "reaches_salute", "still holds the way from the salute"
    cut_short = "cut_short", "is cut short"
    contains_rest = "contains_rest", "contains rest before or after the gesture"
    other_person = "other_person", "shows another person's body for a while"
    keypoints_jumped = "keypoints_jumped", "has keypoints that jump"
    keypoints_missing = "keypoints_missing", "has a keypoint that is often not seen"
    no_hand = "no_hand", "shows no hand, but hands count"


REMEDIES: Final[dict[Remedy, str]] = {
    "set_range": "Set its range.",
    "show_again": "Show it again.",
    "arm_trigger": "Use the arm trigger.",
}


@dataclass(frozen=True, kw_only=True)
class DemonstrationFault:
    """One fault of a demonstration.

    Attributes
    ----------
    kind
        See `FaultKind`.
    words
        The fault as a clause after "it", with the numbers seen.
    remedy
        What mends it.
    start, end
        Seconds of the clip of a better range; None where none is known.

    """

    kind: FaultKind
    words: str
    remedy: Remedy = "show_again"
    start: float | None = None
    end: float | None = None

    def describe(self, label: str) -> str:
        """Return fault and remedy in one sentence and a half, at most fifteen words."""
        return f"The demonstration of {label!r} {self.kind.told}. {REMEDIES[self.remedy]}"


@dataclass(frozen=True)
class ClipOutline:
    """The parts of a clip, in seconds.

    Attributes
    ----------
    triggers
        The held triggers.
    strokes
        The gesture of each take, without transit.
    start, end
        First and last frame.
    moving
        First and last moment at which a wrist moves.

    """

    triggers: tuple[tuple[float, float], ...]
    strokes: tuple[tuple[float, float], ...]
    start: float
    end: float
    moving: tuple[float, float]

    @classmethod
    def of(cls, recording: Recording, trigger: Trigger = SALUTE) -> ClipOutline:
        """Return the parts of a recording."""
        time = recording.poses.time
        scores = np.maximum(*trigger.score(recording.poses, recording.salute))
        hold = POSE_SECONDS if trigger.start else HOLD_SECONDS
        return cls(
            triggers=find_held(time, scores, hold),
            strokes=tuple(
                (take.stroke_start, take.stroke_end)
                for take in takes_in(recording, trigger=trigger)
            ),
            start=float(time[0]),
            end=float(time[-1]),
            moving=_find_movement(recording.poses),
        )

    def count_triggers(self, start: float, end: float) -> int:
        """Return how many triggers a range of seconds contains, wholly or in part."""
        return sum(min(b, end) - max(a, start) >= LEAST_OVERLAP for a, b in self.triggers)


def describe_count(trigger: Trigger, count: int) -> str:
    """Return a number of a language's triggers in words, such as "a Vulcan salute"."""
    if trigger.kind == "pose":
        return "a trigger's pose of the arms" if count == 1 else f"{count} of the trigger's poses"
    return "a Vulcan salute" if count == 1 else f"{count} Vulcan salutes"


def find_demonstration_faults(
    recording: Recording,
    start: float | None = None,
    end: float | None = None,
    *,
    outline: ClipOutline | None = None,
    trigger: Trigger = SALUTE,
    keep_transit: bool = False,
    salient: Sequence[str] = (),
    hand_counts: bool = False,
) -> tuple[DemonstrationFault, ...]:
    """Find what is wrong with a range of a recording as a demonstration.

    Parameters
    ----------
    recording
        Of the clip.
    start, end
        Seconds, as for `find_clip_range`.
    outline
        The parts of the recording, if they are known already.
    trigger, keep_transit
        As for `find_clip_range`.
    salient
        The gesture's salient landmarks; by default those of the stroke.
    hand_counts
        Whether the gesture's hand shape counts.

    Returns
    -------
    The faults, the gravest first; empty for a good demonstration.

    """
    shown = find_clip_range(recording, start, end, keep_transit=keep_transit, trigger=trigger)
    parts = outline or ClipOutline.of(recording, trigger)
    brackets = find_brackets(recording, trigger)
    first, last = shown.start, shown.end
    found = [
        *find_range_faults(parts, first, last, trigger),
        *_find_ways(recording.poses, brackets, first, last),
        *_find_keypoint_faults(shown.poses, salient, hand_counts=hand_counts),
    ]
    with_hand = sum(map(bool, recording.hands))
    if trigger.kind == "salute" and not brackets and with_hand < FEW_HANDS * len(recording.hands):
        words = f"shows a hand in {with_hand} of {len(recording.hands)} frames of its clip"
        found.append(DemonstrationFault(kind=FaultKind.no_hand, words=words, remedy="arm_trigger"))
    once = {fault.kind: fault for fault in reversed(found)}
    return tuple(once[kind] for kind in FaultKind if kind in once)


def find_range_faults(
    outline: ClipOutline, start: float, end: float, trigger: Trigger = SALUTE
) -> Iterator[DemonstrationFault]:
    """Yield the fault of a range of a clip with these parts: triggers, a part missing, or rest."""
    better = _propose_range(outline, start, end)
    if triggers := outline.count_triggers(start, end):
        contained = describe_count(trigger, triggers)
        whole = start <= outline.start + LEAST_REST and end >= outline.end - LEAST_REST
        kind = FaultKind.whole_clip if whole else FaultKind.contains_salute
        words = f"is the whole clip, with {contained}" if whole else f"contains {contained}"
        yield _fault_of_range(kind, words, better)
        return
    for first, last in outline.strokes:
        kept = min(end, last) - max(start, first)
        if 0 < kept < (1 - CUT_SHARE) * (last - first):
            words = f"is cut short: it keeps {kept:.1f} of {last - first:.1f} s of the stroke"
            yield _fault_of_range(FaultKind.cut_short, words, (first, last))
            return
    rest = max(0.0, outline.moving[0] - start) + max(0.0, end - outline.moving[1])
    if rest >= max(LEAST_REST, REST_SHARE * (end - start)):
        words = f"contains {rest:.1f} s of rest before and after the gesture"
        moving = max(start, outline.moving[0]), min(end, outline.moving[1])
        yield _fault_of_range(FaultKind.contains_rest, words, moving)


def _fault_of_range(
    kind: FaultKind, words: str, better: tuple[float, float] | None
) -> DemonstrationFault:
    first, last = better or (None, None)
    return DemonstrationFault(kind=kind, words=words, remedy="set_range", start=first, end=last)


def _propose_range(outline: ClipOutline, start: float, end: float) -> tuple[float, float] | None:
    """Return the stroke that a range overlaps most; None without one."""
    overlaps = [(min(end, b) - max(start, a), (a, b)) for a, b in outline.strokes]
    overlap, stroke = max(overlaps, default=(0.0, (0.0, 0.0)))
    return stroke if overlap > 0 else None


def _find_ways(
    poses: PoseSequence, brackets: Sequence[Bracket], start: float, end: float
) -> Iterator[DemonstrationFault]:
    """Yield a fault if a stroke reaches from one salute to the other, with a way at either end."""
    for bracket in brackets:
        ends = (start - bracket.start, bracket.end - end)
        if bracket.closing is None or max(map(abs, ends)) > AT_SALUTE:
            continue
        repair = repair_poses(poses.between(start, end))
        if not repair.poses.seen.any() or repair.trajectory.unit != "torso_length":
            continue
        stroke, time = repair.trajectory, repair.trajectory.time
        first = _measure_way(stroke.xy, time, stroke.landmarks)
        last = _measure_way(stroke.xy[::-1], time[-1] - time[::-1], stroke.landmarks)
        if first is None or last is None or time[-1] - last - first < LEAST_REST:
            continue
        better = repair.poses.time[0] + first, repair.poses.time[-1] - last
        words = (
            f"reaches from salute to salute: {better[0] - start:.1f} s of the way from the first "
            f"and {end - better[1]:.1f} s of the way to the second are in it"
        )
        yield _fault_of_range(FaultKind.reaches_salute, words, better)


def _measure_way(xy: FloatArray, time: FloatArray, landmarks: Sequence[str]) -> float | None:
    """Return after how many seconds the way from a salute ends; None where there is none.

    The way of the wrist that moves more is straight, and the hand stops or turns at its end.
    """
    grid = np.arange(0.0, float(time[-1]), WINDOW_SECONDS / 4)
    paths = _follow_wrists(xy, time, landmarks, grid)
    if len(grid) < FEWEST_MOMENTS or not paths:
        return None
    path = max(paths, key=measure_extent)
    speed = np.linalg.norm(np.gradient(path, axis=0), axis=1)
    speed = np.convolve(np.pad(speed, 1, mode="edge"), np.ones(3) / 3, mode="valid")
    far = np.linalg.norm(path - path[0], axis=1)
    slow = (speed <= SLOWED * np.maximum.accumulate(speed)) & (far >= LEAST_WAY)
    slow[1:-1] &= (speed[1:-1] <= speed[:-2]) & (speed[1:-1] <= speed[2:])
    ends = np.flatnonzero(slow[2:-2] & (grid[2:-2] <= LONGEST_WAY)) + 2
    if not len(ends):
        return None
    way = float(np.linalg.norm(np.diff(path[: ends[0] + 1], axis=0), axis=1).sum())
    return None if far[ends[0]] < STRAIGHT * way else float(grid[ends[0]])


FEWEST_MOMENTS = 8
"""Least moments, 0.05 s apart, of a stroke in which ways are sought."""


def _follow_wrists(
    xy: FloatArray, time: FloatArray, landmarks: Sequence[str], grid: FloatArray
) -> list[FloatArray]:
    """Return the paths ``(G, 2)`` of the wrists that are seen, at the moments of a grid."""
    wrists = [landmarks.index(name) for name in WRISTS if name in landmarks]
    paths = np.moveaxis(fill_all_gaps(xy[:, wrists], time, grid), 1, 0)
    return [path for path in paths if np.isfinite(path).all()]


def _find_keypoint_faults(
    stroke: PoseSequence, salient: Sequence[str], *, hand_counts: bool
) -> Iterator[DemonstrationFault]:
    """Yield faults of the keypoints in a stroke."""
    if not stroke.seen.any():
        return
    repair = repair_poses(stroke)
    raw, trajectory = Trajectory.from_poses(stroke), repair.trajectory
    names = tuple(salient) or find_salient_landmarks(trajectory)
    count = len(stroke)
    columns = [stroke.landmarks.index(name) for name in names if name in stroke.landmarks]
    other = int(np.count_nonzero(find_other_body(raw)))
    away = int(np.count_nonzero(find_unsteady(trajectory, names)))
    repaired = int(np.count_nonzero(repair.exchanged | repair.jumps[:, columns].any(axis=1)))
    seen = float(stroke.seen[:, columns].mean(axis=0).min(initial=1.0))
    if other > MOST_UNSTEADY * count:
        words = f"shows another body in at least {other} of {count} frames"
        yield DemonstrationFault(kind=FaultKind.other_person, words=words)
    if away > MOST_UNSTEADY * count or repaired > MOST_REPAIRED * count:
        words = f"has keypoints that jump in {max(away, repaired)} of {count} frames"
        yield DemonstrationFault(kind=FaultKind.keypoints_jumped, words=words)
    if seen < LEAST_FOLLOWED:
        words = f"shows a keypoint that it needs in {seen:.0%} of its frames"
        yield DemonstrationFault(kind=FaultKind.keypoints_missing, words=words)
    if hand_counts and not find_moving_hands(repair.poses, list_moving_sides(names)):
        words = "shows no hand for long enough, although its hand shape counts"
        yield DemonstrationFault(kind=FaultKind.no_hand, words=words)


def _find_movement(poses: PoseSequence) -> tuple[float, float]:
    """Return the first and the last moment at which a wrist moves; the whole clip if none does."""
    time = poses.time
    grid = np.arange(float(time[0]), float(time[-1]), WINDOW_SECONDS)
    paths = _follow_wrists(poses.xy, time, poses.landmarks, grid)
    if not paths or len(grid) < 3:
        return float(time[0]), float(time[-1])
    speed = np.max([np.hypot(*np.diff(path, axis=0).T) for path in paths], axis=0)
    moving = np.flatnonzero(speed > RESTING_SPEED * speed.max())
    if not len(moving):
        return float(time[0]), float(time[-1])
    return float(grid[moving[0]]), float(grid[moving[-1] + 1])
