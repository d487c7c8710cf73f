"""Explanations: what decided a recognition, why, and what would have corrected it.

An `Explanation` contains the vote breakdown: each voter's distances to, and contributions for, two
gestures (`VoterBreakdown`).
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Any, Final

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, computed_field

from app.recognition.decision.result import WRITTEN, Distance, Recognition, ScoreTable
from app.recognition.errors import LanguageError, OsgError
from app.recognition.explanation.alignment import Alignment, align
from app.recognition.explanation.blame import Blame, find_blame
from app.recognition.explanation.causes import Cause, CauseKind, find_causes
from app.recognition.explanation.context import KnownTakes, RecognitionContext
from app.recognition.explanation.counterfactuals import (
    Counterfactual,
    find_counterfactuals,
)
from app.recognition.explanation.transcript import (
    Line,
    Transcript,
    Words,
    say_line,
    tell_transcript,
)
from app.recognition.text.wording import list_some
from app.recognition.voters.registry import HAND_VOTERS, MOTION_VOTERS, PAPER_VOTERS


@dataclass(frozen=True, kw_only=True)
class VoterBreakdown:
    """One voter between two gestures: the expected one and the other.

    Attributes
    ----------
    voter, unit
        Its name, and what a distance of 1 means.
    weight
        Its weight, see `Recognition.weights`.
    vote
        Its nearest gesture; None where it can compare nothing.
    wrong
        Whether it has weight and votes for another gesture than the expected one.
    distance, other_distance
        To the expected gesture and to the other, in its unit; infinite where not comparable.
    share
        Its share of the expected gesture's score, in [0, 1]; 0 where it compares nothing.
    against
        Its contribution to the expected gesture's score minus that to the other's: positive if it
        is against the expected one. Summed over all voters, with `Explanation.turned`, this is the
        difference of the scores.

    """

    voter: str
    unit: str
    weight: float
    vote: str | None
    wrong: bool
    distance: Distance
    other_distance: Distance
    share: float
    against: Distance


def break_down_votes(
    table: ScoreTable,
    result: Recognition,
    expected: int,
    other: int | None,
) -> tuple[VoterBreakdown, ...]:
    """Break a recognition down by voter, those most against the expected gesture first.

    Parameters
    ----------
    table, result
        Score table and result of the recognition.
    expected, other
        Indices of the two gestures; without another one `against` is 0.

    """
    units = {voter.name: voter.unit for voter in (*PAPER_VOTERS, *MOTION_VOTERS, *HAND_VOTERS)}
    label = result.gestures[expected]
    given = []
    whole = max(float(table.contributions[:, expected].sum()), 1e-12)
    for row, voter in enumerate(result.voters):
        distances, shares = table.distances[row], table.contributions[row]
        vote = result.votes.get(voter)
        against = 0.0 if other is None else float(shares[expected]) - float(shares[other])
        given.append(
            VoterBreakdown(
                voter=voter,
                unit=units[voter],
                weight=result.weights[voter],
                vote=vote,
                wrong=voter in result.counted and vote != label,
                distance=float(distances[expected]),
                other_distance=math.inf if other is None else float(distances[other]),
                share=float(shares[expected]) / whole if math.isfinite(whole) else 0.0,
                against=0.0 if math.isnan(against) else against,
            )
        )
    return tuple(sorted(given, key=lambda each: -each.against))


UNFOLLOWED: Final = {CauseKind.keypoints_jumped, CauseKind.other_person, CauseKind.not_seen}
"""Causes for which neither the strokes nor the turn of the diver are those that were shown."""

MOST_TIMES: Final = 4
"""Frames that the numbers name by their time."""

CLEARLY_TURNED: Final = 15.0
"""Least degrees by which a diver is turned that the numbers tell."""


class Explanation(BaseModel):
    """What decided one recognition, and why.

    Attributes
    ----------
    profile
        The recogniser's.
    expected
        The gesture that should have been recognised.
    label, nearest, runner_up, confidence, between, disagreed
        The recognition as it was answered, see `Recognition`.
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
    breakdown
        The breakdown by voter, those most against the expected gesture first.
    facing
        Degrees by which the diver is turned from the camera, positive to the diver's own left; None
        where not known.
    turned
        Share of `score` minus `other_score` that comes from the penalties of traversals.
    alignments
        Alignments of the query's path with the expected gesture's and with the other one's.
    causes
        Why, the cause first; empty for a right recognition and without evidence.
    blame
        Demonstrations of the expected gesture that are at fault for the known takes.
    transcript
        The strokes of the take and of the expected gesture.
    counterfactuals
        Interventions that would have corrected the recognition, see `Counterfactuals.found`.
    tried
        Number of interventions that were tried.

    """

    model_config = ConfigDict(frozen=True, **WRITTEN)

    profile: str
    expected: str
    label: str | None
    nearest: str
    runner_up: str | None
    confidence: float
    between: Annotated[tuple[str, ...], Field(exclude=True)]
    disagreed: Annotated[bool, Field(exclude=True)]
    other: str | None
    score: Distance
    other_score: Distance
    novelty: Distance
    fault: str | None
    votes: dict[str, int]
    support: dict[str, float]
    breakdown: tuple[VoterBreakdown, ...]
    facing: float | None
    turned: Distance
    alignments: tuple[Alignment, ...]
    causes: tuple[Cause, ...]
    blame: tuple[Blame, ...]
    transcript: Transcript
    counterfactuals: tuple[Counterfactual, ...]
    tried: int

    @computed_field  # type: ignore[prop-decorator]
    @property
    def right(self) -> bool:
        """Whether the expected gesture was recognised."""
        return self.label == self.expected

    @computed_field  # type: ignore[prop-decorator]
    @property
    def margin(self) -> Distance:
        """How much nearer the expected gesture is than the other; negative: farther."""
        return self.other_score - self.score

    @computed_field  # type: ignore[prop-decorator]
    @property
    def pair(self) -> tuple[str, str] | None:
        """The two gestures between which the take lies; None where there are not two."""
        return (self.between[0], self.between[1]) if len(self.between) == 2 else None

    @property
    def cause(self) -> Cause | None:
        """The first cause; None where the recognition is right and without evidence."""
        return self.causes[0] if self.causes else None

    @computed_field  # type: ignore[prop-decorator]
    @property
    def sentence(self) -> str:
        """The cause and what the diver can do; without a cause what was shown and expected."""
        if self.right:
            return f"Read as {self.expected!r}, as expected."
        return self.causes[0].sentence if self.causes else self._say_strokes()

    @computed_field  # type: ignore[prop-decorator]
    @property
    def strokes(self) -> tuple[Line, ...]:
        """What was shown and what was expected, a line each; empty where it tells nothing.

        Without a cause they are the sentence. Beside a cause they are told where they differ, and
        where the take's could be followed.
        """
        known = self.transcript.shown and self.transcript.differs is not None
        if self.right or (self.causes and not (known and self._is_followed)):
            return ()
        lines = tell_transcript(self.transcript, self.expected)
        if self.transcript.differs is None and self.pair and self.expected in self.pair:
            other = self.pair[self.pair[0] == self.expected]
            return (*lines, (Words(text=f"{other!r} is about as near"),))
        return lines

    @property
    def _is_followed(self) -> bool:
        return UNFOLLOWED.isdisjoint(each.kind for each in self.causes)

    def _say_strokes(self) -> str:
        return " ".join(f"{say_line(line)}." for line in self.strokes)

    @computed_field  # type: ignore[prop-decorator]
    @property
    def details(self) -> tuple[str, ...]:
        """The numbers behind the sentence, as sentences of their own."""
        return tuple(self._list_details())

    def _list_details(self) -> Iterator[str]:
        if self.fault is not None:
            yield f"The keypoints are too poor to judge: {self.fault}."
        yield from self._list_distances()
        if self.causes and self.causes[0].share < 1:
            share = f"{self.causes[0].share:.0%}"
            yield f"Undoing the cause removes {share} of the distance beyond that of usual takes."
        if self.blame and self.cause and self.cause.kind is CauseKind.demonstration:
            first = self.blame[0]
            yield (
                f"Of {first.takes} known takes the change repairs {first.repaired} and breaks "
                f"{first.broken}."
            )
        if self.causes and self.strokes:
            yield self._say_strokes()
        if jumped := self.transcript.bridged:
            times = list_some([f"{each:.2f}" for each in jumped], MOST_TIMES)
            yield f"A hand jumped in {len(jumped)} frames, at {times} s; its path is bridged there."
        yield from (f"Also: {each.sentence}" for each in self.causes[1:3])
        if self._is_followed and self.facing is not None and abs(self.facing) >= CLEARLY_TURNED:
            side = "left" if self.facing > 0 else "right"
            yield f"The diver is turned {abs(self.facing):.0f} degrees to their {side}."
        yield f"Confidence in {self.nearest!r}: {self.confidence:.0%}."

    def _list_distances(self) -> Iterator[str]:
        if self.disagreed:
            yield f"The two ways of comparing disagree: by directions it is {self.between[1]!r}."
        if math.isfinite(self.score) and self.other is not None:
            yield (
                f"{self.expected!r} is at distance {self.score:.2f}, "
                f"{self.other!r} at {self.other_score:.2f}."
            )
        if not self.right and math.isfinite(self.novelty):
            far = f"{self.novelty:.2f} times as far as the limit allows"
            yield f"The take is {far if self.novelty > 1 else 'within the limit'}."

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON types; infinite values become None."""
        return self.model_dump(mode="json")


