"""Recognition: a query is drawn like the references, described, compared, and put to the vote."""

from __future__ import annotations

from collections import Counter

import numpy as np

from app.recognition.calibrated_vote import CalibratedVote
from app.recognition.errors import LanguageError, PoseError, RecognitionError
from app.recognition.gesture import condensed
from app.recognition.language import Language
from app.recognition.poses import FloatArray, PoseSequence
from app.recognition.recognition_result import Recognition
from app.recognition.shape_references import ShapeReferences
from app.recognition.sides import with_sides_repaired
from app.recognition.trajectory import Trajectory
from app.recognition.voters import PAPER_VOTERS, Voter
from app.recognition.voters.motion import MOTION_VOTERS, MotionVoter

PROFILES: dict[str, tuple[Voter | MotionVoter, ...]] = {
    "paper": PAPER_VOTERS,
    "full": (*PAPER_VOTERS, *MOTION_VOTERS),
}
"""The voters of each profile. ``paper``: the seven of the paper, majority vote, no rejection.
``full``: also the movement itself, by calibrated distances."""


class Recognizer:
    """Recognises the gestures of one language.

    Parameters
    ----------
    language
        At least one gesture.
    profile
        One of `PROFILES`.

    Raises
    ------
    LanguageError
        When the language has no gestures.
    RecognitionError
        When there is no such profile.

    """

    def __init__(self, language: Language, profile: str = "paper") -> None:
        if profile not in PROFILES:
            raise RecognitionError(
                f"no profile {profile!r}; this version has {', '.join(sorted(PROFILES))}"
            )
        if not language.gestures:
            raise LanguageError(f"language {language.name!r} has no gestures yet: add one", "")
        self.language = language
        self.profile = profile
        self._shapes = ShapeReferences(language.gestures)
        self._calibrated = CalibratedVote(language.gestures) if profile == "full" else None

    def recognize(self, poses: PoseSequence) -> Recognition:
        """Recognise the gesture in a recording without salutes.

        Profile ``paper``: each voter votes for its nearest gesture. The gesture with most votes
        wins; among equals the one with the smallest mean relative distance (a voter's distance
        over its mean distance to all gestures), among those the first in the language.
        Profile ``full``: the gesture with the smallest fused distance wins, see `fusion`.

        Raises
        ------
        PoseError
            When the recording shows nothing, or no landmark that a gesture needs moves in it.

        """
        trajectory = condensed(Trajectory.from_poses(poses))
        if self._calibrated is not None:
            result = self._calibrated.recognize(with_sides_repaired(trajectory))
            if result is None:
                raise self._nothing_moves(self._calibrated.needed)
            return result
        distances = self._shapes.distances(trajectory)
        if not np.isfinite(distances).any():
            raise self._nothing_moves(self._shapes.needed)
        return self._counted(distances)

    def _nothing_moves(self, needed: tuple[str, ...]) -> PoseError:
        return PoseError(
            f"nothing to compare: of the landmarks that the gestures of "
            f"{self.language.name!r} need ({', '.join(needed)}), none moves in this recording"
        )

    def _counted(self, distances: FloatArray) -> Recognition:
        """Count the votes that follow from distances ``(V, G)``."""
        gestures = tuple(gesture.label for gesture in self.language.gestures)
        votes = {
            voter.name: int(row.argmin())
            for voter, row in zip(PAPER_VOTERS, distances, strict=True)
            if np.isfinite(row).any()
        }
        count = Counter(votes.values())
        relative = mean_relative_distances(distances)
        winner = min(count, key=lambda index: (-count[index], relative[index], index))
        return Recognition(
            label=gestures[winner],
            nearest=gestures[winner],
            confidence=(count[winner] / len(votes) + _margin(relative, winner)) / 2,
            profile=self.profile,
            voters=tuple(voter.name for voter in PAPER_VOTERS),
            gestures=gestures,
            distances=distances,
            votes={voter: gestures[index] for voter, index in votes.items()},
        )


def mean_relative_distances(distances: FloatArray) -> FloatArray:
    """Bring voters with different units to one number per gesture.

    Parameters
    ----------
    distances
        ``(V, G)``, infinite where not comparable.

    Returns
    -------
    ``(G,)``: the mean, over the voters that can compare anything, of a distance divided by that
    voter's mean over all comparable gestures. 1 = as far as the average gesture; infinite where
    not comparable.

    """
    voting = distances[np.isfinite(distances).any(axis=1)]
    comparable = np.isfinite(voting)
    means = np.where(comparable, voting, 0.0).sum(axis=1) / comparable.sum(axis=1)
    relative = voting / np.where(means > 0, means, 1.0)[:, None]
    return np.asarray(relative.mean(axis=0), dtype=np.float64)


def _margin(relative: FloatArray, winner: int) -> float:
    """Return 1 - (the winner's distance over the nearest other's), 0 where the other is nearer."""
    nearest_other = float(np.delete(relative, winner).min(initial=np.inf))
    if relative[winner] >= nearest_other:
        return 0.0
    return 1.0 - float(relative[winner]) / nearest_other
