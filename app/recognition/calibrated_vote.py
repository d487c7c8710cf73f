"""Profile ``full``: all voters, each with the say that the language gives it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.recognition.fusion import fused, says
from app.recognition.gesture import Gesture
from app.recognition.motion_references import (
    MAX_GESTURES_READ_OTHERWISE,
    MotionReferences,
    describe_movement,
    unambiguous,
)
from app.recognition.poses import FloatArray
from app.recognition.recognition_result import Recognition
from app.recognition.shape_references import ShapeReferences
from app.recognition.trajectory import Trajectory
from app.recognition.voters import PAPER_VOTERS
from app.recognition.voters.motion import MOTION_VOTERS

VOTERS = (
    *(voter.name for voter in PAPER_VOTERS),
    *(voter.name for voter in MOTION_VOTERS),
)
_SHAPES = len(PAPER_VOTERS)


class CalibratedVote:
    """Fuses the distances of fourteen voters, after asking the language what each can tell apart.

    Parameters
    ----------
    gestures
        At least one.
    shapes
        The same gestures as drawings.

    """

    def __init__(self, gestures: Sequence[Gesture], shapes: ShapeReferences) -> None:
        self._labels = tuple(gesture.label for gesture in gestures)
        thinkable = MotionReferences.of(gestures)
        asked = thinkable.as_shown[:MAX_GESTURES_READ_OTHERWISE]
        own = thinkable.own_distances(asked)
        pairs = own[:, :, asked][:, *np.triu_indices(len(asked), 1)]
        self._say, self._between = says(
            VOTERS,
            [
                *shapes.own_distances(MAX_GESTURES_READ_OTHERWISE),
                *(row[np.isfinite(row)] for row in pairs),
            ],
            len(thinkable.landmarks),
        )
        self._motions = thinkable
        if len(asked) == len(thinkable.as_shown):
            self._motions = unambiguous(thinkable, own, *self._of_motion)

    @property
    def _of_motion(self) -> tuple[FloatArray, FloatArray]:
        """Say and typical distance of the motion voters alone."""
        return self._say[_SHAPES:], self._between[_SHAPES:]

    def recognize(self, trajectory: Trajectory, shape_distances: FloatArray) -> Recognition:
        """Recognise a query.

        Parameters
        ----------
        trajectory
            The condensed query.
        shape_distances
            ``(7, G)`` of the paper's voters, some finite.

        """
        count = len(self._labels)
        comparable = np.isfinite(shape_distances).any(axis=0)
        motion = np.full((len(MOTION_VOTERS), count), np.inf)
        penalty = np.ones(count)
        if len(self._motions) and len(trajectory) > 1:
            query = describe_movement(trajectory, self._motions.landmarks)
            motion, penalty = self._motions.nearest(
                self._motions.distances(query), *self._of_motion, count
            )
        distances = np.concatenate([shape_distances, motion])
        distances[:, ~comparable] = np.inf
        scores = fused(distances, self._say, self._between) * penalty
        winner = int(scores.argmin())
        votes = {
            voter: int(row.argmin())
            for voter, row, say in zip(VOTERS, distances, self._say, strict=True)
            if say > 0 and np.isfinite(row).any()
        }
        return Recognition(
            label=self._labels[winner],
            nearest=self._labels[winner],
            confidence=self._confidence(scores, winner, votes),
            profile="full",
            voters=VOTERS,
            gestures=self._labels,
            distances=distances,
            votes={voter: self._labels[index] for voter, index in votes.items()},
        )

    def _confidence(self, scores: FloatArray, winner: int, votes: dict[str, int]) -> float:
        """Average the winner's share of the say and its margin over the nearest other gesture."""
        say = dict(zip(VOTERS, self._say.tolist(), strict=True))
        total = sum(say[voter] for voter in votes)
        agreeing = sum(say[voter] for voter, index in votes.items() if index == winner)
        nearest_other = float(np.delete(scores, winner).min(initial=np.inf))
        margin = 1.0 - float(scores[winner]) / nearest_other if nearest_other > 0 else 0.0
        return (agreeing / total + margin) / 2 if total else margin / 2
