"""Vote breakdown: each voter's distances to, and contributions for, two gestures."""

from __future__ import annotations

import math
from dataclasses import dataclass

from app.recognition.decision.result import Distance, Recognition
from app.recognition.decision.score_table import ScoreTable
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
