"""Hand images: held hands as white lines on black, 224 x 224, in place of a trajectory image.

Where two shapes are held one after the other, an arrow leads from the first to the second.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import cv2
import numpy as np

from app.recognition.features.contour import BinaryImage
from app.recognition.features.trajectory_image import MARGIN, SIZE, STROKE_WIDTH
from app.recognition.poses.hand_shape import HandShape
from app.recognition.poses.landmarks import FINGERS, HAND_LANDMARKS
from app.recognition.poses.sequence import FloatArray

BONE_WIDTH = STROKE_WIDTH // 2 + 1
"""Width of a bone in pixels: half of a path's, so that fingers side by side stay apart."""

APART = 3.0
"""Distance between the middles of two hands drawn side by side, in sizes of a hand."""

ARROW_SPACE = 1.8
"""Space between two shapes in sequence, in sizes of a hand: enough for an arrow that is visible on
a card of 64 pixels."""

ARROW_SHARES = (0.15, 0.85)
"""Places of the arrow's tail and tip in that space."""

FINGER_BONES = tuple(
    bone for finger in range(5) for bone in pairwise((0, *range(1 + 4 * finger, 5 + 4 * finger)))
)
"""Pairs of indices in `HAND_LANDMARKS`: from the wrist along each finger."""

KNUCKLE_BONES = tuple(
    (HAND_LANDMARKS.index(f"{one}_mcp"), HAND_LANDMARKS.index(f"{other}_mcp"))
    for one, other in pairwise(FINGERS)
)
"""The line across the palm."""


@dataclass(frozen=True, eq=False)
class PlacedHands:
    """The held hands of a gesture as they are drawn.

    Attributes
    ----------
    hands
        ``(hand, xy)`` of each hand and its ``(21, 2)`` places, in sizes of a hand, y down.
    arrow
        ``(2, 2)``: tail and tip of the arrow from the first shape to the second; None for one.

    """

    hands: tuple[tuple[HandShape, FloatArray], ...]
    arrow: FloatArray | None


def place_hands(hands: Sequence[HandShape], then_hands: Sequence[HandShape] = ()) -> PlacedHands:
    """Place the hands of one shape, or of two in sequence, for a drawing.

    Of two hands the person's right one is on the left. The second shape is beside the first, of
    two hands below it.
    """
    first, second = (
        [
            (hand, hand.xy + (APART * index, 0.0))
            for index, hand in enumerate(sorted(shape, key=lambda hand: hand.side == "left"))
        ]
        for shape in (hands, then_hands)
    )
    if not second:
        return PlacedHands(tuple(first), None)
    one, other = (np.concatenate([place for _, place in part]) for part in (first, second))
    along = np.array((1.0, 0.0) if len(hands) == 1 else (0.0, 1.0))
    end = float((one @ along).max())
    step = (end + ARROW_SPACE - float((other @ along).min())) * along
    across = (1 - along) * (one.min(axis=0) + one.max(axis=0)) / 2
    arrow = np.array([across + (end + ARROW_SPACE * share) * along for share in ARROW_SHARES])
    return PlacedHands((*first, *((hand, place + step) for hand, place in second)), arrow)


def draw_hands(hands: Sequence[HandShape], then_hands: Sequence[HandShape] = ()) -> BinaryImage:
    """Draw the fingers' bones of the hands that hold one shape, or two in sequence.

    Parameters as for `place_hands`; an arrow leads from the first shape to the second.

    Returns
    -------
    ``(224, 224)``: 255 on black, as large as the margin allows; black without hands.

    """
    image: BinaryImage = np.zeros((SIZE, SIZE), dtype=np.uint8)
    if not hands:
        return image
    placed = place_hands(hands, then_hands)
    places = np.concatenate([place for _, place in placed.hands])
    low, high = places.min(axis=0), places.max(axis=0)
    scale = (SIZE - 1 - 2 * MARGIN) / float((high - low).max())

    def locate(points: FloatArray) -> list[list[int]]:
        pixels = (points - (low + high) / 2) * scale + (SIZE - 1) / 2
        found: list[list[int]] = np.rint(pixels).astype(int).tolist()
        return found

    for _, place in placed.hands:
        own = locate(place)
        for start, end in (*FINGER_BONES, *KNUCKLE_BONES):
            cv2.line(image, own[start], own[end], color=255, thickness=BONE_WIDTH)
    if placed.arrow is not None:
        tail, tip = locate(placed.arrow)
        cv2.arrowedLine(image, tail, tip, color=255, thickness=BONE_WIDTH, tipLength=0.5)
    return image
