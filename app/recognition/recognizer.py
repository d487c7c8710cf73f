"""Recognition: a query is drawn like the references, described, compared, and put to the vote."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import replace

import numpy as np

from app.recognition.decision.fused_vote import CalibratedVote
from app.recognition.decision.rejection import VIEWS
from app.recognition.decision.result import Recognition
from app.recognition.decision.score_table import Comparison
from app.recognition.decision.shape_references import ShapeReferences
from app.recognition.decision.trace import Examination
from app.recognition.errors import LanguageError, PoseError
from app.recognition.gestures.gesture import condensed
from app.recognition.gestures.profile import voters_of
from app.recognition.gestures.switches import Counting
from app.recognition.gestures.tuning import Tuning
from app.recognition.language.language import Language
from app.recognition.poses.landmarks import other_side
from app.recognition.poses.sequence import FloatArray, PoseSequence
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.quality import fault
from app.recognition.preprocessing.repair import Repair, repaired
from app.recognition.voters import PAPER_VOTERS


class Recognizer:
    """Recognises the gestures of one language.

    Parameters
    ----------
    language
        At least one gesture. Profile ``full`` takes its thresholds from it, or makes them where
        they are missing or were made for other gestures; `language` then has them.
    profile
        One of `PROFILES`; the language's own when not given.
    tuning
        How it deviates from the profile; as the language says when not given
        (`Language.tuning_with`).

    Raises
    ------
    LanguageError
        When the language has no gestures.
    RecognitionError
        When there is no such profile, or the tuning does not fit it.

    """

    def __init__(
        self, language: Language, profile: str | None = None, *, tuning: Tuning | None = None
    ) -> None:
        profile = language.profile if profile is None else profile
        voters = voters_of(profile)
        if not language.gestures:
            raise LanguageError(f"language {language.name!r} has no gestures yet: add one", "")
        calibrating = profile == "full"
        tuning = language.tuning_with(profile) if tuning is None else tuning
        self.language = language.calibrated() if calibrating else language
        self.profile = profile
        self.tuning = tuning
        self._weights = tuning.weights_of(voters)
        gestures = self.language.gestures
        self._shapes = ShapeReferences(gestures, tuning.simplification)
        self._calibrated = CalibratedVote(gestures, tuning) if calibrating else None
        wanted = tuning.keypoints_repaired
        self.repairs = calibrating if wanted is None else wanted

    def recognize(self, poses: PoseSequence) -> Recognition:
        """Recognise the gesture in a recording without salutes.

        Profile ``paper``: each voter votes for its nearest gesture. The gesture with most votes
        wins; among equals the one with the smallest mean relative distance (a voter's distance
        over its mean distance to all gestures), among those the first in the language.
        Profile ``full``: the gesture with the smallest fused distance wins, see `fusion`, and is
        rejected where it is beyond its thresholds, see `rejection`.

        Where bad keypoints are repaired, the answer tells what was; a recording that is then still
        too poor to judge gets no label but the `fault`.

        Raises
        ------
        PoseError
            When the recording shows nothing, or no landmark that a gesture needs moves in it.

        """
        return self.examine(poses).result

    def examine(self, poses: PoseSequence) -> Examination:
        """Recognise as `recognize` does, and keep what led to the answer.

        Raises
        ------
        PoseError
            As `recognize`.

        """
        repair = repaired(poses) if self.repairs else None
        query = condensed(repair.trajectory if repair else Trajectory.from_poses(poses))
        comparison = self.compare(query)
        result = self.decided(comparison)
        if repair:
            poor, findings = self._fault(repair, result.nearest), repair.findings
            if poor or findings:
                label = None if poor else result.label
                result = replace(result, label=label, findings=findings, fault=poor)
        return Examination(query=query, comparison=comparison, result=result)

    def _fault(self, repair: Repair, nearest: str) -> str | None:
        """Tell why a recording is too poor to be the nearest gesture, whichever hand shows it."""
        gesture = self.language.gesture(nearest)
        poor = fault(repair.poses, gesture.salient, repair.trajectory)
        if poor and gesture.switches.mirror == "on":
            others = [other_side(name) for name in gesture.salient]
            poor = fault(repair.poses, others, repair.trajectory)
        return poor

    def query(self, poses: PoseSequence) -> Trajectory:
        """Return a recording as the voters see it: repaired or not, normalised and condensed.

        Raises
        ------
        PoseError
            When the recording shows nothing.

        """
        seen = repaired(poses).poses if self.repairs else poses
        return condensed(Trajectory.from_poses(seen))

    def recognize_trajectory(self, trajectory: Trajectory) -> Recognition:
        """Recognise the gesture in a `query`.

        Raises
        ------
        PoseError
            As `recognize`.

        """
        return self.decided(self.compare(trajectory))

    def decided(self, compared: Comparison) -> Recognition:
        """Decide what a comparison of this recogniser's means.

        Raises
        ------
        PoseError
            As `recognize`.

        """
        if not np.isfinite(compared.scores).any():
            needed = (self._calibrated or self._shapes).needed
            raise PoseError(
                f"nothing to compare: of the landmarks that the gestures of "
                f"{self.language.name!r} need ({', '.join(needed)}), none moves in this recording"
            )
        if self._calibrated is not None:
            return self._calibrated.decided(compared)
        return self._counted(compared.distances)

    @property
    def landmarks(self) -> tuple[str, ...]:
        """The landmarks that any gesture of the language follows, in alphabetical order."""
        if self._calibrated is not None:
            return self._calibrated.references.landmarks
        return self._shapes.needed

    def counting(self, label: str) -> Counting | None:
        """Tell what about a gesture counts in this language.

        None in profile ``paper``, and where the gesture was imported without its demonstration:
        then only drawings are compared, whatever the switches say.
        """
        if self._calibrated is None:
            return None
        return self._calibrated.counting(self.language.labels.index(label))

    def compare(self, trajectory: Trajectory) -> Comparison:
        """Take the comparison of a `query` with every gesture apart, voter by voter."""
        if self._calibrated is not None:
            return self._calibrated.compare(trajectory)
        distances = self._shapes.distances(trajectory)
        count = len(self.language.gestures)
        return Comparison(
            voters=tuple(voter.name for voter in PAPER_VOTERS),
            distances=distances,
            contributions=relative_contributions(distances, self._weights),
            turned=np.zeros(count),
            readings=(None,) * count,
            mirrored=np.zeros(count, dtype=bool),
            novelty_by_view=np.full((len(VIEWS), count), np.nan),
        )

    def _counted(self, distances: FloatArray) -> Recognition:
        """Count the votes that follow from distances ``(V, G)``."""
        gestures = tuple(gesture.label for gesture in self.language.gestures)
        votes = {
            voter.name: int(row.argmin())
            for voter, row in zip(PAPER_VOTERS, distances, strict=True)
            if np.isfinite(row).any()
        }
        voters = tuple(voter.name for voter in PAPER_VOTERS)
        weights = dict(zip(voters, (self._weights / self._weights.sum()).tolist(), strict=True))
        count: dict[int, float] = defaultdict(float)
        for voter, index in votes.items():
            count[index] += weights[voter]
        relative = relative_contributions(distances, self._weights).sum(axis=0)
        winner = min(count, key=lambda index: (-count[index], relative[index], index))
        return Recognition(
            label=gestures[winner],
            nearest=gestures[winner],
            confidence=(count[winner] / sum(count.values()) + _margin(relative, winner)) / 2,
            profile=self.profile,
            voters=voters,
            gestures=gestures,
            distances=distances,
            votes={voter: gestures[index] for voter, index in votes.items()},
            weights=weights,
            scores=relative,
            novelty=np.full(len(gestures), np.nan),
        )


def relative_contributions(distances: FloatArray, weights: FloatArray) -> FloatArray:
    """Bring voters with different units to one number per gesture, their sum.

    Parameters
    ----------
    distances
        ``(V, G)``, infinite where not comparable.
    weights
        ``(V,)``, 0: left out.

    Returns
    -------
    ``(V, G)``, whose sum over the voters is the mean relative distance: the weighted mean, over
    the voters that can compare anything, of a distance divided by that voter's mean over all
    comparable gestures. 1 = as far as the average gesture; infinite where not comparable.

    """
    comparable = np.isfinite(distances)
    voting = comparable.any(axis=1) & (weights > 0)
    if not voting.any():
        return np.full_like(distances, np.inf)
    sums = np.where(comparable, distances, 0.0).sum(axis=1)
    means = sums[voting] / comparable[voting].sum(axis=1)
    shares = weights[voting] / weights[voting].sum()
    contributions = np.zeros_like(distances)
    contributions[voting] = distances[voting] * (shares / np.where(means > 0, means, 1.0))[:, None]
    return contributions


def _margin(relative: FloatArray, winner: int) -> float:
    """Return 1 - (the winner's distance over the nearest other's), 0 where the other is nearer."""
    nearest_other = float(np.delete(relative, winner).min(initial=np.inf))
    if relative[winner] >= nearest_other:
        return 0.0
    return 1.0 - float(relative[winner]) / nearest_other
