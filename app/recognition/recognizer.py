"""Recognition: a query is drawn like the references, described, compared, and put to the vote."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.recognition.errors import LanguageError, PoseError, RecognitionError
from app.recognition.gesture import Gesture, condensed
from app.recognition.language import Language
from app.recognition.poses import FloatArray, PoseSequence
from app.recognition.recognition_result import Recognition
from app.recognition.trajectory import Trajectory
from app.recognition.trajectory_image import draw
from app.recognition.voters import PAPER_VOTERS, Voter, describe

PROFILES: dict[str, tuple[Voter, ...]] = {"paper": PAPER_VOTERS}
"""The voters of each profile. ``paper``: the seven of the paper, majority vote, no rejection."""


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
        self._voters = PROFILES[profile]
        self._ballots = _ballots(language.gestures, self._voters)

    def recognize(self, poses: PoseSequence) -> Recognition:
        """Recognise the gesture in a recording without salutes.

        The query is drawn and described once per distinct set of salient keypoints in the
        language, whatever the number of gestures; the distances to all of them are array
        operations. Each voter votes for its nearest gesture. The gesture with most votes wins;
        among equals the one with the smallest mean relative distance (a voter's distance over
        its mean distance to all gestures), among those the first in the language.

        Raises
        ------
        PoseError
            When the recording shows nothing, or no landmark that a gesture needs moves in it.

        """
        trajectory = condensed(Trajectory.from_poses(poses))
        distances = np.full((len(self._voters), len(self.language.gestures)), np.inf)
        for ballot in self._ballots:
            self._judge(trajectory, ballot, distances)
        if not np.isfinite(distances).any():
            needed = sorted({name for ballot in self._ballots for name in ballot.salient})
            raise PoseError(
                f"nothing to compare: of the landmarks that the gestures of "
                f"{self.language.name!r} need ({', '.join(needed)}), none moves in this recording"
            )
        return self._counted(distances)

    def _judge(self, trajectory: Trajectory, ballot: _Ballot, distances: FloatArray) -> None:
        """Fill in the distances ``(V, G)`` to the gestures of one ballot."""
        if not set(ballot.salient) <= set(trajectory.landmarks):
            return
        query = trajectory.select(ballot.salient)
        if not np.isfinite(query.xy).all(axis=2).any(axis=0).all():
            return  # a salient keypoint is never seen
        descriptors = describe(draw(query), self._voters)
        for row, voter in enumerate(self._voters):
            if voter.name in descriptors:
                distances[row, ballot.members] = voter.distances(
                    descriptors[voter.name], ballot.references[voter.name]
                )

    def _counted(self, distances: FloatArray) -> Recognition:
        """Count the votes that follow from distances ``(V, G)``."""
        gestures = tuple(gesture.label for gesture in self.language.gestures)
        votes = {
            voter.name: int(row.argmin())
            for voter, row in zip(self._voters, distances, strict=True)
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
            voters=tuple(voter.name for voter in self._voters),
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


def _ballots(gestures: Sequence[Gesture], voters: Sequence[Voter]) -> tuple[_Ballot, ...]:
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


def _descriptors(gesture: Gesture, voters: Sequence[Voter]) -> dict[str, FloatArray]:
    """Return the stored descriptors, with those made now that the gesture lacks."""
    missing = [voter for voter in voters if voter.name not in gesture.descriptors]
    return dict(gesture.descriptors) | describe(gesture.drawing, missing)
