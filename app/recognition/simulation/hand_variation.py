"""Hand variation: random variants of held hands, as in further takes of the same shape.

A hand is turned in the image, seen from another side, and its fingers are bent and spread a little
otherwise. The spreads are those with which variants are about as far from a demonstration as takes
of divers' signs are: of the same view for the demonstrator, of another view for another person
(`benchmarks/studies/hand-shapes.md`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

import numpy as np

from app.recognition.features.hand_image import FINGER_BONES
from app.recognition.poses.hand_shape import HandShape, normalize_hands
from app.recognition.poses.sequence import FloatArray


@dataclass(frozen=True, kw_only=True)
class HandSpread:
    """Standard deviations of the differences between two takes of a held shape.

    Attributes
    ----------
    roll
        Degrees in the image.
    turn
        Degrees about an axis in the image, as if the hand were flat.
    bend
        Degrees by which each bone of a finger changes its direction.
    error
        Error of each landmark, in sizes of the hand.

    """

    roll: float
    turn: float
    bend: float
    error: float


HAND_SPREADS: Final = MappingProxyType(
    {
        "same": HandSpread(roll=6.0, turn=12.0, bend=4.0, error=0.02),
        "another": HandSpread(roll=10.0, turn=32.0, bend=13.0, error=0.04),
    }
)
"""By performer of the variant: the demonstrator, or another person."""


def vary_hands(
    hands: Sequence[HandShape], count: int, spread: HandSpread, *, seed: int = 0
) -> list[tuple[HandShape, ...]]:
    """Draw variants of held hands; a larger count begins with the same ones."""
    random = np.random.default_rng(seed)
    return [tuple(_vary(hand, spread, random) for hand in hands) for _ in range(count)]


def _vary(hand: HandShape, spread: HandSpread, random: np.random.Generator) -> HandShape:
    bent = _bend(hand.xy, np.radians(spread.bend) * random.standard_normal(len(FINGER_BONES)))
    axis = random.uniform(0, np.pi)
    narrowed = np.cos(np.radians(spread.turn) * random.standard_normal())
    along = np.array([np.cos(axis), np.sin(axis)])
    seen = bent + (narrowed - 1) * np.outer(bent @ along, along)
    seen = seen + spread.error * random.standard_normal(seen.shape)
    made = HandShape(hand.side, normalize_hands(seen[None])[0])
    return made.turn(spread.roll * random.standard_normal())


def _bend(xy: FloatArray, angles: FloatArray) -> FloatArray:
    """Turn every bone about its inner end, together with what lies beyond it."""
    bent = xy.copy()
    turned = 0.0
    for (start, end), angle in zip(FINGER_BONES, angles.tolist(), strict=True):
        turned = angle if start == 0 else turned + angle
        # The palm is one piece: a finger bends from its knuckle on.
        by = 0.0 if start == 0 else turned
        x, y = xy[end] - xy[start]
        cosine, sine = np.cos(by), np.sin(by)
        bent[end] = bent[start] + (cosine * x - sine * y, sine * x + cosine * y)
    return bent