def explain(
    context: RecognitionContext, expected: str, *, with_counterfactuals: bool = True
) -> Explanation:
    """Explain one recognition.

    Parameters
    ----------
    context
        The recogniser and the take.
    expected
        The label that should have been recognised.
    with_counterfactuals
        Whether to search for counterfactuals, which takes most of the time.

    Raises
    ------
    OsgError
        When `expected` is no gesture of the language.
    PoseError
        When no landmark that a gesture needs moves in the take.

    """
    try:
        expected = context.language.gesture(expected).label
    except LanguageError as error:
        raise OsgError(str(error)) from None
    table, result = context.score_table, context.result
    at = result.gestures.index(expected)
    rival = result.nearest if result.nearest != expected else result.runner_up
    other = None if rival is None else result.gestures.index(rival)
    blame: tuple[Blame, ...] = ()
    if wanted := with_counterfactuals and result.label != expected:
        full = context.full_recognizer
        is_full = full is context.recognizer
        known = context.known_takes if is_full else KnownTakes(full, context.known)
        blame = find_blame(known, [expected])
    causes = find_causes(context, expected, blame if wanted else None)
    found: tuple[Counterfactual, ...] = ()
    tried = 0
    if wanted:
        faulty = any(each.kind is CauseKind.demonstration for each in causes)
        found, tried = find_counterfactuals(context, expected, blame, faulty=faulty)
    turned = 0.0
    if other is not None and np.isfinite(table.scores[[at, other]]).all():
        turned = float(table.turned[at] - table.turned[other])
    answered = ("profile", "label", "nearest", "runner_up", "confidence", "between", "disagreed")
    return Explanation(
        **{name: getattr(result, name) for name in (*answered, "fault", "support")},
        expected=expected,
        other=rival,
        score=float(table.scores[at]),
        other_score=math.inf if other is None else float(table.scores[other]),
        novelty=float(table.novelty[at]),
        votes=dict(Counter(result.counted.values()).most_common()),
        breakdown=break_down_votes(table, result, at, other),
        facing=table.facing,
        turned=turned,
        alignments=tuple(
            alignment
            for index in (at, other)
            if index is not None and (alignment := _align(context, index))
        ),
        causes=causes,
        blame=blame,
        transcript=context.compare_strokes(expected),
        counterfactuals=found,
        tried=tried,
    )


def _align(context: RecognitionContext, at: int) -> Alignment | None:
    """Align the query with a gesture as the recogniser compared them; None without movements."""
    table = context.score_table
    return align(
        context.trace.query,
        table.find_nearest_demonstration(context.language.gestures, at),
        context.recognizer.landmarks,
        table.traversals[at],
        mirrored=bool(table.mirrored[at]),
        start=float(context.poses.time[0]),
        demonstration=table.nearest_demonstration(at),
    )
