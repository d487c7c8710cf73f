"""DTW alignments: the corresponding steps of a query and a gesture, and their costs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
import numpy.typing as npt
from pydantic import Field, InstanceOf, PlainSerializer, computed_field

from app.recognition.decision.result import WRITTEN
from app.recognition.features.motion import (
    Movement,
    build_movement,
    find_hands,
    list_limbs,
    normalize_size,
)
from app.recognition.features.traversals import AS_SHOWN, Traversal, list_traversals
from app.recognition.gestures.gesture import Gesture
from app.recognition.matching.dtw import BAND, dtw_pairs
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.voters.motion_voters import Path

DIGITS = 4
"""Decimals of costs and seconds in JSON: a tenth of a millisecond."""

RESTING_WEIGHT = 0.3
"""Weight of a posture where the movement starts; at the farthest step it is greater by 1."""

AlignedBy = Literal["path", "posture"]


@dataclass(frozen=True, eq=False, kw_only=True)
class Example:
    """A gesture as a query was compared with it: in one traversal, mirrored or not.

    Attributes
    ----------
    label
        The gesture's.
    traversal
        The order of its steps.
    mirrored
        Whether it is the gesture's mirror image.
    movement
        Its movement in that traversal.
    time
        ``(N,)``: seconds of each step in the demonstration.

    """

    label: str
    traversal: Traversal
    mirrored: bool
    movement: Movement
    time: FloatArray

    @classmethod
    def of(
        cls,
        gesture: Gesture,
        landmarks: Sequence[str],
        traversal: Traversal,
        *,
        mirrored: bool = False,
    ) -> Example | None:
        """Return a gesture's example; None where the gesture has no demonstration."""
        trajectory = (gesture.mirror() if mirrored else gesture).trajectory
        if trajectory is None or len(trajectory) < 2:
            return None
        shown = build_movement(trajectory, landmarks)
        return cls(
            label=gesture.label,
            traversal=traversal,
            mirrored=mirrored,
            movement=shown.reorder(traversal.order),
            time=shown.reached[traversal.order],
        )


def _round(values: Any) -> Any:
    """Round for JSON."""
    return np.round(values, DIGITS).tolist()


def _pair(values: FloatArray | npt.NDArray[np.intp]) -> Any:
    """Round the pairs in the last axis; of a place that is not seen, ``(x, y)`` of NaN, None."""
    if values.ndim > 1:
        return [_pair(each) for each in values]
    return tuple(_round(values)) if np.isfinite(values).all() else None


Places = Annotated[
    FloatArray,
    InstanceOf(),
    PlainSerializer(_pair, list[list[tuple[float, float] | None]]),
    Field(description="Step by step and part by part, x right and y down; null: not seen."),
]
Times = Annotated[FloatArray, InstanceOf(), PlainSerializer(_round, list[float])]
Steps = Annotated[
    npt.NDArray[np.intp],
    InstanceOf(),
    PlainSerializer(_pair, list[tuple[int, int]]),
    Field(description="Corresponding steps of the take and of the gesture."),
]
Costs = Annotated[
    FloatArray,
    InstanceOf(),
    PlainSerializer(_round, list[list[float]]),
    Field(description="Per pair and part; their sum is `distance`."),
]


@dataclass(frozen=True, eq=False, kw_only=True)
class Alignment:
    """The best DTW alignment of a query with a gesture, by one voter; rounded in JSON.

    Attributes
    ----------
    label
        The gesture's.
    voter
        ``path``, the voter, or ``posture``: where the arms' bones point.
    parts
        P landmarks; of postures the limbs' outer ends.
    pairs
        ``(S, 2)``: corresponding steps of the query and of the gesture.
    time
        ``(N,)`` seconds in the query's clock of each of its steps.
    gesture_time
        ``(N,)`` seconds in the demonstration of each of the gesture's steps.
    query, gesture
        ``(N, P, 2)``: the voter's descriptors, step by step and part by part, x right and y down,
        in its own unit; NaN where not seen. For `Path` each landmark's position relative to its
        mean, in sizes of the gesture: the costs are the distances between corresponding positions,
        divided by N.
    costs
        ``(S, P)`` >= 0: the contribution of each pair and part to the voter's distance, which is
        their sum.
    backward, mirrored
        Whether the gesture is traversed backwards, and whether it is its mirror image.
    demonstration
        Which of the gesture's demonstrations it is, from 0.

    """

    __pydantic_config__ = WRITTEN

    label: str
    voter: str
    parts: tuple[str, ...]
    pairs: Steps
    time: Times
    gesture_time: Times
    query: Places
    gesture: Places
    costs: Costs
    backward: bool
    mirrored: bool
    demonstration: int = 0

    @computed_field  # type: ignore[prop-decorator]
    @property
    def distance(self) -> Annotated[float, PlainSerializer(_round, float)]:
        """The voter's distance, in its unit."""
        return float(self.costs.sum())

    @property
    def over_time(self) -> FloatArray:
        """``(N, P)``: the costs summed for each step of the query."""
        gathered = np.zeros((len(self.time), len(self.parts)))
        np.add.at(gathered, self.pairs[:, 0], self.costs)
        return gathered


