"""DTW alignments: the corresponding steps of a query and a gesture, and their costs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from pydantic import BaseModel, ConfigDict

from app.recognition.decision.result import WRITTEN
from app.recognition.features.motion import build_movement, find_hands
from app.recognition.features.traversals import Traversal, list_traversals
from app.recognition.gestures.gesture import Gesture
from app.recognition.matching.dtw import BAND, dtw_pairs
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.text.described import DESCRIBED
from app.recognition.voters.motion_voters import Path

DIGITS = 4
"""Decimals of costs and seconds in JSON: a tenth of a millisecond."""


Places = list[list[tuple[float, float]]]


class Alignment(BaseModel):
    """The best DTW alignment of a query's path with a gesture's; rounded in JSON."""

    model_config = ConfigDict(**DESCRIBED, **WRITTEN)

    label: str
    """The gesture's."""
    voter: str = Path.name
    """``path``, whose distance it is."""
    parts: tuple[str, ...]
    """P landmarks."""
    pairs: list[tuple[int, int]]
    """S corresponding steps of the take and of the gesture."""
    time: list[float]
    """Seconds in the take's clock of each of its steps."""
    gesture_time: list[float]
    """Seconds in the demonstration of each of the gesture's steps."""
    query: Places
    """Step by step and part by part the take's position relative to its mean, x right and y down,
    in sizes of the gesture: the costs are the distances between corresponding positions, divided by
    the number of steps."""
    gesture: Places
    """The same of the gesture."""
    costs: list[list[float]]
    """Per pair and part, >= 0; their sum is `distance`."""
    distance: float
    """The voter's distance, in its unit."""
    backward: bool
    """Whether the gesture is traversed backwards."""
    mirrored: bool
    """Whether it is the gesture's mirror image."""
    demonstration: int = 0
    """Which of the gesture's demonstrations it is, from 0."""


def align(
    query: Trajectory,
    gesture: Gesture,
    landmarks: Sequence[str],
    traversal: Traversal | None,
    *,
    mirrored: bool = False,
    start: float = 0.0,
    demonstration: int = 0,
) -> Alignment | None:
    """Align a query with a gesture.

    Parameters
    ----------
    query
        The query.
    gesture
        With the demonstration that it is aligned with.
    landmarks
        Names of the landmarks.
    traversal
        The one of the gesture; None: the one whose path is nearest to the query's.
    mirrored
        Whether to align with the gesture's mirror image.
    start
        Second of the query's clock at which its movement begins.
    demonstration
        Which of the gesture's demonstrations it is, from 0.

    Returns
    -------
    None where one of the two has no movement.

    """
    trajectory = (gesture.mirror() if mirrored else gesture).trajectory
    if trajectory is None or gesture.is_held or min(len(trajectory), len(query)) < 2:
        return None
    moved, whole = build_movement(query, landmarks), build_movement(trajectory, landmarks)
    read = Path().describe(moved)
    if traversal is None:
        open_to = list_traversals(whole, hands=find_hands(gesture.salient), both_ways=True)
        ways = np.stack([Path().describe(whole.reorder(each.order)) for each in open_to])
        traversal = open_to[int(Path().distances(read, ways).argmin())]
    shown = whole.reorder(traversal.order)
    pairs = dtw_pairs(read, Path().describe(shown), BAND)
    apart = moved.figure[pairs[:, 0]] - shown.figure[pairs[:, 1]]
    # A step's distance is the root of its squares, of which each part has its share.
    squares = (apart**2).sum(axis=2)
    costs = squares / np.sqrt(np.maximum(squares.sum(axis=1, keepdims=True), 1e-12)) / len(read)
    return Alignment(
        label=gesture.label,
        parts=tuple(landmarks),
        pairs=pairs.tolist(),
        time=_round(start + moved.reached),
        gesture_time=_round(whole.reached[traversal.order]),
        query=_round(moved.figure),
        gesture=_round(shown.figure),
        costs=_round(costs),
        distance=_round(costs.sum()),
        backward=traversal.backward,
        mirrored=mirrored,
        demonstration=demonstration,
    )


def _round(values: FloatArray) -> Any:
    """Round for JSON."""
    return np.round(values, DIGITS).tolist()
