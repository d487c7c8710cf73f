"""Strokes: a palette of single strokes that may take the place of an unclear gesture.

The figures are drawn by numbers, by the right hand of a diver who stands still and faces the
camera; nobody has shown them. Run ``python -m languages.strokes`` from the repository's root.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np

from app.recognition import Gesture, Language, PoseSequence
from app.recognition.poses.sequence import FloatArray
from languages.build import CREATED, FOLDER

FILE: Final = FOLDER / "palette" / "strokes.json"

FRAMES, RATE = 75, 30.0
"""Of each stroke: two and a half seconds, about as long as the samples' demonstrations."""

SCALE, MIDDLE = 100.0, (320.0, 240.0)
"""Pixels of a torso length, and the torso's centre."""

PLACE, SIZE = (-0.55, -0.3), 0.45
"""Middle of the figures from the torso's centre, and half their size, in torso lengths."""

BODY: Final = {
    "left_shoulder": (0.35, -0.5),
    "right_shoulder": (-0.35, -0.5),
    "left_elbow": (0.45, 0.0),
    "left_wrist": (0.4, 0.45),
    "left_hip": (0.22, 0.5),
    "right_hip": (-0.22, 0.5),
}
"""What stands still, in torso lengths from the torso's centre."""

BONE = 0.52
"""Length of upper arm and of forearm, torso lengths."""


def _turn(degrees: FloatArray, radius: FloatArray | float = 1.0) -> FloatArray:
    """Return ``(N, 2)`` points on circles, clockwise from the top."""
    angle = np.radians(degrees)
    return np.stack([radius * np.sin(angle), -radius * np.cos(angle)], axis=1)


_WAY = np.linspace(0, 1, 200)

FIGURES: Final[dict[str, FloatArray]] = {
    "spiral": _turn(720 * _WAY, 0.1 + 0.9 * _WAY),
    "zigzag": np.array([(-1, -1), (1, -0.4), (-1, 0.3), (1, 1)]),
    "wave": np.stack([2 * _WAY - 1, 0.7 * np.sin(4 * np.pi * _WAY)], axis=1),
    "hook": np.concatenate([[(0.6, -1.0)], [(0.0, 0.4)] + 0.6 * _turn(90 + 180 * _WAY)]),
    "arch": np.concatenate([[(-0.8, 1.0)], 0.8 * _turn(180 * _WAY - 90), [(0.8, 1.0)]]),
    "fish": np.array([(1, 0.8), (-0.4, -0.6), (-1, 0), (-0.4, 0.6), (1, -0.8)]),
    "corner": np.array([(-0.8, -1), (-0.8, 1), (0.9, 1)]),
    "steps": np.array([(-1, 1), (-1, 0.1), (0, 0.1), (0, -1), (1, -1)]),
    "hourglass": np.array([(-1, -1), (1, -1), (-1, 1), (1, 1), (-1, -1)]),
    "star": _turn(np.linspace(0, 720, 6)),
    "up and down": np.array([(0, 1), (0, -1), (0, 1), (0, -1)]),
}
"""Per name the corners or points of a stroke, ``(N, 2)`` in [-1, 1], y down."""


def draw_stroke(figure: FloatArray) -> PoseSequence:
    """Return a diver whose right hand follows a figure at an even speed."""
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(figure, axis=0), axis=1))])
    even = np.linspace(0, way[-1], FRAMES)
    hand = np.stack([np.interp(even, way, values) for values in figure.T], axis=1)
    wrist = PLACE + SIZE * hand
    moving = {"right_elbow": _bend(np.array(BODY["right_shoulder"]), wrist), "right_wrist": wrist}
    still = {name: np.tile(place, (FRAMES, 1)) for name, place in BODY.items()}
    places = still | moving
    return PoseSequence(
        landmarks=tuple(places),
        xy=np.round(np.stack(list(places.values()), axis=1) * SCALE + MIDDLE, 2),
        time=np.arange(FRAMES) / RATE,
        frame_size=(640, 480),
    )


def _bend(shoulder: FloatArray, wrist: FloatArray) -> FloatArray:
    """Return ``(T, 2)`` places of an elbow, below a hand that is held out to its side."""
    reach = wrist - shoulder
    length = np.maximum(np.linalg.norm(reach, axis=1, keepdims=True), 1e-6)
    aside = np.stack([reach[:, 1], -reach[:, 0]], axis=1) / length
    height = np.sqrt(np.maximum(BONE**2 - (length / 2) ** 2, 0))
    return np.asarray(shoulder + reach / 2 + height * aside)


def make_language() -> Language:
    """Return the language of all strokes."""
    gestures = [
        replace(
            Gesture.from_demonstration(name, draw_stroke(figure), salient=["right_wrist"]),
            description=f"The right hand draws: {name}",
        )
        for name, figure in FIGURES.items()
    ]
    return Language("Strokes", gestures, author="OSG Studio", created=CREATED)


def main(file: Path = FILE) -> None:
    """Write the language's file."""
    file.parent.mkdir(exist_ok=True)
    make_language().save(file)


if __name__ == "__main__":
    main()
