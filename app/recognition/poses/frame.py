"""Frame landmarks: the body and the hands that an estimator finds in one image.

A `HandShape` is the median of a held hand's landmarks, without its place and size.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from app.recognition.errors import PoseError
from app.recognition.poses.landmarks import HAND_LANDMARKS
from app.recognition.poses.sequence import FloatArray

Image: TypeAlias = npt.NDArray[np.uint8]
"""``(height, width, 3)`` RGB, upright, y down."""

Side = Literal["left", "right"]
"""The person's own left or right."""

SIDES: Final[tuple[Side, ...]] = ("left", "right")


@dataclass(frozen=True, eq=False)
class Body:
    """One person's pose in one frame.

    Attributes
    ----------
    xy
        ``(33, 2)`` pixels, x right, y down, in the order of `POSE_LANDMARKS`; may lie outside the
        image. NaN: not seen, or not among the landmarks that the estimator's model has.
    visibility
        ``(33,)`` in [0, 1]: the model's probability that the landmark is in view and not hidden.
    score
        The model's probability, in [0, 1], that there is a person.
    world
        ``(33, 3)`` metres from the hips' middle, x to the image's right, y down, z away from the
        camera; None where the model gives none.

    """

    xy: FloatArray
    visibility: FloatArray
    score: float
    world: FloatArray | None = None


@dataclass(frozen=True, eq=False)
class Hand:
    """One hand in one frame.

    Attributes
    ----------
    xy
        ``(21, 2)`` pixels, x right, y down, in the order of `HAND_LANDMARKS`. NaN: not known, as
        the fingers in `FrameLandmarks.places`.
    side
        The person's left or right hand, as the model sees it.
    score
        The model's probability, in [0, 1], that there is a hand.

    """

    xy: FloatArray
    side: Side
    score: float

    @property
    def size(self) -> float:
        """Diagonal of the landmarks' bounding box in pixels."""
        return float(np.linalg.norm(np.nanmax(self.xy, axis=0) - np.nanmin(self.xy, axis=0)))


@dataclass(frozen=True, eq=False)
class FrameLandmarks:
    """The landmarks of one frame.

    Attributes
    ----------
    body
        The body of the person whom the estimator follows; None where they are not seen.
    hands
        Up to two hands of each person seen, the larger first.
    others
        The bodies of other people in the frame.
    places
        Hands that are seen without their fingers, in gloves for instance: only the wrist and, at
        the middle finger's, the knuckles are known. They show no salute and no hand shape.

    """

    body: Body | None
    hands: tuple[Hand, ...]
    others: tuple[Body, ...] = ()
    places: tuple[Hand, ...] = ()

    @property
    def bodies(self) -> tuple[Body, ...]:
        """All bodies in the frame, the followed one first."""
        return (() if self.body is None else (self.body,)) + self.others


Pose: TypeAlias = tuple[tuple[float, float] | None, ...]
"""A body in one frame, for drawing: x (right) and y (down) of each of `POSE_LANDMARKS`, as
fractions of the upright picture's width and height; outside 0 to 1 beyond the picture's edge, None
if not seen."""

POSE_DIGITS = 4
"""Digits of a pose's fractions: a tenth of a pixel in a picture 1000 wide."""


def pose_in(xy: FloatArray, width: int, height: int) -> Pose:
    """Return landmarks ``(K, 2)`` in pixels as fractions of a picture of `width` x `height`."""
    return tuple(
        (round(x / width, POSE_DIGITS), round(y / height, POSE_DIGITS))
        if math.isfinite(x) and math.isfinite(y)
        else None
        for x, y in xy.tolist()
    )


DIGITS = 3
"""Decimals kept: a hundredth of a finger's width, a tenth of a hand model's error."""

KNUCKLES_PER_PALM = 1.2
"""Palm length over the width of the knuckles, for foreshortened palms."""

MOST_FRAMES = 64
"""Most frames from which a hand's shape is computed, see `choose_frames`: more change no digit."""


