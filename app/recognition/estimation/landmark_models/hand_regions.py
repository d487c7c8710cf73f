"""Hand regions: the region of a whole hand, from its palm or from its previous landmarks."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from app.recognition.estimation.landmark_models.region import Region, upright
from app.recognition.estimation.landmark_models.suppression import Detection
from app.recognition.poses.sequence import FloatArray

PALM_SCALE: Final = 2.6
PALM_SHIFT: Final = 0.5
"""Side of the whole hand's region over that of the palm's box, and its shift to the fingers.

These two values and the next two are those that MediaPipe's landmark model was trained with.
"""

PALM_TURN: Final = 90 - 14 * 2 * math.pi - math.pi / 2
"""Radians, about 0.46: how far MediaPipe turns a palm's region beyond upright.

Its graph gives the target angle as 90 where radians are expected, and so turns the hand to 90
radians. The next frame's region is upright again. Kept for parity with the library: it affects
which hands are found.
"""

HAND_SCALE: Final = 2.0
HAND_SHIFT: Final = 0.1
"""Side of the next frame's region over that of the box of a hand's landmarks, and its shift."""

WRIST, INDEX_KNUCKLE, MIDDLE_KNUCKLE, RING_KNUCKLE, PINKY_KNUCKLE = 0, 5, 9, 13, 17
KNUCKLES: Final = (INDEX_KNUCKLE, MIDDLE_KNUCKLE, RING_KNUCKLE, PINKY_KNUCKLE)

STEADY: Final = (0, 1, 2, 3, 5, 6, 9, 10, 13, 14, 17, 18)
"""Landmarks that bound the region: the palm and the fingers' first joints, slower than the tips."""


def region_of_palm(palm: Detection) -> Region:
    """Return the region of the whole hand, from wrist to middle knuckle `PALM_TURN` off upright."""
    rotation = upright(palm.keypoints[0], palm.keypoints[2]) + PALM_TURN
    width, height = palm.box[1] - palm.box[0]
    centre = palm.box.mean(axis=0) + PALM_SHIFT * height * up_of(rotation)
    side = PALM_SCALE * max(width, height)
    return Region(float(centre[0]), float(centre[1]), float(side), rotation)


def region_of_hand(xy: FloatArray) -> Region:
    """Return the region of a hand in the next frame, from its landmarks ``(21, 2)``."""
    knuckles = ((xy[INDEX_KNUCKLE] + xy[RING_KNUCKLE]) / 2 + xy[MIDDLE_KNUCKLE]) / 2
    rotation = upright(xy[WRIST], knuckles)
    right, up = right_of(rotation), up_of(rotation)
    axes = np.stack([right, -up])
    steady = xy[list(STEADY)] @ axes.T
    low, high = steady.min(axis=0), steady.max(axis=0)
    width, height = high - low
    centre = (low + high) / 2 @ axes + HAND_SHIFT * height * up
    side = HAND_SCALE * max(width, height)
    return Region(float(centre[0]), float(centre[1]), float(side), rotation)


def palm_size(xy: FloatArray) -> float:
    """Return the longest side of the triangle of wrist, index and little finger's knuckles."""
    sides = xy[[INDEX_KNUCKLE, PINKY_KNUCKLE, WRIST]] - xy[[WRIST, INDEX_KNUCKLE, PINKY_KNUCKLE]]
    return float(np.hypot(sides[:, 0], sides[:, 1]).max())


def box_of(xy: FloatArray) -> FloatArray:
    """Return the corners ``(2, 2)`` of the upright box around landmarks, low then high."""
    return np.stack([xy.min(axis=0), xy.max(axis=0)])


def right_of(rotation: float) -> FloatArray:
    """Return the unit vector, in image axes, that points right in a region so turned."""
    return np.array([math.cos(rotation), math.sin(rotation)])


def up_of(rotation: float) -> FloatArray:
    """Return the unit vector, in image axes, that points up in a region so turned."""
    return np.array([math.sin(rotation), -math.cos(rotation)])
