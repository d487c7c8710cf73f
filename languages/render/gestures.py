"""Gestures of the paper's Table 2 as drawings in the air."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from languages.render.body import Array

POINTS_PER_CURVE = 200
"""Dense enough that the speed along a curve is smooth at any frame rate."""


@dataclass(frozen=True)
class Drawing:
    """A gesture as strokes of the right wrist, in the frontal plane.

    Parameters
    ----------
    strokes
        Each ``(N, 2)``: x to the image's right, z up, in half sizes of the gesture about its
        centre. A stroke begins where the one before ends; between two strokes the hand pauses.
    centre
        ``(2,)`` metres from the right shoulder to the gesture's centre, same axes.
    depth
        Metres from the shoulder to the plane of the gesture, towards the camera.
    half_size
        Metres.
    speed
        Mean speed of the wrist in m/s; larger movements are faster, so that all last about the
        same (isochrony; Viviani and Terzuolo 1982).
    both_hands
        Whether the left hand does the same, mirrored.

    """

    strokes: tuple[Array, ...]
    centre: tuple[float, float] = (-0.16, 0.0)
    depth: float = 0.33
    half_size: float = 0.2
    speed: float = 0.65
    both_hands: bool = False


def arc(centre: tuple[float, float], radius: float, start: float, end: float) -> Array:
    """Points on a circle between two angles in degrees, counted from +x towards +z."""
    angle = np.radians(np.linspace(start, end, POINTS_PER_CURVE))
    return np.array(centre) + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def straight(start: tuple[float, float], end: tuple[float, float]) -> Array:
    """Points on the line between two points."""
    share = np.linspace(0, 1, POINTS_PER_CURVE)[:, None]
    drawn: Array = (1 - share) * np.array(start) + share * np.array(end)
    return drawn


def polygon(*corners: tuple[float, float]) -> tuple[Array, ...]:
    """One stroke from every corner to the next."""
    return tuple(straight(a, b) for a, b in pairwise(corners))


def lying_eight(width: float, height: float) -> Array:
    """Bernoulli's lemniscate, from its crossing through the right loop first."""
    angle = np.linspace(np.pi / 2, -1.5 * np.pi, 2 * POINTS_PER_CURVE)
    reach = 1 / (1 + np.sin(angle) ** 2)
    x, z = width * np.cos(angle) * reach, height * np.sin(2 * angle) * reach
    return np.stack([x, z], axis=1)


def _three() -> tuple[Array, ...]:
    """Two bows, the upper one smaller, with a cusp between them; as the camera reads it."""
    stretch = np.array([0.85, 1.0])
    upper = arc((0, 0.47), 0.47, 155, -90)
    lower = arc((0, -0.52), 0.52, 90, -155)
    return upper * stretch, lower * stretch


DRAWINGS = {
    "circle": Drawing((arc((0, 0), 1, 90, 450),)),
    "wedge": Drawing(polygon((-0.8, 1), (0, -1), (0.8, 1))),
    "three": Drawing(_three(), half_size=0.22),
    "infinity": Drawing((lying_eight(1.4, 0.85),)),
    "sweep": Drawing(
        (arc((0, 0), 1, 232, 112), arc((0, 0), 1, 112, 232)),
        centre=(-0.04, -0.02),
        depth=0.2,
        half_size=0.41,
        speed=1.05,
        both_hands=True,
    ),
    "triangle": Drawing(polygon((0, 1), (-1, -0.75), (1, -0.75), (0, 1))),
    "square": Drawing(
        polygon((-0.88, 0.88), (0.88, 0.88), (0.88, -0.88), (-0.88, -0.88), (-0.88, 0.88))
    ),
    "line": Drawing((straight((1.35, 0), (-1.35, 0)),)),
    "corner": Drawing(polygon((-0.8, 1), (-0.8, -0.9), (0.9, -0.9))),
    "zigzag": Drawing(polygon((-0.9, 0.8), (0.9, 0.8), (-0.9, -0.8), (0.9, -0.8))),
    "unfinished triangle": Drawing(polygon((-0.9, 0.85), (0.05, -0.95), (0.95, 0.8), (0.4, 0.83))),
}
"""Gestures by label; the first three are Table 1 and the first eight Table 2 (Joshi and Sattar
2025); corner and zigzag are open figures with straight ends, and the last one is a triangle by a
diver in a hurry: point down, and the third side broken off."""
