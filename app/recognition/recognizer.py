"""Recognition: a query is drawn like the references, described, compared, and put to the vote."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from app.recognition.decision.fused_vote import FusedVote
from app.recognition.decision.majority_vote import MajorityVote
from app.recognition.decision.result import Recognition
from app.recognition.decision.score_table import ScoreTable
from app.recognition.decision.trace import Trace
from app.recognition.decision.vote import Vote
from app.recognition.errors import LanguageError, PoseError
from app.recognition.gestures.gesture import Gesture, condense
from app.recognition.gestures.profile import ProfileName, find_profile
from app.recognition.gestures.switches import Sensitivity
from app.recognition.gestures.tuning import Tuning
from app.recognition.language.language import Language
from app.recognition.poses.landmarks import other_side
from app.recognition.poses.sequence import PoseSequence
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.quality import find_fault
from app.recognition.preprocessing.repair import Repair, repair_poses

_VOTES: Final[dict[ProfileName, Callable[[Sequence[Gesture], Tuning], Vote]]] = {
    "paper": MajorityVote,
    "full": FusedVote,
}


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
    OsgError
        When there is no such profile, or the tuning does not fit it.

    """

    def __init__(
        self, language: Language, profile: str | None = None, *, tuning: Tuning | None = None
    ) -> None:
        traits = find_profile(language.profile if profile is None else profile)
        if not language.gestures:
            raise LanguageError(f"language {language.name!r} has no gestures yet: add one", "")
        tuning = language.tuning_with(traits.name) if tuning is None else tuning
        self.language = language.calibrated() if traits.rejects else language
        self.profile: str = traits.name
        self.tuning = tuning
        self.vote = _VOTES[traits.name](self.language.gestures, tuning)
        wanted = tuning.keypoints_repaired
        self.repairs = traits.repairs_keypoints if wanted is None else wanted

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

    def examine(self, poses: PoseSequence) -> Trace:
        """Recognise as `recognize` does, and keep what led to the answer.

        Raises
        ------
        PoseError
            As `recognize`.

        """
        repair = repair_poses(poses) if self.repairs else None
        query = condense(repair.trajectory if repair else Trajectory.from_poses(poses))
        comparison = self.compare(query)
        result = self.decide(comparison)
        if repair:
            poor, findings = self._fault(repair, result.nearest), repair.findings
            if poor or findings:
                label = None if poor else result.label
                result = replace(result, label=label, findings=findings, fault=poor)
        return Trace(query=query, comparison=comparison, result=result)

    def _fault(self, repair: Repair, nearest: str) -> str | None:
        """Tell why a recording is too poor to be the nearest gesture, whichever hand shows it."""
        gesture = self.language.gesture(nearest)
        poor = find_fault(repair.poses, gesture.salient, repair.trajectory)
        if poor and gesture.switches.mirror == "on":
            others = [other_side(name) for name in gesture.salient]
            poor = find_fault(repair.poses, others, repair.trajectory)
        return poor

    def query(self, poses: PoseSequence) -> Trajectory:
        """Return a recording as the voters see it: repaired or not, normalised and condensed.

        Raises
        ------
        PoseError
            When the recording shows nothing.

        """
        seen = repair_poses(poses).poses if self.repairs else poses
        return condense(Trajectory.from_poses(seen))

    def recognize_trajectory(self, trajectory: Trajectory) -> Recognition:
        """Recognise the gesture in a `query`.

        Raises
        ------
        PoseError
            As `recognize`.

        """
        return self.decide(self.compare(trajectory))

    def decide(self, compared: ScoreTable) -> Recognition:
        """Decide what a comparison of this recogniser's means.

        Raises
        ------
        PoseError
            As `recognize`.

        """
        if not np.isfinite(compared.scores).any():
            raise PoseError(
                f"nothing to compare: of the landmarks that the gestures of "
                f"{self.language.name!r} need ({', '.join(self.vote.needed)}), none moves in "
                "this recording"
            )
        return self.vote.decide(compared)

    @property
    def landmarks(self) -> tuple[str, ...]:
        """The landmarks that any gesture of the language follows, in alphabetical order."""
        return self.vote.landmarks

    def sensitivity(self, label: str) -> Sensitivity | None:
        """Tell what about a gesture counts in this language.

        None in profile ``paper``, and where the gesture was imported without its demonstration:
        then only drawings are compared, whatever the switches say.
        """
        return self.vote.sensitivity(self.language.labels.index(label))

    def compare(self, trajectory: Trajectory) -> ScoreTable:
        """Compare a `query` with every gesture, voter by voter."""
        return self.vote.compare(trajectory)
