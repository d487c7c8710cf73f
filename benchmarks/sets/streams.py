"""Streams: continuous recordings composed of other people's gestures and transitions.

Gestures of a language, out-of-vocabulary gestures and accidental movements follow each other in
random order. Before each one the hands rest beside the body or come straight from the previous
movement; they reach for the starting point with minimum jerk (Flash and Hogan 1985) and pause there
briefly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from app.recognition import PoseSequence
from app.recognition.poses.landmarks import HIPS, SHOULDERS
from app.recognition.poses.sequence import FloatArray
from app.recognition.simulation.background_motion import simulate_background_motion
from benchmarks.sets.recorded_sets import RATE, RecordedSet

TORSO = 200.0
"""Size in pixels to which the median gesture of a set is scaled."""

CENTRE = (320.0, 240.0)
BODY = np.array([[0.33, -0.5], [-0.33, -0.5], [0.2, 0.5], [-0.2, 0.5]])
"""Shoulders and hips in torso lengths from the torso's centre."""

RESTING = {"left": (0.43, 0.6), "right": (-0.43, 0.6)}
"""Places of the wrists when the arms hang."""

IN_FRONT = (-0.5, -0.1)
"""Centre of one-handed gestures; those of both hands are in the middle."""

REACH = (0.5, 1.0)
PAUSE = (0.1, 0.4)
REST = (0.5, 2.5)
"""Seconds, shortest and longest, of the reach, of the pauses around a gesture and of a rest."""

RESTED = 0.6
"""Share of the events before which the hands went down to rest."""

JITTER = 0.004
"""Standard deviation of the landmarks' jitter, in torso lengths."""

KINDS = ("gesture", "foreign", "accidental")
SHARES = (0.4, 0.3, 0.3)


@dataclass(frozen=True)
class Event:
    """An event in a stream from `start` to `end` seconds; `label` None: background motion."""

    kind: str
    label: str | None
    start: float
    end: float


@dataclass(frozen=True, eq=False)
class Stream:
    """A recording, and the truth about it."""

    poses: PoseSequence
    events: tuple[Event, ...]


def with_body(recorded: RecordedSet) -> RecordedSet:
    """Place a set's hands in front of a still torso, all at one scale."""
    widths = [np.ptp(each.xy, axis=0) for each in recorded.recordings]
    extents = [np.linalg.norm(width, axis=1).max() for width in widths]
    scale = TORSO / float(np.median(extents))
    landmarks = (
        *SHOULDERS,
        *HIPS,
        *(_name_wrist(name) for name in recorded.recordings[0].landmarks),
    )
    middle = np.array(IN_FRONT if len(landmarks) == len(BODY) + 1 else (0.0, IN_FRONT[1]))
    recordings = []
    for each in recorded.recordings:
        hands = (each.xy - each.xy.mean(axis=(0, 1))) * scale + middle * TORSO
        body = np.broadcast_to(BODY * TORSO, (len(each), *BODY.shape))
        xy = np.concatenate([body, hands], axis=1) + CENTRE
        recordings.append(replace(each, landmarks=landmarks, xy=xy))
    return replace(recorded, recordings=recordings)


def _name_wrist(name: str) -> str:
    return "left_wrist" if name.startswith("left") else "right_wrist"


def compose(
    recorded: RecordedSet,
    known: Sequence[str],
    people: npt.NDArray[np.bool_],
    events: int,
    random: np.random.Generator,
) -> Stream:
    """Compose a stream of so many events.

    Parameters
    ----------
    recorded
        A set `with_body`.
    known
        Labels of the language; the other classes are foreign.
    people
        ``(N,)``: which recordings may occur.
    events
        How many.
    random
        Source of everything left to chance.

    """
    names = recorded.recordings[0].landmarks[len(BODY) :]
    resting = np.array([RESTING[name.split("_")[0]] for name in names]) * TORSO
    is_known = np.isin(recorded.labels, known)
    accidents = simulate_background_motion(seed=int(random.integers(2**31)))
    parts: list[FloatArray] = [_hold(resting, random.uniform(*REST))]
    truth: list[Event] = []
    for _ in range(events):
        kind = str(random.choice(KINDS, p=SHARES))
        if kind == "accidental":
            movement = accidents[int(random.integers(len(accidents)))].trajectory
            frames = max(2, round(movement.time[-1] * RATE))
            path = movement.select(names).resample_in_time(frames).xy * TORSO
            label = None
        else:
            index = random.choice(np.flatnonzero(people & (is_known == (kind == "gesture"))))
            path = recorded.recordings[index].xy[:, len(BODY) :] - CENTRE
            label = str(recorded.labels[index]) if kind == "gesture" else None
        if random.uniform() < RESTED:
            parts.append(_reach(parts[-1][-1], resting, random.uniform(*REACH)))
            parts.append(_hold(resting, random.uniform(*REST)))
        parts.append(_reach(parts[-1][-1], path[0], random.uniform(*REACH)))
        parts.append(_hold(path[0], random.uniform(*PAUSE)))
        start = sum(map(len, parts)) / RATE
        parts += [path, _hold(path[-1], random.uniform(*PAUSE))]
        truth.append(Event(kind, label, start, start + len(path) / RATE))
    parts += [_reach(parts[-1][-1], resting, 0.7), _hold(resting, 2.0)]
    hands = np.concatenate(parts)
    body = np.broadcast_to(BODY * TORSO, (len(hands), *BODY.shape))
    xy = np.concatenate([body, hands], axis=1)
    xy = xy + random.normal(0, JITTER * TORSO, xy.shape) + CENTRE
    poses = replace(recorded.recordings[0], xy=xy, time=np.arange(len(xy)) / RATE)
    return Stream(poses, tuple(truth))


def _hold(place: FloatArray, seconds: float) -> FloatArray:
    return np.repeat(place[None], max(1, round(seconds * RATE)), axis=0)


def _reach(start: FloatArray, end: FloatArray, seconds: float) -> FloatArray:
    share = np.linspace(0, 1, max(2, round(seconds * RATE)))[:, None, None]
    return start + (end - start) * share**3 * (10 - 15 * share + 6 * share**2)
