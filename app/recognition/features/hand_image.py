"""Hand images: held hands as white lines on black, 224 x 224, in place of a trajectory image."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import cv2
import numpy as np

from app.recognition.features.contour import BinaryImage
from app.recognition.features.trajectory_image import MARGIN, SIZE, STROKE_WIDTH
from app.recognition.poses.hand_shape import HandShape
from app.recognition.poses.landmarks import HAND_LANDMARKS

BONE_WIDTH = STROKE_WIDTH // 2 + 1
"""Pixels: half of a path's, so that fingers side by side stay apart."""

APART = 3.0
"""Sizes between the middles of two hands that are drawn side by side."""

FINGER_BONES = tuple(
    bone for finger in range(5) for bone in pairwise((0, *range(1 + 4 * finger, 5 + 4 * finger)))
)
"""Pairs of indices in `HAND_LANDMARKS`: from the wrist along each finger."""

KNUCKLE_BONES = tuple(
    (HAND_LANDMARKS.index(f"{one}_mcp"), HAND_LANDMARKS.index(f"{other}_mcp"))
    for one, other in pairwise(("index_finger", "middle_finger", "ring_finger", "pinky"))
)
"""The line across the palm."""


def draw_hands(hands: Sequence[HandShape]) -> BinaryImage:
    """Draw the fingers' bones of one hand, or of two, the person's right one on the left.

    Returns
    -------
    ``(224, 224)``: 255 on black, as large as the margin allows; black without hands.

    """
    image: BinaryImage = np.zeros((SIZE, SIZE), dtype=np.uint8)
    if not hands:
        return image
    order = sorted(hands, key=lambda hand: hand.side == "left")
    places = np.concatenate([hand.xy + (APART * index, 0.0) for index, hand in enumerate(order)])
    low, high = places.min(axis=0), places.max(axis=0)
    scale = (SIZE - 1 - 2 * MARGIN) / float((high - low).max())
    pixels = np.rint((places - (low + high) / 2) * scale + (SIZE - 1) / 2).astype(int).tolist()
    for index in range(len(order)):
        own = pixels[index * len(HAND_LANDMARKS) : (index + 1) * len(HAND_LANDMARKS)]
        for start, end in (*FINGER_BONES, *KNUCKLE_BONES):
            cv2.line(image, own[start], own[end], color=255, thickness=BONE_WIDTH)
    return image
