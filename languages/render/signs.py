"""Divers' common hand signals as postures of the arms, one after the other.

The meanings are those of the Recreational Scuba Training Council, "Common Hand Signals for
Recreational Scuba Diving" (2005). Wrists are in metres from the shoulder of that side, for an arm
of `REFERENCE_ARM` metres: x out of the body where it is negative, y away from the camera, z up.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from languages.render.body import Array
from languages.render.posture import HAND_SHAPES, ArmTarget

UP = np.array([0.0, 0.0, 1.0])
DOWN = -UP
TO_CAMERA = np.array([0.05, -1.0, 0.0])
TO_BODY = np.array([0.1, 1.0, 0.0])
INWARDS = np.array([1.0, -0.15, 0.0])


@dataclass(frozen=True)
class Posture:
    """One posture of a sign.

    Parameters
    ----------
    right
        What the right arm does.
    left
        What the left arm does; None: it hangs.
    seconds
        From the posture before to this one, at tempo 1.
    hold
        Seconds that it is held, at tempo 1.

    """

    right: ArmTarget
    left: ArmTarget | None = None
    seconds: float = 0.35
    hold: float = 0.0


@dataclass(frozen=True)
class Sign:
    """A hand signal.

    Parameters
    ----------
    meaning
        What it says to another diver.
    postures
        In order; the first one is reached from the salute.

    """

    meaning: str
    postures: tuple[Posture, ...]


def _arm(wrist: tuple[float, float, float], pointing: Array, palm: Array, hand: str) -> ArmTarget:
    return ArmTarget(np.array(wrist), pointing, palm, HAND_SHAPES[hand])


HOLD = 1.4
"""Seconds that a sign which is only held is shown."""


def _hold(arm: ArmTarget) -> tuple[Posture, ...]:
    return (Posture(arm, hold=HOLD),)


def _repeat(one: ArmTarget, other: ArmTarget, times: int, seconds: float) -> tuple[Posture, ...]:
    """Go to and fro between two targets of the right arm."""
    return (Posture(one), *(Posture(each, seconds=seconds) for each in (other, one) * times))


def _shift(arm: ArmTarget, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> ArmTarget:
    return replace(arm, wrist=arm.wrist + np.array([x, y, z]))


RAISED = (-0.14, -0.32, 0.06)
"""Before the shoulder, where a hand is shown."""
OK = _arm(RAISED, UP, TO_CAMERA, "ok")
STOP = _arm(RAISED, UP, TO_CAMERA, "flat")
FIST = _arm(RAISED, UP, TO_CAMERA, "fist")
THUMB_UP = _arm((0.02, -0.33, -0.06), INWARDS, TO_BODY, "thumb")
THUMB_DOWN = _arm((0.02, -0.33, 0.02), INWARDS, TO_CAMERA, "thumb")
LEVEL = _arm((-0.02, -0.36, -0.08), np.array([0.6, -0.8, 0.0]), DOWN, "flat")
THROAT = _arm((0.02, -0.20, 0.06), INWARDS, DOWN, "flat")
MOUTH = _arm((0.10, -0.30, 0.10), np.array([0.35, 0.9, 0.5]), np.array([0.3, 0.2, 1.0]), "bunched")
EYES = _arm((0.06, -0.30, 0.13), np.array([0.45, 0.9, 0.45]), np.array([0.2, 0.3, 1.0]), "two")
EAR = _arm((-0.12, -0.08, 0.20), np.array([0.85, 0.35, 0.3]), TO_BODY, "one")
SELF = _arm((-0.02, -0.26, -0.10), np.array([0.75, 0.75, 0.1]), TO_BODY, "one")
THAT_WAY = _arm((-0.16, -0.38, 0.0), np.array([0.1, -1.0, 0.2]), DOWN, "thumb")
DANGER = _arm(
    (-0.34, -0.36, 0.10), np.array([-0.6, -0.8, 0.2]), np.array([0.0, -0.2, -1.0]), "fist"
)
BECKON_OUT = _arm((-0.10, -0.40, 0.02), np.array([0.3, -0.5, 0.8]), TO_BODY, "flat")
BECKON_IN = _arm((-0.06, -0.26, 0.14), np.array([0.5, 0.2, 1.0]), TO_BODY, "flat")
CROSSED = _arm((0.27, -0.21, 0.0), np.array([0.7, 0.5, 0.5]), np.array([0.5, 0.8, 0.0]), "flat")
BUDDY = _arm((0.10, -0.34, -0.08), np.array([0.35, -0.9, 0.2]), DOWN, "one")
ROCK_ONE = _arm(
    (-0.12, -0.36, 0.0), np.array([0.1, -1.0, 0.15]), np.array([0.6, 0.0, -0.8]), "open"
)
ROCK_OTHER = replace(ROCK_ONE, palm=np.array([-0.6, 0.0, -0.8]))
TURN = _arm((-0.12, -0.32, 0.08), UP, TO_CAMERA, "one")


def _number(number: str, hand: str | None = None) -> Sign:
    return Sign(f"The number {number}", _hold(_arm(RAISED, UP, TO_CAMERA, hand or number)))


def _circle(arm: ArmTarget, radius: float, turns: int) -> tuple[Posture, ...]:
    """Lead the wrist round a circle in the frontal plane, by eight postures a turn."""
    angles = np.linspace(0, 2 * np.pi * turns, 8 * turns + 1)
    places = [(radius * float(np.sin(a)), radius * float(np.cos(a))) for a in angles]
    return tuple(Posture(_shift(arm, x=x, z=z), seconds=0.12) for x, z in places)


SIGNS = {
    "ok": Sign("Are you OK? I am OK", _hold(OK)),
    "stop": Sign("Stop where you are", _hold(STOP)),
    "up": Sign("Go up, end the dive", _hold(THUMB_UP)),
    "down": Sign("Go down", _hold(THUMB_DOWN)),
    "problem": Sign("Something is wrong", _repeat(ROCK_ONE, ROCK_OTHER, 3, 0.25)),
    "low on air": Sign(
        "I am low on air",
        _hold(_arm((0.12, -0.17, -0.10), INWARDS, TO_BODY, "fist")),
    ),
    "out of air": Sign(
        "I am out of air",
        _repeat(_shift(THROAT, x=0.16), _shift(THROAT, x=-0.04), 2, 0.3),
    ),
    "share air": Sign("Give me air", _repeat(MOUTH, _shift(MOUTH, x=-0.04, y=-0.12), 2, 0.3)),
    "level off": Sign(
        "Stay at this depth", _repeat(_shift(LEVEL, x=0.10), _shift(LEVEL, x=-0.16), 2, 0.4)
    ),
    "slow down": Sign(
        "Take it easy, slow down", _repeat(_shift(LEVEL, z=0.06), _shift(LEVEL, z=-0.12), 2, 0.45)
    ),
    "come here": Sign("Come here", _repeat(BECKON_OUT, BECKON_IN, 2, 0.35)),
    "go that way": Sign(
        "Go in that direction", _repeat(THAT_WAY, _shift(THAT_WAY, x=0.18), 2, 0.35)
    ),
    "look": Sign("Look", _hold(EYES)),
    "ears": Sign("My ears do not clear", _hold(EAR)),
    "me": Sign("Me, watch me", _hold(SELF)),
    "danger": Sign("Danger there", _hold(DANGER)),
    "cold": Sign(
        "I am cold",
        tuple(
            Posture(_shift(CROSSED, z=z), _shift(CROSSED, y=-0.05, z=z), seconds=0.35)
            for z in (0.0, -0.09, 0.0, -0.09, 0.0)
        ),
    ),
    "buddy": Sign(
        "Stay with your buddy",
        tuple(
            Posture(_shift(BUDDY, x=x), _shift(BUDDY, x=x), seconds=0.35)
            for x in (-0.08, 0.03, -0.08, 0.03)
        ),
    ),
    "turn around": Sign("Turn around", _circle(TURN, 0.07, 2)),
    "hold": Sign("Hold on, stay together", _hold(FIST)),
    "one": _number("one"),
    "two": _number("two"),
    "three": _number("three"),
    "four": _number("four"),
    "five": _number("five", "open"),
}
"""Signs by label."""


def name_clip(label: str) -> str:
    """Return the name of a sign's demonstration clip, without suffix."""
    return f"sign-{label.replace(' ', '-')}"
