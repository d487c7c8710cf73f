"""The gestures of a language as drawings, gathered by the keypoints that are drawn."""

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
from app.recognition.voters.shape.shape_voter import ShapeVoter, describe_drawing


@dataclass(frozen=True, eq=False)
class _Ballot:
    """All gestures with the same salient keypoints: one drawing of the query serves them.

    Attributes
    ----------
    salient
        Names of the keypoints.
    members
        Indices of the gestures in the language.
    references
        Per voter ``(len(members), D)`` descriptors.

    """

    salient: tuple[str, ...]
    members: npt.NDArray[np.intp]
    references: dict[str, FloatArray]


class ShapeReferences:
    """What a query's drawings are compared with, by the paper's seven voters.

    Parameters
    ----------
    gestures
        G gestures; those without an image or without salient keypoints match nothing.
    simplification
        Tolerance in pixels with which gestures and queries are drawn, see `draw`.

    """

    def __init__(self, gestures: Sequence[Gesture], simplification: float = SIMPLIFICATION) -> None:
        self._count = len(gestures)
        self._simplification = simplification
        if simplification != SIMPLIFICATION:
            gestures = [gesture.redraw(simplification) for gesture in gestures]
        self._ballots = _ballots(gestures, PAPER_VOTERS)

    @property
    def needed(self) -> tuple[str, ...]:
        """The landmarks that any gesture needs, in alphabetical order."""
        return tuple(sorted({name for ballot in self._ballots for name in ballot.salient}))

    def distances(self, trajectory: Trajectory) -> FloatArray:
        """Compare a query with all gestures.

        It is drawn and described once per distinct set of salient keypoints, whatever the number
        of gestures; the distances to all of them are array operations.

        Returns
        -------
        ``(7, G)``; infinite where the query lacks a salient keypoint, or does not move it.

        """
        distances = np.full((len(PAPER_VOTERS), self._count), np.inf)
        for ballot in self._ballots:
            _judge(trajectory, ballot, self._simplification, distances)
        return distances

    def own_distances(self, most: int) -> list[FloatArray]:
        """Measure, per voter, the distances between gestures with the same salient keypoints.

        Parameters
        ----------
        most
            Gestures with the same salient keypoints to compare; the first so many.

        """
        own: list[list[FloatArray]] = [[np.empty(0)] for _ in PAPER_VOTERS]
        for ballot in self._ballots:
            for row, voter in enumerate(PAPER_VOTERS):
                references = ballot.references[voter.name][:most]
                for index, reference in enumerate(references[:-1]):
                    own[row].append(voter.distances(reference, references[index + 1 :]))
        return [np.concatenate(parts) for parts in own]


def _judge(
    trajectory: Trajectory, ballot: _Ballot, simplification: float, distances: FloatArray
) -> None:
    """Fill in the distances ``(V, G)`` to the gestures of one ballot."""
    if not set(ballot.salient) <= set(trajectory.landmarks):
        return
    descriptors = trajectory.compute_once(
        ("drawing", ballot.salient, simplification),
        lambda: _described(trajectory.select(ballot.salient), simplification),
    )
    if descriptors:
        distances[:, ballot.members] = [
            voter.distances(descriptors[voter.name], ballot.references[voter.name])
            for voter in PAPER_VOTERS
        ]


def _described(query: Trajectory, simplification: float) -> dict[str, FloatArray]:
    """Draw and describe salient keypoints; nothing where one of them is never seen."""
    known = np.isfinite(query.xy)
    if not (known.all() or known.all(axis=2).any(axis=0).all()):
        return {}
    return describe_drawing(draw(query, simplification), PAPER_VOTERS)


def _ballots(gestures: Sequence[Gesture], voters: Sequence[ShapeVoter]) -> tuple[_Ballot, ...]:
    """Gather the gestures that can be compared by their salient keypoints."""
    members: dict[tuple[str, ...], list[int]] = {}
    for index, gesture in enumerate(gestures):
        if gesture.salient and gesture.image.any():
            members.setdefault(gesture.salient, []).append(index)
    ballots = []
    for salient, indices in members.items():
        descriptors = [_descriptors(gestures[index], voters) for index in indices]
        references = {
            voter.name: np.stack([described[voter.name] for described in descriptors])
            for voter in voters
        }
        ballots.append(_Ballot(salient, np.array(indices), references))
    return tuple(ballots)


def _descriptors(gesture: Gesture, voters: Sequence[ShapeVoter]) -> dict[str, FloatArray]:
    """Return the stored descriptors, with those made now that the gesture lacks."""
    missing = [voter for voter in voters if voter.name not in gesture.descriptors]
    return dict(gesture.descriptors) | describe_drawing(gesture.drawing, missing)
