"""Movements with known answer: a diver who salutes, reaches, draws and returns, as landmarks.

Hands move with minimum jerk from rest to rest (Flash and Hogan 1985).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.recognition.poses.landmarks import HIPS, SHOULDERS
from app.recognition.poses.sequence import FloatArray, PoseSequence

LANDMARKS = (*SHOULDERS, *HIPS, "left_wrist", "right_wrist")
SALUTE_PLACE = np.array([-0.95, -0.8])
"""Place of the right wrist, beside the head, in torso lengths from the torso's centre, y down."""
RESTING_PLACE = np.array([0.6, 0.5])
"""Place of the left wrist, beside the thigh."""
TORSO = 100.0
"""Pixels."""


@dataclass(frozen=True, eq=False)
class Movement:
    """Where a hand goes next, and how long it takes.

    Attributes
    ----------
    path
        ``(N, 2)`` corners in torso lengths, or ``(2,)`` for a straight line to that place, or to
        stay there.
    seconds
        How long it takes.

    """

    path: FloatArray
    seconds: float


@dataclass(frozen=True, eq=False)
class Performance:
    """A recording with the moments known at which everything happened.

    Attributes
    ----------
    poses
        From the beginning of the first salute to the end of the last.
    moments
        Seconds at which the movements ended, the first entry is the beginning.

    """

    poses: PoseSequence
    moments: tuple[float, ...]


def minimum_jerk(share: FloatArray) -> FloatArray:
    """Map shares of time to shares of way."""
    way: FloatArray = share**3 * (10 - 15 * share + 6 * share**2)
    return way


def still(place: FloatArray, seconds: float) -> Movement:
    """Return a movement that stays in place."""
    return Movement(place, seconds)


def perform(
    right: Sequence[Movement],
    left: Sequence[Movement] = (),
    *,
    rate: float = 25.0,
    noise: float = 0.0,
    seed: int = 0,
) -> Performance:
    """Record hands that make the given movements one after the other.

    Parameters
    ----------
    right, left
        From `SALUTE_PLACE` and `RESTING_PLACE` on; the left hand rests where it has none.
    rate
        Frames a second.
    noise
        Standard deviation of the landmarks' error in torso lengths.

    """
    moments = np.concatenate([[0.0], np.cumsum([move.seconds for move in right])])
    time = np.arange(0, moments[-1], 1 / rate)
    random = np.random.default_rng(seed)
    xy = np.empty((len(time), len(LANDMARKS), 2))
    xy[:, :4] = [[0.35, -0.5], [-0.35, -0.5], [0.2, 0.5], [-0.2, 0.5]]
    xy[:, 4] = _followed(RESTING_PLACE, left, time)
    xy[:, 5] = _followed(SALUTE_PLACE, right, time)
    xy += random.normal(0, noise, xy.shape)
    return Performance(
        PoseSequence(landmarks=LANDMARKS, xy=320 + TORSO * xy, time=time, frame_size=(640, 640)),
        tuple(moments.tolist()),
    )


def _followed(place: FloatArray, movements: Sequence[Movement], time: FloatArray) -> FloatArray:
    """Return ``(T, 2)``: where a hand is that starts at `place`."""
    followed = np.tile(place, (len(time), 1))
    begin = 0.0
    for movement in movements:
        if movement.seconds == 0:
            continue
        corners = np.vstack([place, np.atleast_2d(movement.path)])
        steps = np.linalg.norm(np.diff(corners, axis=0), axis=1)
        way = np.concatenate([[0], np.cumsum(steps)])
        share = np.clip((time - begin) / movement.seconds, 0, 1)
        reached = minimum_jerk(share) * way[-1]
        now = time >= begin
        for axis in range(2):
            followed[now, axis] = np.interp(reached[now], way, corners[:, axis])
        place, begin = corners[-1], begin + movement.seconds
    return followed


def circle(start: FloatArray, radius: float = 0.45) -> FloatArray:
    """Corners of a circle that begins and ends at its top, `start`."""
    angle = np.linspace(0, 2 * np.pi, 90)
    return start + radius * np.stack([np.sin(angle), 1 - np.cos(angle)], axis=1)
