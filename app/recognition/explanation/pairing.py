"""Pairing: a query and one gesture on the same landmarks, the input of `differences`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from app.recognition.explanation.alignment import Example
from app.recognition.features.motion import Movement, build_movement, find_hands
from app.recognition.features.traversals import Traversal, list_traversals
from app.recognition.gestures.gesture import Gesture
from app.recognition.matching.dtw import BAND, dtw_distances
from app.recognition.poses.landmarks import other_side
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.voters.motion.path import Path

ALIKE = 0.2
"""Mean path distance between two people's takes of one figure."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Pairing:
    """A query and a gesture, on the gesture's own landmarks.

    Attributes
    ----------
    landmarks
        L landmarks: the gesture's salient ones and their counterparts on the other side.
    trajectory
        The query as the voters compare it, with all of its landmarks.
    query
        Its movement.
    example
        The gesture as the query was compared with it.
    gesture
        The gesture's trajectory, mirrored if the example is.
    starts
        Traversals in the demonstrated direction: other starting points of the figure.
    start
        Second of the query's clock at which its movement begins.

    """

    landmarks: tuple[str, ...]
    trajectory: Trajectory
    query: Movement
    example: Example
    gesture: Trajectory
    starts: tuple[Traversal, ...]
    start: float

    @classmethod
    def of(
        cls,
        trajectory: Trajectory,
        gesture: Gesture,
        traversal: Traversal,
        *,
        mirrored: bool = False,
        start: float = 0.0,
    ) -> Pairing | None:
        """Return the pairing of a condensed query and a gesture; None where one has no movement."""
        side = gesture.mirror() if mirrored and gesture.trajectory is not None else gesture
        if side.trajectory is None or len(side.trajectory) < 2 or len(trajectory) < 2:
            return None
        both = {*side.salient, *(other_side(name) for name in side.salient)}
        landmarks = tuple(sorted(both & {*side.trajectory.landmarks} & {*trajectory.landmarks}))
        example = Example.of(gesture, landmarks, traversal, mirrored=mirrored)
        if not landmarks or example is None:
            return None
        shown = build_movement(side.trajectory, landmarks)
        return cls(
            landmarks=landmarks,
            trajectory=trajectory,
            query=build_movement(trajectory, landmarks),
            example=example,
            gesture=side.trajectory,
            starts=list_traversals(shown, hands=find_hands(side.salient), both_ways=False),
            start=start,
        )

    @cached_property
    def base(self) -> float:
        """The path distance of the two as they were compared."""
        return self.distance(self.query.paths, [self.example.movement.paths])

    def distance(self, paths: FloatArray, others: Sequence[FloatArray]) -> float:
        """Return the least path distance of ``(N, L, 2)`` to any of the others, ends included."""
        described = [Path().describe(replace(self.query, paths=each)) for each in (paths, *others)]
        return float(dtw_distances(described[0], np.stack(described[1:]), BAND).min())

    def share(self, left: float) -> float:
        """Return the share of the path distance that undoing a difference removes.

        Parameters
        ----------
        left
            The distance after undoing it. The distance between two people's takes of one figure
            is subtracted from both distances.

        """
        fault = self.base - ALIKE
        return min(1.0, max(0.0, 1.0 - max(0.0, left - ALIKE) / fault)) if fault > 0 else 0.0

    def paths_begun_anywhere(self, *, backward: bool = False) -> list[FloatArray]:
        """Return the gesture's paths from each starting point, forwards or backwards."""
        shown = np.empty_like(self.example.movement.paths)
        shown[self.example.traversal.order] = self.example.movement.paths
        step = -1 if backward else 1
        return [shown[traversal.order[::step]] for traversal in self.starts]

    def seconds(self, step: int) -> float:
        """Return the time of a step in the query's clock, in seconds."""
        return self.start + float(self.query.reached[step])
