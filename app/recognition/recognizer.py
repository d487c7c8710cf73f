"""Recogniser: compares a take with every gesture of a language and decides which one it is."""

from __future__ import annotations

from collections.abc import Collection, Sequence, Set
from dataclasses import replace

import numpy as np

from app.recognition.decision.fused_vote import FusedVote
from app.recognition.decision.majority_vote import MajorityVote
from app.recognition.decision.result import Recognition, ScoreTable, Trace
from app.recognition.errors import LanguageError, PoseError
from app.recognition.gestures.demonstration import condense
from app.recognition.gestures.profile import Tuning, find_profile
from app.recognition.gestures.switches import Sensitivity
from app.recognition.language.language import Language
from app.recognition.poses.landmarks import other_side
from app.recognition.poses.sequence import PoseSequence
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.holds import (
    MOST_HOLDS,
    Hold,
    describe_excess,
    find_holds,
    find_single_hold,
    keep_holds,
)
from app.recognition.preprocessing.moving_hands import find_moving_hands
from app.recognition.preprocessing.quality import QualityFault, QualityFaultKind, find_fault
from app.recognition.preprocessing.repair import Repair, repair_poses
from app.recognition.recording.recording import describe_unseen, find_pauses
from app.recognition.recording.segmentation import Take
from app.recognition.recording.trimming import Span
from app.recognition.triggers.trigger import mostly_hang
from app.recognition.voters.registry import HAND_VOTER_NAMES


