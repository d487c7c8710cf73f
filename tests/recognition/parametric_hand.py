"""Hands of 21 landmarks from joint angles: a stand-in for a hand detector with known truth.

Lengths are in palms (wrist to middle knuckle). The hand points up (+y), the palm faces the camera
(+z towards it), the thumb is at +x; then it is turned and seen in perspective.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from app.recognition.poses.sequence import FloatArray

KNUCKLES = np.array([[0.27, 0.95, 0], [0.04, 1.0, 0], [-0.17, 0.93, 0], [-0.36, 0.83, 0]])
"""Index to little finger."""
BONES = np.array([[0.45, 0.27, 0.22], [0.50, 0.31, 0.23], [0.46, 0.29, 0.23], [0.36, 0.21, 0.20]])
"""Proximal, middle and distal phalanx of each finger, after Buryanov and Kotiuk (2010)."""
CAMERA_DISTANCE = 8.0
"""Palms between camera and hand: three quarters of a metre."""


@dataclass(frozen=True)
class Finger:
    """One finger's joint angles in degrees.

    Attributes
    ----------
    spread
        From the hand's axis towards the thumb.
    curl
        Flexion of the three joints, knuckle first.

    """

    spread: float
    curl: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class View:
    """How a hand is turned in degrees: in the image, about its own axis, towards the camera."""

    roll: float = 0.0
    yaw: float = 0.0
    pitch: float = 0.0


def hand_xy(
    fingers: tuple[Finger, Finger, Finger, Finger],
    view: View | None = None,
    *,
    thumb_spread: float = 40.0,
) -> FloatArray:
    """Project a hand: ``(21, 2)`` in palms, x right, y down."""
    thumb = np.radians(thumb_spread)
    towards = np.array([np.sin(thumb), np.cos(thumb), 0])
    root = np.array([0.2, 0.2, 0.05])
    points = [np.zeros(3), *(root + length * towards for length in (0.0, 0.38, 0.68, 0.93))]
    for knuckle, bones, finger in zip(KNUCKLES, BONES, fingers, strict=True):
        points.append(knuckle)
        spread = np.radians(finger.spread)
        straight = np.array([np.sin(spread), np.cos(spread), 0])
        for bone, bend in zip(bones, np.radians(np.cumsum(finger.curl)), strict=True):
            inwards = np.array([0, 0, np.sin(bend)])
            points.append(points[-1] + bone * (np.cos(bend) * straight + inwards))
    return _projected(np.array(points) - [0, 0.9, 0], view or View())


def _projected(points: FloatArray, view: View) -> FloatArray:
    roll, yaw, pitch = np.radians([view.roll, view.yaw, view.pitch])
    about_y = np.array([[np.cos(yaw), 0, np.sin(yaw)], [0, 1, 0], [-np.sin(yaw), 0, np.cos(yaw)]])
    about_x = np.array(
        [[1, 0, 0], [0, np.cos(pitch), -np.sin(pitch)], [0, np.sin(pitch), np.cos(pitch)]]
    )
    about_z = np.array(
        [[np.cos(roll), -np.sin(roll), 0], [np.sin(roll), np.cos(roll), 0], [0, 0, 1]]
    )
    turned = points @ (about_z @ about_x @ about_y).T
    nearness = CAMERA_DISTANCE / (CAMERA_DISTANCE - turned[:, 2:])
    flat: FloatArray = turned[:, :2] * nearness * [1, -1]
    return flat


def salute(
    gap: float = 26.0, within_index: float = 2.0, within_little: float = 3.0
) -> tuple[Finger, Finger, Finger, Finger]:
    """Make a Vulcan salute: `gap` degrees between the pairs, less inside them."""
    half = gap / 2
    return (
        Finger(half + within_index),
        Finger(half),
        Finger(-half),
        Finger(-half - within_little),
    )


Fingers = tuple[Finger, Finger, Finger, Finger]
Shape = Callable[[np.random.Generator], Fingers]
STRAIGHT, HALF, BENT = (8, 8, 5), (35, 45, 25), (75, 85, 50)
OPEN_SPREADS = (14, 3, -8, -20)


def _fingers(
    random: np.random.Generator,
    spreads: tuple[float, float, float, float],
    curls: tuple[tuple[float, float, float], ...],
    looseness: float = 1.7,
) -> Fingers:
    made = [
        Finger(
            spread + random.normal(0, looseness),
            tuple(float(abs(bend * random.uniform(0.7, 1.2))) for bend in curl),  # type: ignore[arg-type]
        )
        for spread, curl in zip(spreads, curls, strict=True)
    ]
    return made[0], made[1], made[2], made[3]


def _salute(random: np.random.Generator) -> Fingers:
    made = salute(random.uniform(18, 34), random.uniform(0, 4), random.uniform(0, 6))
    spreads = (made[0].spread, made[1].spread, made[2].spread, made[3].spread)
    return _fingers(random, spreads, (STRAIGHT,) * 4, looseness=0.5)


def _held_together(*curls: tuple[float, float, float]) -> Shape:
    return lambda random: _fingers(random, (4, 0, -3, -7), curls)


def _spread_as(
    spreads: tuple[float, float, float, float], *curls: tuple[float, float, float]
) -> Shape:
    return lambda random: _fingers(random, spreads, curls)


SHAPES: dict[str, Shape] = {
    "salute": _salute,
    "open": _spread_as(OPEN_SPREADS, *(STRAIGHT,) * 4),
    "flat": _held_together(*(STRAIGHT,) * 4),
    "relaxed": _held_together(*(HALF,) * 4),
    "fist": _held_together(*(BENT,) * 4),
    "claw": _spread_as(OPEN_SPREADS, *((10, 70, 45),) * 4),
    "curled V": _spread_as((11, 10, -10, -13), *((45, 60, 35),) * 4),
    "pointing": _held_together(STRAIGHT, BENT, BENT, BENT),
    "victory": _spread_as((12, -6, -3, -7), STRAIGHT, STRAIGHT, BENT, BENT),
    "three": _spread_as((10, 1, -9, -7), STRAIGHT, STRAIGHT, STRAIGHT, BENT),
    "horns": _spread_as((6, 1, -3, -10), STRAIGHT, BENT, BENT, STRAIGHT),
    "ring with thumb": _spread_as((4, 1, -8, -18), (50, 55, 28), STRAIGHT, STRAIGHT, STRAIGHT),
    "two together": _held_together(STRAIGHT, STRAIGHT, BENT, BENT),
    "half closed": _spread_as((5, 3, -8, -14), STRAIGHT, STRAIGHT, HALF, HALF),
}
"""Hand shapes of divers: the salute, and those easily mistaken for it."""


@dataclass(frozen=True, eq=False)
class LabelledHand:
    """A hand and what it shows.

    Attributes
    ----------
    shape
        A key of `SHAPES`.
    xy
        ``(21, 2)`` in palms.

    """

    shape: str
    xy: FloatArray

    @property
    def salutes(self) -> bool:
        """Whether it is a salute."""
        return self.shape == "salute"


def labelled_hands(count: int, seed: int = 0, noise: float = 0.02) -> Iterator[LabelledHand]:
    """Draw hands at random, two in five of them saluting, as a detector would see them.

    Parameters
    ----------
    noise
        Standard deviation of the landmarks' error in palms.

    """
    random = np.random.default_rng(seed)
    others = [name for name in SHAPES if name != "salute"]
    for _ in range(count):
        shape = "salute" if random.random() < 0.4 else str(random.choice(others))
        view = View(random.uniform(-50, 50), random.normal(0, 22), random.normal(0, 18))
        mirrored = np.array([random.choice([-1.0, 1.0]), 1.0])
        xy = hand_xy(SHAPES[shape](random), view, thumb_spread=random.uniform(15, 50)) * mirrored
        yield LabelledHand(shape, xy + random.normal(0, noise, xy.shape))
