"""Drawn sets: simulated movements that differ only in their direction.

Ten simulated people draw with the right wrist before a still torso: each has a size, a slant, an
aspect and a tempo of its own, and every take wavers a little.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from app.recognition import PoseSequence
from app.recognition.poses.sequence import FloatArray
from benchmarks.sets.recorded_sets import RecordedSet

PEOPLE = 10
TAKES = 10
Figure = Callable[[FloatArray, np.random.Generator], FloatArray]
"""Maps shares of the way ``(T,)`` to points ``(T, 2)`` about a size of 1, x right, y down."""


def clockwise(share: FloatArray, random: np.random.Generator) -> FloatArray:
    """Begin within a quarter of the top, as people do."""
    angle = 2 * np.pi * share + random.uniform(-np.pi / 4, np.pi / 4)
    return np.stack([np.sin(angle), -np.cos(angle)], axis=1) / 2


def counter_clockwise(share: FloatArray, random: np.random.Generator) -> FloatArray:
    """Mirror `clockwise`."""
    return clockwise(share, random) * (-1, 1)


def to_the_right(share: FloatArray, random: np.random.Generator) -> FloatArray:
    """Swipe along a shallow arc."""
    return np.stack([share - 0.5, random.uniform(-0.3, 0.3) * share * (1 - share)], axis=1)


def to_the_left(share: FloatArray, random: np.random.Generator) -> FloatArray:
    """Mirror `to_the_right`."""
    return to_the_right(share, random) * (-1, 1)


def upwards(share: FloatArray, random: np.random.Generator) -> FloatArray:
    """Swipe up."""
    return to_the_right(share, random)[:, ::-1] * (1, -1)


SETS: dict[str, dict[str, Figure]] = {
    "circles": {"clockwise": clockwise, "counter-clockwise": counter_clockwise},
    "one circle": {"circle": clockwise, "right": to_the_right, "up": upwards},
    "swipes": {"left": to_the_left, "right": to_the_right, "up": upwards},
}


def drawn_sets(seed: int = 0) -> Iterator[RecordedSet]:
    """Draw all sets; in ``one circle`` half of the people go round the other way."""
    for name, figures in SETS.items():
        random = np.random.default_rng(seed)
        recordings, labels, people = [], [], []
        for person in range(PEOPLE):
            habit = _habit(random)
            for label, figure in figures.items():
                turned = name == "one circle" and label == "circle" and person % 2 == 1
                for _ in range(TAKES):
                    drawn = counter_clockwise if turned else figure
                    recordings.append(_take(drawn, habit, random))
                    labels.append(label)
                    people.append(f"person {person}")
        yield RecordedSet(name, recordings, np.array(labels), np.array(people))


def _habit(random: np.random.Generator) -> FloatArray:
    """Draw a person's way of drawing: a matrix that scales, slants and stretches."""
    slant, stretch = random.normal(0, 0.12), np.exp(random.normal(0, 0.15))
    turn = np.array([[np.cos(slant), -np.sin(slant)], [np.sin(slant), np.cos(slant)]])
    matrix: FloatArray = random.uniform(0.5, 1.2) * turn @ np.diag([stretch, 1 / stretch])
    return matrix


def _take(figure: Figure, habit: FloatArray, random: np.random.Generator) -> PoseSequence:
    count = int(random.integers(30, 90))
    time = np.arange(count) / 30
    eased = time / time[-1]
    eased = eased**2 * (3 - 2 * eased)
    waver = sum(
        random.normal(0, 0.03 / k, 2) * np.cos(np.pi * k * eased[:, None] + random.uniform(0, 6))
        for k in range(1, 5)
    )
    wrist = (figure(eased, random) + waver) @ habit.T + random.normal(0, 0.1, 2) + (-0.6, 0)
    still = np.array([[0.3, -0.5], [-0.3, -0.5], [0.2, 0.5], [-0.2, 0.5]])
    xy = np.concatenate([np.broadcast_to(still, (count, 4, 2)), wrist[:, None]], axis=1)
    xy = xy + random.normal(0, 0.005, xy.shape)
    return PoseSequence(
        landmarks=("left_shoulder", "right_shoulder", "left_hip", "right_hip", "right_wrist"),
        xy=xy * 120 + (320, 240),
        time=time,
        frame_size=(640, 480),
    )
