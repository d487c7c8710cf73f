"""Direction marks: a start dot and an arrow on each path of a trajectory image, for people."""

from __future__ import annotations

from typing import Final

import cv2
import numpy as np
import numpy.typing as npt

from app.recognition import Gesture
from app.recognition.features.contour import BinaryImage
from app.recognition.features.trajectory_image import MARGIN, SIZE
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.ui.palette import Rgb, load_palette, parse_colour

RgbImage = npt.NDArray[np.uint8]

ARROW_SHARE = 0.3
"""Share of a path's length at which its arrow is: soon after the start, as on stroke diagrams."""

DOT_RADIUS = 10
ARROW_LENGTH = 26
"""Pixels of the 224 x 224 image, visible on a card of 64 pixels."""

SHORTEST = 12.0
"""Length in pixels of a path that is marked; a shorter one is a resting hand."""

_COLOUR: Final = "picture-accent"
"""Token of the palette; on pictures it is the same in both themes."""


def mark_direction(image: BinaryImage, trajectory: Trajectory | None) -> RgbImage:
    """Return a trajectory image in RGB, with a start dot and an arrow on each path.

    Parameters
    ----------
    image
        As the recogniser draws it, ``(224, 224)``.
    trajectory
        The salient landmarks' trajectory that it shows; None: no direction is known.

    """
    marked = np.repeat(np.asarray(image, np.uint8)[..., None], 3, axis=2)
    if trajectory is None:
        return marked
    colour = parse_colour(load_palette().dark[_COLOUR])
    for path in _pixel_paths(trajectory):
        lengths = np.concatenate([[0.0], np.hypot(*np.diff(path, axis=0).T).cumsum()])
        if lengths[-1] >= SHORTEST:
            _draw_arrow(marked, path, lengths, colour)
            start = (round(float(path[0, 0])), round(float(path[0, 1])))
            cv2.circle(marked, start, DOT_RADIUS, colour, cv2.FILLED, cv2.LINE_AA)
    return marked


def mark_gesture(gesture: Gesture) -> RgbImage:
    """Return a gesture's trajectory image with the marks of its demonstration."""
    trajectory = gesture.trajectory
    salient = None if trajectory is None else trajectory.select(gesture.salient)
    return mark_direction(gesture.image, salient)


def _pixel_paths(trajectory: Trajectory) -> list[FloatArray]:
    """Return each landmark's path in pixels of the image, without gaps; see `draw`."""
    known = np.asarray(np.isfinite(trajectory.xy).all(axis=2))
    seen = trajectory.xy[known]
    extent = float(np.ptp(seen, axis=0).max()) if len(seen) else 0.0
    if extent == 0:
        return []
    middle = (seen.min(axis=0) + seen.max(axis=0)) / 2
    pixels = (trajectory.xy - middle) * ((SIZE - 1 - 2 * MARGIN) / extent) + (SIZE - 1) / 2
    return [pixels[known[:, i], i] for i in range(pixels.shape[1]) if known[:, i].sum() > 1]


def _draw_arrow(marked: RgbImage, path: FloatArray, lengths: FloatArray, colour: Rgb) -> None:
    """Draw an arrow head that points along the path."""
    at = ARROW_SHARE * lengths[-1]
    reach = min(ARROW_LENGTH / 2, at, lengths[-1] - at)
    tail, tip = (
        np.array([np.interp(place, lengths, path[:, axis]) for axis in (0, 1)])
        for place in (at - reach, at + reach)
    )
    along = tip - tail
    size = float(np.hypot(*along))
    if size == 0:
        return
    along = along / size
    across = np.array([-along[1], along[0]])
    base = tip - along * ARROW_LENGTH
    corners = [tip + along * 4, base + across * ARROW_LENGTH / 2, base - across * ARROW_LENGTH / 2]
    cv2.fillPoly(marked, [np.rint(corners).astype(np.int32)], colour, cv2.LINE_AA)
