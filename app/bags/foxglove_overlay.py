"""Foxglove image annotations: skeletons and labels drawn over a video."""

from __future__ import annotations

from typing import Any

import numpy as np

from app.recognition.poses.landmarks import SKELETON
from app.recognition.poses.sequence import FloatArray

Stamp = dict[str, int]

_BONE = {"r": 0.82, "g": 0.84, "b": 0.87, "a": 0.9}
_JOINT = {"r": 0.35, "g": 0.63, "b": 1.0, "a": 1.0}
_GROUND = {"r": 0.02, "g": 0.04, "b": 0.06, "a": 0.75}
_NOTHING = {"r": 0.0, "g": 0.0, "b": 0.0, "a": 0.0}

_POINTS, _LINE_LIST = 1, 4
"""Foxglove's numbers for the meaning of a list of points."""

THICKNESS = 1 / 160
"""Thickness of a bone, in heights of the picture: three pixels of 480."""

FONT_SIZE = 28
"""Font size in pixels, readable from across a table on a laptop."""

DIGITS = 2
"""Decimals of a pixel: no model resolves a hundredth."""


def points(xy: FloatArray) -> list[dict[str, float]]:
    """Return points ``(N, 2)`` in pixels, without those that are NaN."""
    seen = xy[np.isfinite(xy).all(axis=1)]
    return [{"x": round(x, DIGITS), "y": round(y, DIGITS)} for x, y in seen.tolist()]


def skeleton(
    xy: FloatArray, landmarks: tuple[str, ...], frame_size: tuple[int, int], stamp: Stamp
) -> dict[str, Any]:
    """Draw one frame's body.

    Parameters
    ----------
    xy
        ``(K, 2)`` pixels of the `landmarks`, NaN where not seen.
    landmarks
        K names.
    frame_size
        Width and height of the picture in pixels.
    stamp
        Time of the frame.

    """
    places = {name: row for row, name in enumerate(landmarks)}
    bones = [
        ends
        for one, other in SKELETON
        if one in places and other in places
        if np.isfinite(ends := xy[[places[one], places[other]]]).all()
    ]
    lines = points(np.concatenate(bones)) if bones else []
    thickness = max(2.0, frame_size[1] * THICKNESS)
    return {
        "circles": [],
        "points": [
            _points(_LINE_LIST, lines, _BONE, thickness, stamp),
            _points(_POINTS, points(xy), _JOINT, 2 * thickness, stamp),
        ],
        "texts": [],
    }


def label(text: str, stamp: Stamp) -> dict[str, Any]:
    """Draw a text in the picture's top left corner; an empty text removes it."""
    drawn = {
        "timestamp": stamp,
        "position": {"x": FONT_SIZE / 2, "y": FONT_SIZE * 1.5},
        "text": text,
        "font_size": FONT_SIZE,
        "text_color": _BONE | {"a": 1.0},
        "background_color": _GROUND,
        "metadata": [],
    }
    return {"circles": [], "points": [], "texts": [drawn] if text else []}


def _points(
    kind: int,
    drawn: list[dict[str, float]],
    colour: dict[str, float],
    thickness: float,
    stamp: Stamp,
) -> dict[str, Any]:
    return {
        "timestamp": stamp,
        "type": kind,
        "points": drawn,
        "outline_color": colour,
        "outline_colors": [],
        "fill_color": colour if kind == _POINTS else _NOTHING,
        "thickness": thickness,
        "metadata": [],
    }
