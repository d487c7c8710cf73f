"""Shape references: the drawings of a language's gestures, grouped by salient landmarks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.recognition.features.trajectory_image import SIMPLIFICATION, draw
from app.recognition.gestures.gesture import Gesture
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.voters.registry import PAPER_VOTERS
from app.recognition.voters.shape_voters import ShapeVoter, describe_drawing


@dataclass(frozen=True, eq=False)
class _DrawingGroup:
    """All gestures with the same salient landmarks, which share one drawing of the query.

    Attributes
    ----------
    salient
        Names of the landmarks.
    members
        Indices of the gestures in the language.
    references
        Per voter ``(len(members), D)`` descriptors.

    """

    salient: tuple[str, ...]
    members: npt.NDArray[np.intp]
    references: dict[str, FloatArray]


class ShapeReferences:
    """Shape references of a language for the paper's seven voters.

    Parameters
    ----------
    gestures
        G gestures; those without an image or without salient landmarks match nothing.
    simplification
        Tolerance in pixels with which gestures and queries are drawn, see `draw`.

    """

    def __init__(self, gestures: Sequence[Gesture], simplification: float = SIMPLIFICATION) -> None:
        self._count = len(gestures)
        self._simplification = simplification
        if simplification != SIMPLIFICATION:
            gestures = [gesture.redraw(simplification) for gesture in gestures]
        self._groups = _group_by_landmarks(gestures, PAPER_VOTERS)

    @property
    def needed(self) -> tuple[str, ...]:
        """The landmarks that any gesture needs, in alphabetical order."""
        return tuple(sorted({name for group in self._groups for name in group.salient}))

    def distances(self, trajectory: Trajectory) -> FloatArray:
        """Compute the distances of a query to all gestures.

        The query is drawn and described once per distinct set of salient landmarks, whatever the
        number of gestures; the distances to all of them are array operations.

        Returns
        -------
        ``(7, G)``; infinite where the query lacks a salient landmark, or does not move it.

        """
        distances = np.full((len(PAPER_VOTERS), self._count), np.inf)
        for group in self._groups:
            _fill_distances(trajectory, group, self._simplification, distances)
        return distances


def _fill_distances(
    trajectory: Trajectory, group: _DrawingGroup, simplification: float, distances: FloatArray
) -> None:
    """Write the distances ``(V, G)`` to the gestures of one group."""
    if not set(group.salient) <= set(trajectory.landmarks):
        return
    descriptors = trajectory.compute_once(
        ("drawing", group.salient, simplification),
        lambda: _describe(trajectory.select(group.salient), simplification),
    )
    if descriptors:
        distances[:, group.members] = [
            voter.distances(descriptors[voter.name], group.references[voter.name])
            for voter in PAPER_VOTERS
        ]


def _describe(query: Trajectory, simplification: float) -> dict[str, FloatArray]:
    """Draw and describe salient landmarks; empty where one of them is never seen."""
    if not _all_seen(query):
        return {}
    return describe_drawing(draw(query, simplification), PAPER_VOTERS)


def _all_seen(trajectory: Trajectory) -> bool:
    """Return whether each landmark is seen at some moment."""
    known = np.isfinite(trajectory.xy)
    return bool(known.all() or known.all(axis=2).any(axis=0).all())


def _group_by_landmarks(
    gestures: Sequence[Gesture], voters: Sequence[ShapeVoter]
) -> tuple[_DrawingGroup, ...]:
    """Group the gestures that can be compared by their salient landmarks."""
    members: dict[tuple[str, ...], list[int]] = {}
    for index, gesture in enumerate(gestures):
        if gesture.salient and gesture.image.any():
            members.setdefault(gesture.salient, []).append(index)
    groups = []
    for salient, indices in members.items():
        descriptors = [_complete_descriptors(gestures[index], voters) for index in indices]
        references = {
            voter.name: np.stack([described[voter.name] for described in descriptors])
            for voter in voters
        }
        groups.append(_DrawingGroup(salient, np.array(indices), references))
    return tuple(groups)


def _complete_descriptors(gesture: Gesture, voters: Sequence[ShapeVoter]) -> dict[str, FloatArray]:
    """Return a gesture's descriptors, computing those that are not stored."""
    missing = [voter for voter in voters if voter.name not in gesture.descriptors]
    return dict(gesture.descriptors) | describe_drawing(gesture.drawing, missing)