class Recognizer:
    """Recognises the gestures of one language.

    Parameters
    ----------
    language
        At least one gesture.
    profile
        One of `PROFILES`; the language's own when not given. A language of nothing but imported
        images is recognised by ``paper``, because ``full`` compares demonstrations.
    tuning
        Changes to the profile; the language's own when not given
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
        if not language.gestures:
            raise LanguageError(f"language {language.name!r} has no gestures yet: add one", "")
        traits = find_profile(language.profile if profile is None else profile)
        if all(gesture.trajectory is None for gesture in language.gestures):
            traits = find_profile("paper")
        tuning = language.tuning_with(traits.name) if tuning is None else tuning
        self.language = language
        self.profile: str = traits.name
        self.tuning = tuning
        self.vote: FusedVote | MajorityVote = (
            FusedVote(language.gestures, tuning, language.most_refused)
            if traits.rejects
            else MajorityVote(language.gestures, tuning)
        )
        self._reads_hands = isinstance(self.vote, FusedVote) and any(
            gesture.is_held for gesture in language.gestures
        )
        self._reads_sequences = self._reads_hands and any(
            len(gesture.held_shapes) > 1 for gesture in language.gestures
        )
        counting = map(self.vote.sensitivity, range(len(self.language.gestures)))
        self._reads_moving_hands = any(each is not None and each.hand_shape for each in counting)
        wanted = tuning.keypoints_repaired
        self.repairs = traits.repairs_keypoints if wanted is None else wanted

    def without(self, left_out: Collection[tuple[str, int]]) -> Recognizer:
        """Return the recogniser of the language without some demonstrations, to read these.

        Parameters
        ----------
        left_out
            As in `Language.without_demonstrations`.

        Raises
        ------
        LanguageError
            When no gesture is left.

        """
        language = self.language.without_demonstrations(left_out)
        return Recognizer(language, self.profile, tuning=self.tuning)

    def recognize(self, poses: PoseSequence, unseen: Sequence[Span] = ()) -> Recognition:
        """Recognise the gesture in a take, that is, poses without salutes around them.

        Profile ``paper``: each voter votes for its nearest gesture. The gesture with most votes
        wins; among equals the one with the smallest mean relative distance (a voter's distance
        over its mean distance to all gestures), among those the first in the language.
        Profile ``full``: the gesture with the smallest fused distance wins, see `fusion`, and is
        rejected where it is beyond the limit, see `outcome`. A take that lies between two
        gestures is answered with the pair, see `asking`.

        Where keypoints are repaired, `findings` of the result list the repairs. Poses that are
        still of insufficient quality get no label, and `fault` gives the reason. The same applies
        to poses in which no hand is seen although the hand shape of the nearest gesture counts.
        Three hand shapes in sequence, more than a gesture has, are reported as a finding; none of
        them is compared. The same applies where a trigger may have been missed.

        Parameters
        ----------
        poses
            The stroke.
        unseen
            Spans of its take in which a trigger may have been missed.

        Raises
        ------
        PoseError
            When no landmark is seen, or when no landmark that a gesture needs moves and no hand
            holds a shape.

        """
        result = self.examine(poses).result
        if unseen:
            refused = _refuse(result, describe_unseen(unseen, self.language.trigger.noun), None)
            return refused.model_copy(update={"unseen": tuple(unseen)})
        findings = (*result.findings, *find_pauses(poses.time))
        return result.model_copy(update={"findings": findings})

    def recognize_take(self, take: Take) -> Recognition:
        """Recognise a take as `recognize` does; two more kinds of takes get no label.

        The gesture of a take that is not closed may be incomplete: the diver forgot the second
        trigger, or is not done. A take in which both arms hang most of the time, as they do not in
        the gesture, lies between two gestures: a trigger before it was not seen.

        Raises
        ------
        PoseError
            As `recognize`.

        """
        result = self.recognize(take.poses, take.unseen)
        noun = self.language.trigger.noun
        fault = result.fault
        if not take.closed:
            fault = fault or f"no second {noun} ended it"
        elif result.outcome != "rejected" and self._is_rest(take.untrimmed, result):
            fault = f"both arms hang most of the time, so that a {noun} was missed"
        else:
            return result
        return _refuse(result, fault, result.fault_kind)

    def _is_rest(self, poses: PoseSequence, result: Recognition) -> bool:
        """Return whether both arms mostly hang, as in no demonstration of the gestures named."""
        shown = (
            one.trajectory
            for label in (result.nearest, *(result.pair or ()))
            for one in self.language.gesture(label).single_demonstrations()
        )
        return mostly_hang(poses.landmarks, poses.xy) and not any(
            each is not None and mostly_hang(each.landmarks, each.xy) for each in shown
        )

    def examine(self, poses: PoseSequence) -> Trace:
        """Recognise as `recognize` does, and return the trace: query, score table and result.

        Raises
        ------
        PoseError
            As `recognize`.

        """
        repair, holds, query = self._prepare(poses)
        table = self.compare(query)
        many = f"the take shows {describe_excess(holds)}" if len(holds) > MOST_HOLDS else None
        if holds and not np.isfinite(table.scores).any():
            raise PoseError(f"nothing to compare: {many or self._describe_others(holds)}")
        result = self.decide(table)
        findings = repair.findings if repair else ()
        findings = (*findings, many) if many else findings
        poor = self._fault(repair, table, result.nearest) if repair else None
        poor = poor or self._find_unseen_shape(table, result.nearest)
        result = result.model_copy(update={"findings": findings})
        result = _refuse(result, poor.words, poor.kind) if poor else result
        return Trace(query=query, score_table=table, result=result)

    def _describe_others(self, holds: Sequence[Hold]) -> str:
        """Return how held hands differ from those of all gestures of the language, in words."""
        shown = "one hand shape is" if len(holds) == 1 else "two hand shapes in sequence are"
        number = len(holds[0].hands)
        return (
            f"{shown} held in this take, by {number} hand{'s' * (number > 1)}, and no gesture of "
            f"{self.language.name!r} has as many of both"
        )

    def _fault(self, repair: Repair, table: ScoreTable, nearest: str) -> QualityFault | None:
        """Return why poses are too poor to be the nearest gesture, with either hand; or None."""
        at = self.language.labels.index(nearest)
        gesture = table.find_nearest_demonstration(self.language.gestures, at)
        poor = find_fault(repair.poses, gesture.salient, repair.trajectory)
        if poor and gesture.switches.mirror == "on":
            others = [other_side(name) for name in gesture.salient]
            poor = find_fault(repair.poses, others, repair.trajectory)
        return poor

    def _find_unseen_shape(self, table: ScoreTable, nearest: str) -> QualityFault | None:
        """Return the fault that the hand whose shape counts is not seen, or None."""
        counting = self.sensitivity(nearest)
        if counting is None or not counting.hand_shape:
            return None
        at = self.language.labels.index(nearest)
        rows = [table.voters.index(voter) for voter in HAND_VOTER_NAMES]
        if np.isfinite(table.distances[rows, at]).all():
            return None
        unseen = "no hand is seen for long enough that keeps a shape"
        if twins := self._list_others(self.vote.shape_twins, at):
            names = " and ".join(map(repr, (nearest, *twins)))
            words = (
                f"{names} are the same movement, told apart by the hand shape, and {unseen}: show "
                f"the hand, or switch the hand shape off where it need not count"
            )
        else:
            words = f"the hand shape of {nearest!r} counts, and {unseen}: show the hand"
        return QualityFault("unseen_hand", words)

    def _list_others(self, pairs: Set[tuple[int, int]], gesture: int) -> list[str]:
        """Return the labels of the gestures that are in a pair with the given one."""
        others = {other for pair in pairs if gesture in pair for other in pair} - {gesture}
        return [self.language.labels[other] for other in sorted(others)]

    @property
    def undecided_twins(self) -> tuple[tuple[str, str], ...]:
        """Gestures of nearly the same movement, shown with different hands.

        Nobody has said whether that is on purpose: their switch `hand_shape` is automatic. Until
        then the hands do not count, and a robot asks back for both (`ask_undecided`).
        """
        labels, pairs = self.language.labels, sorted(self.vote.undecided_twins)
        return tuple((labels[one], labels[other]) for one, other in pairs)

    def ask_undecided(self, result: Recognition) -> Recognition:
        """Return a pair in place of a label that is one of `undecided_twins`.

        Of several others the nearest is named.
        """
        if result.label is None:
            return result
        labels = self.language.labels
        others = self._list_others(self.vote.undecided_twins, labels.index(result.label))
        if not others:
            return result
        other = min(others, key=lambda label: float(result.scores[labels.index(label)]))
        return result.model_copy(update={"label": None, "pair": (result.label, other)})

    def query(self, poses: PoseSequence) -> Trajectory:
        """Return the trajectory that voters compare: repaired if the profile does, and normalised.

        Raises
        ------
        PoseError
            When no landmark is seen.

        """
        return self._prepare(poses)[-1]

    def _prepare(self, poses: PoseSequence) -> tuple[Repair | None, tuple[Hold, ...], Trajectory]:
        """Return the repair if the profile repairs, the held hands, and the condensed query."""
        repair = repair_poses(poses) if self.repairs else None
        seen = repair.poses if repair else poses
        trajectory = repair.trajectory if repair else Trajectory.from_poses(poses)
        holds = self._find_holds(seen, trajectory)
        trajectory = keep_holds(trajectory, holds)
        if self._reads_moving_hands:
            trajectory = replace(trajectory, moving_hands=find_moving_hands(seen))
        return repair, holds, condense(trajectory)

    def _find_holds(self, poses: PoseSequence, trajectory: Trajectory) -> tuple[Hold, ...]:
        """Return the held hand shapes of a query, as many in sequence as the language needs."""
        if self._reads_sequences:
            return find_holds(poses, trajectory)
        return find_single_hold(poses, trajectory) if self._reads_hands else ()

    def recognize_trajectory(self, trajectory: Trajectory) -> Recognition:
        """Recognise the gesture in a `query`.

        Raises
        ------
        PoseError
            As `recognize`.

        """
        return self.decide(self.compare(trajectory))

    def decide(self, compared: ScoreTable) -> Recognition:
        """Decide on a score table of this recogniser.

        Raises
        ------
        PoseError
            As `recognize`.

        """
        if not np.isfinite(compared.scores).any():
            if self._reads_hands and not self.vote.needed:
                among = ", or two in sequence," if self._reads_sequences else ","
                raise PoseError(
                    f"nothing to compare: no hand is seen in this take that holds a shape{among} "
                    f"as the gestures of {self.language.name!r} do"
                )
            beside = ", and no hand is seen that holds a shape" if self._reads_hands else ""
            raise PoseError(
                f"nothing to compare: none of the landmarks that the gestures of "
                f"{self.language.name!r} need ({', '.join(self.vote.needed)}) moves in this take"
                f"{beside}"
            )
        return self.vote.decide(compared)

    @property
    def landmarks(self) -> tuple[str, ...]:
        """The salient landmarks of all gestures, in alphabetical order."""
        return self.vote.landmarks

    def sensitivity(self, label: str) -> Sensitivity | None:
        """Return which properties of a gesture count: direction, tempo, sides, hand shape.

        None in profile ``paper`` and for gestures imported without demonstration: there only
        drawings are compared, whatever the switches are.
        """
        return self.vote.sensitivity(self.language.labels.index(label))

    def compare(self, trajectory: Trajectory) -> ScoreTable:
        """Compare a `query` with every gesture, voter by voter."""
        return self.vote.compare(trajectory)


def _refuse(result: Recognition, fault: str, kind: QualityFaultKind | None) -> Recognition:
    """Return a recognition without label or pair, for a reason."""
    return result.model_copy(
        update={"label": None, "pair": None, "fault": fault, "fault_kind": kind}
    )
