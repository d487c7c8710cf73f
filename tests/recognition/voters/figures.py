"""Figures to describe, as points ``(T, 2)`` with y down, and their drawings."""

from collections.abc import Mapping

import numpy as np

from app.recognition.features.trajectory_image import Drawing, draw
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from tests.recognition.strategies import SHAPES, circle

FIGURES: Mapping[str, FloatArray] = {
    name: shape(np.linspace(0, 1, 90)) for name, shape in SHAPES.items()
}
CIRCLE: FloatArray = circle(np.linspace(0, 1, 90))
SIX: FloatArray = np.array([(1, 0), (0.2, 0.8), (0, 2), (0.5, 2.5), (1, 2), (0.5, 1.5), (0.1, 1.9)])
"""The stroke of a 6; half a turn makes it a 9."""


def drawing_of(points: FloatArray) -> Drawing:
    """Draw points ``(T, 2)`` as the path of one landmark."""
    return draw(
        Trajectory(
            landmarks=("marker",),
            xy=points[:, None],
            time=np.arange(len(points)) / 30,
            unit="torso_length",
        )
    )


def turned(points: FloatArray, degrees: float) -> FloatArray:
    """Rotate points around the origin."""
    angle = np.radians(degrees)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return np.asarray(points @ turn.T)