def align(
    query: Movement,
    example: Example,
    landmarks: Sequence[str],
    *,
    start: float = 0.0,
    by: AlignedBy = "path",
) -> Alignment | None:
    """Align a query with a gesture's example.

    Parameters
    ----------
    query
        The query, with the same landmarks as the example.
    example
        The gesture.
    landmarks
        Names of the landmarks.
    start
        Second of the query's clock at which its movement begins.
    by
        What is aligned.

    Returns
    -------
    None where the two cannot be compared.

    """
    if by == "path":
        describe, parts = Path().describe, tuple(landmarks)
    else:
        describe, parts = describe_posture, tuple(outer for _, outer in list_limbs(landmarks))
    left, right = describe(query), describe(example.movement)
    known = np.asarray(np.isfinite(left).any(axis=0) & np.isfinite(right).any(axis=0))
    if not known.any():
        return None
    shape = (len(left), len(parts), 2)
    shown, gesture_shown = left.reshape(shape), right.reshape(shape)
    left, right = left[:, known], right[:, known]
    pairs = dtw_pairs(left, right, BAND)
    squares = (left[pairs[:, 0]] - right[pairs[:, 1]]) ** 2
    compared = np.isfinite(squares).sum(axis=1, keepdims=True)
    # The known components stand for the whole vector, as in `dtw_distances`.
    costs = np.zeros((len(pairs), len(known)))
    costs[:, known] = np.nan_to_num(squares) * known.sum() / np.maximum(compared, 1)
    # A step's distance is the root of its squares, of which each part has its share.
    costs /= np.sqrt(np.maximum(costs.sum(axis=1, keepdims=True), 1e-12))
    return Alignment(
        label=example.label,
        voter=by,
        parts=parts,
        pairs=pairs,
        time=start + query.reached,
        gesture_time=example.time,
        query=shown,
        gesture=gesture_shown,
        costs=costs.reshape(len(pairs), len(parts), 2).sum(axis=2) / len(left),
        backward=example.traversal.backward,
        mirrored=example.mirrored,
    )


def describe_posture(movement: Movement) -> FloatArray:
    """Describe where the arms' bones point at each step: ``(N, 2 B)``, NaN where not seen.

    Vectors along upper arm, forearm, hand and thumb, divided by one size. Unlike a path they
    distinguish a raised hand from a lowered one. Steps weigh more the farther they are from the
    start, because a gesture's meaning lies in its stroke, not in the arm at rest (Kendon 2004).
    ``(N, 0)`` without limbs.
    """
    weight = RESTING_WEIGHT + movement.under_way
    return (normalize_size(movement.limbs) * weight[:, None, None]).reshape(len(weight), -1)


def find_nearest_example(
    query: Trajectory, gesture: Gesture, landmarks: Sequence[str]
) -> Example | None:
    """Return a gesture's example in the traversal whose path is nearest to the query's.

    For shape voters, which do not distinguish traversals. None where one of the two has no
    movement.
    """
    shown = Example.of(gesture, landmarks, AS_SHOWN)
    if shown is None or len(query) < 2:
        return None
    open_to = list_traversals(shown.movement, hands=find_hands(gesture.salient), both_ways=True)
    voter, moved = Path(), build_movement(query, landmarks)
    read = np.stack([voter.describe(shown.movement.reorder(each.order)) for each in open_to])
    nearest = open_to[int(voter.distances(voter.describe(moved), read).argmin())]
    return Example.of(gesture, landmarks, nearest)