_WRIST, _MIDDLE = HAND_LANDMARKS.index("wrist"), HAND_LANDMARKS.index("middle_finger_mcp")
_INDEX, _LITTLE = (HAND_LANDMARKS.index(f"{name}_mcp") for name in ("index_finger", "pinky"))


@dataclass(frozen=True, eq=False)
class HandShape:
    """The shape of one hand, the median over the time in which it is held.

    Attributes
    ----------
    side
        The person's left or right hand.
    xy
        ``(21, 2)``, x to the image's right, y down, in the order of `HAND_LANDMARKS`: the
        centroid is the origin, the root of the mean squared distance from it is 1.

    Raises
    ------
    PoseError
        When the landmarks have another shape, are not finite, or all lie at one point.

    """

    side: Side
    xy: FloatArray

    def __post_init__(self) -> None:
        """Validate, and freeze a private copy."""
        xy = np.array(self.xy, dtype=np.float64)
        if self.side not in SIDES or xy.shape != (len(HAND_LANDMARKS), 2):
            raise PoseError(
                f"a hand shape is left or right with (21, 2) numbers, got {self.side!r} with "
                f"{xy.shape}"
            )
        if not np.isfinite(xy).all() or not np.ptp(xy, axis=0).any():
            raise PoseError("a hand shape needs 21 landmarks that are seen, not all at one point")
        xy.setflags(write=False)
        object.__setattr__(self, "xy", xy)

    @classmethod
    def of_frames(cls, side: Side, hands: FloatArray) -> HandShape:
        """Return the median shape of a hand in some frames.

        Place and size of the hand in the image do not matter.

        Parameters
        ----------
        side
            Of the person.
        hands
            ``(T, 21, 2)`` pixels, T >= 1, without NaN.

        """
        middle = np.median(normalize_hands(hands[choose_frames(len(hands))]), axis=0)
        # Adding 0 turns -0.0 into 0.0, which files do not distinguish.
        return cls(side, np.round(normalize_hands(middle[None])[0], DIGITS) + 0.0)

    @property
    def palm(self) -> float:
        """Length of the palm, wrist to middle knuckle, in sizes of the hand.

        A foreshortened palm is measured by the width of its knuckles.
        """
        return float(measure_palms(self.xy[None])[0])

    def mirror(self) -> HandShape:
        """Return the mirror image, which is the same shape of the other hand."""
        return HandShape(SIDES[1 - SIDES.index(self.side)], self.xy * (-1.0, 1.0) + 0.0)

    def turn(self, degrees: float) -> HandShape:
        """Return the shape turned in the image, clockwise."""
        cosine, sine = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
        return replace(self, xy=self.xy @ np.array([[cosine, sine], [-sine, cosine]]))


def choose_frames(count: int) -> npt.NDArray[np.intp]:
    """Choose at most `MOST_FRAMES` of `count` frames, evenly, the first and the last among them."""
    chosen = np.linspace(0, count - 1, min(count, MOST_FRAMES)).round()
    return chosen.astype(np.intp)


def mirror_hands(hands: Sequence[HandShape]) -> tuple[HandShape, ...]:
    """Return the mirror images of one hand or two, left then right."""
    return tuple(hand.mirror() for hand in reversed(hands))


def measure_palms(hands: FloatArray) -> FloatArray:
    """Return the lengths of the palms of hands ``(T, 21, 2)``, ``(T,)`` in their unit."""
    along = np.linalg.norm(hands[:, _MIDDLE] - hands[:, _WRIST], axis=1)
    across = np.linalg.norm(hands[:, _INDEX] - hands[:, _LITTLE], axis=1)
    return np.asarray(np.maximum(along, KNUCKLES_PER_PALM * across))


def normalize_hands(hands: FloatArray) -> FloatArray:
    """Move the centroid of each hand of ``(T, 21, 2)`` to the origin, and divide by its size."""
    centred = hands - hands.mean(axis=1, keepdims=True)
    size = np.sqrt((centred**2).sum(axis=2).mean(axis=1))
    return np.asarray(centred / np.maximum(size, 1e-9)[:, None, None])
