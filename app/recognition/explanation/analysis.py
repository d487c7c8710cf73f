"""Recognition analysis: everything measured about one recognition for its explanation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from app.recognition.explanation.alignment import Alignment
from app.recognition.explanation.counterfactual_search import Counterfactuals
from app.recognition.explanation.differences import Difference
from app.recognition.explanation.vote_breakdown import VoterBreakdown


@dataclass(frozen=True, eq=False, kw_only=True)
class Analysis:
    """Everything measured about one recognition for its explanation.

    Attributes
    ----------
    profile
        The recogniser's.
    expected
        The gesture that should have been recognised.
    label, nearest, confidence, between
        The recognition, see `Recognition`.
    other
        The gesture that the expected one is compared with: the nearest one, or the runner-up where
        the expected one is nearest; None in a language of one gesture.
    score, other_score
        Scores of the expected gesture and of the other one, see `ScoreTable.scores`; infinite where
        not comparable.
    novelty
        Score of the query for the expected gesture, relative to the limit: above 1 it is rejected;
        NaN in profile ``paper``.
    fault
        Why the poses are too poor to recognise; None if they are not.
    votes
        By label the number of voters with weight that voted for it.
    support
        By label the total weight of these voters.
    verdicts
        The breakdown by voter, those most against the expected gesture first.
    facing
        Degrees by which the diver is turned from the camera, positive to the diver's own left; None
        where not known.
    view
        Degrees by which the expected gesture's demonstration was turned to be compared.
    turned
        Share of `score` minus `other_score` that comes from the penalties of traversals.
    alignments
        Alignments of the query with the expected gesture and with the other: of the paths, and in
        profile ``full`` of the postures.
    differences
        Differences between the query and the expected gesture, the largest share first; empty
        where the gesture has no demonstration.
    counterfactuals
        Interventions that would have corrected the recognition.

    """

    profile: str
    expected: str
    label: str | None
    nearest: str
    confidence: float
    between: tuple[str, ...]
    other: str | None
    score: float
    other_score: float
    novelty: float
    fault: str | None
    votes: Mapping[str, int]
    support: Mapping[str, float]
    verdicts: tuple[VoterBreakdown, ...]
    facing: float | None
    view: int
    turned: float
    alignments: tuple[Alignment, ...]
    differences: tuple[Difference, ...]
    counterfactuals: Counterfactuals

    @property
    def right(self) -> bool:
        """Whether the expected gesture was recognised."""
        return self.label == self.expected

    @property
    def lesson(self) -> Difference | None:
        """The difference to avoid when the gesture is shown again: that of the largest share."""
        if self.right:
            return None
        return max(self.differences, key=lambda each: each.share, default=None)

    @property
    def margin(self) -> float:
        """How much nearer the expected gesture is than the other; negative: farther."""
        return self.other_score - self.score
