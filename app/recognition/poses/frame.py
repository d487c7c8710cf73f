"""Frame landmarks: the body and the hands that an estimator finds in one image."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal, TypeAlias

import numpy as np
import numpy.typing as npt

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
