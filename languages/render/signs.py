"""Signs: hand shapes that divers hold, and how the arm holds them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from languages.render.body import Array
from languages.render.performance import (
    REST,
    SALUTE,
    TO_CAMERA,
    UP,
    Manner,
    Performance,
    Timeline,
    animate,
)
from languages.render.posture import ArmTarget, bend_fingers

STRAIGHT, CURLED = (2, 3, 3), (80, 92, 57)
"""Degrees of the three joints of a stretched finger and of one in a fist."""
ACROSS = np.array([1.0, -0.15, 0.1])
"""A fist whose thumb points up or down lies across the body, the knuckles to the image's right."""
PALM_DOWN = np.array([0.1, 0.0, -1.0])
IN_FRONT = np.array([-0.19, -0.28, 0.06])
"""Metres from the shoulder: beside the face, where the salute is, a little lower."""


def _hand(
    thumb: tuple[float, float, float, float], *fingers: tuple[float, tuple[float, float, float]]
) -> Array:
    """Return spreads and bends in radians, ``(5, 4)``, thumb to little finger."""
    return bend_fingers(thumb, *((spread, *bends) for spread, bends in fingers))


THUMB_OUT = (70, 0, 0, 0)
THUMB_IN = (15, 45, 40, 40)


@dataclass(frozen=True, eq=False)
class Sign:
    """A held sign of the right hand.

    Attributes
    ----------
    fingers
        ``(5, 4)`` radians, as in `HAND_SHAPES`.
    pointing, palm
        ``(3,)`` directions from the wrist to the knuckles, and out of the palm.
    wrist
        ``(3,)`` metres from the shoulder.

    """

    fingers: Array
    pointing: Array
    palm: Array
    wrist: Array


def _straight(*stretched: int) -> list[tuple[float, tuple[float, float, float]]]:
    """Return the four fingers, some of them stretched, 1 the index finger."""
    spreads = (10, 1, -8, -16)
    return [
        (spread if number in stretched else 0.0, STRAIGHT if number in stretched else CURLED)
        for number, spread in enumerate(spreads, start=1)
    ]


def _sign(
    fingers: Array, pointing: Array = UP, palm: Array = TO_CAMERA, wrist: Array = IN_FRONT
) -> Sign:
    return Sign(fingers, pointing, palm, wrist)


FIST = _hand(THUMB_IN, *_straight())
FLAT = _hand((35, 5, 5, 5), (2, STRAIGHT), (0, STRAIGHT), (-2, STRAIGHT), (-4, STRAIGHT))

SIGNS = {
    "ok": _sign(
        _hand((45, 12, 25, 25), (8, (52, 58, 28)), (1, (8, 8, 4)), (-8, STRAIGHT), (-18, STRAIGHT))
    ),
    "stop": _sign(FLAT),
    "hold": _sign(FIST),
    "up": _sign(_hand(THUMB_OUT, *_straight()), ACROSS, np.array([0.0, 1.0, 0.0])),
    "down": _sign(_hand(THUMB_OUT, *_straight()), ACROSS, np.array([0.0, -1.0, 0.0])),
    "one": _sign(_hand(THUMB_IN, *_straight(1))),
    "two": _sign(_hand(THUMB_IN, *_straight(1, 2))),
    "three": _sign(_hand(THUMB_IN, *_straight(1, 2, 3))),
    "four": _sign(_hand(THUMB_IN, *_straight(1, 2, 3, 4))),
    "five": _sign(_hand((60, 0, 5, 5), *_straight(1, 2, 3, 4))),
    "low on air": _sign(
        FIST, np.array([0.9, 0.1, 0.35]), np.array([0.0, 1.0, 0.0]), np.array([0.12, -0.20, -0.12])
    ),
    "level": _sign(FLAT, np.array([0.9, -0.4, 0.0]), PALM_DOWN),
}
"""By name; the meanings are those of recreational divers."""


def hold_sign(
    sign: Sign, manner: Manner, rate: float, seed: int, seconds: float = 1.6
) -> Performance:
    """Compose a take of a held sign between two salutes.

    Parameters
    ----------
    sign
        The sign.
    manner
        How it is performed; `lean` turns the hand in the image.
    rate
        Frames per second.
    seed
        Of everything that is left to chance.
    seconds
        How long it is held.

    """
    lean = np.radians(manner.lean)
    turn = np.array([[np.cos(lean), 0, -np.sin(lean)], [0, 1, 0], [np.sin(lean), 0, np.cos(lean)]])
    target = ArmTarget(sign.wrist, turn @ sign.pointing, turn @ sign.palm, sign.fingers)
    timeline = Timeline(rate)
    still = [REST] * timeline.frames(0.4)
    timeline.add("rest", still, still)
    timeline.move("raise", 0.75 / manner.tempo, SALUTE, REST)
    timeline.hold("salute", manner.hold)
    timeline.move("transit", 0.4 / manner.tempo, target, REST)
    timeline.hold("stroke", seconds)
    timeline.move("transit", 0.4 / manner.tempo, SALUTE, REST)
    timeline.hold("salute", manner.hold)
    timeline.move("lower", 0.75 / manner.tempo, REST, REST)
    timeline.hold("rest", 0.3)
    return animate(timeline, manner, np.random.default_rng(seed))
