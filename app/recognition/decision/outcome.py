"""Outcome: whether a take is answered, asked back or rejected, and the confidence of its label.

A take is rejected by novelty detection (`choose_limit`, `is_rejected`). The fused score (`fusion`)
is relative to the language: 1 is as far as two of its gestures are. Novelty (Pimentel et al. 2014)
is the score divided by one limit for all gestures, and more for a take that is much smaller than
the gesture; above 1 the gesture is rejected. Where several people have shown the gestures, the
limit is measured: it is the quantile of the scores of one person's demonstrations among those of
the others (leave one person out). One person's demonstrations do not tell how other people's takes
differ; then the limit is a cautious constant. Held hand shapes have a limit of their own
(`hand_references`). A take between two gestures is answered with both, and the diver is asked
(`find_answer`).

Confidence is the probability that the label of a take is right (`estimate_confidence`). Profile
``full`` estimates it from the novelty and the score of the nearest gesture, and from how much
farther the second one is. Profile ``paper`` has the share of votes in its place (`majority_vote`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Final

import numpy as np
import numpy.typing as npt

from app.recognition.poses.sequence import FloatArray

NOVELTIES: Final = ("movement", "hand")
"""What may be too far from a gesture: its movement, or the shape of the hand."""

LIMIT_OF_ARMS: Final = 0.82
"""Limit of languages of whole arms that one person has shown: of what people do when they do not
sign, 5 % is accepted at most on every set left out (`benchmarks/studies/people.md`)."""

LIMIT_OF_HANDS: Final = 0.44
"""The same where no elbow is seen: the paths of hands differ less between people than arms do."""

MOST: Final = 1.0
"""Largest limit: a take that is farther is as far from its gesture as another gesture is."""

FEWEST: Final = 8
"""Least number of demonstrations that others have shown too from which a limit is measured."""

MOST_REFUSED: Final = 0.05
"""Default share of right takes that may be rejected."""

MOST_REFUSED_AT_ALL: Final = 0.5
"""Largest such share: beyond it a gesture is read once in two takes."""

ASK_RATIO: Final = 1.165
"""Largest ratio of a gesture's score to the nearest one's at which the take may be either
(`benchmarks/studies/rejection.md`, as the next two)."""

USUAL_NOVELTY: Final = 0.5
"""Novelty up to which `ASK_RATIO` holds where the second opinion is heard."""

FARTHER_EXPONENT: Final = 0.3
"""Exponent by which the ratio grows with the novelty beyond: a far take must be clearer."""


@dataclass(frozen=True, eq=False)
class OthersScores:
    """Scores of a language's demonstrations among those of other people.

    Attributes
    ----------
    people
        Number of people who have shown movements; those who are not named count as one.
    right
        ``(N,)``: of each demonstration for its own gesture as other people have shown it; only of
        those whose gesture others have shown.
    foreign
        ``(M,)``: of each demonstration the least score for the other gestures as other people have
        shown them: how near a gesture is that the language lacks.

    """

    people: int = 0
    right: FloatArray = field(default_factory=lambda: np.empty(0))
    foreign: FloatArray = field(default_factory=lambda: np.empty(0))

    @classmethod
    def of(
        cls,
        scores: FloatArray,
        taken: npt.NDArray[np.intp],
        owners: npt.NDArray[np.intp],
        divers: npt.NDArray[np.str_],
    ) -> OthersScores:
        """Find them in the scores of the demonstrations.

        Parameters
        ----------
        scores
            ``(N, R)``: of N demonstrations for R references; infinite where not comparable.
        taken
            ``(N,)``: the reference of each demonstration.
        owners, divers
            ``(R,)``: each reference's gesture, and who has shown it.

        """
        people = len(np.unique(divers))
        if people < 2:
            return cls(people)
        by_others = divers[taken][:, None] != divers
        same = owners[taken][:, None] == owners
        right, foreign = (
            np.where(by_others & which, scores, np.inf).min(axis=1, initial=np.inf)
            for which in (same, ~same)
        )
        return cls(people, right[np.isfinite(right)], foreign[np.isfinite(foreign)])

    @property
    def suffice(self) -> bool:
        """Whether they are enough to measure the limit."""
        return len(self.right) >= FEWEST


def choose_limit(others: OthersScores, refused: float, *, arms: bool, alike: float = 1.0) -> float:
    """Choose the limit of a language.

    Parameters
    ----------
    others
        Scores of the demonstrations among those of other people.
    refused
        Share of right takes that may be rejected.
    arms
        Whether elbows are seen.
    alike
        Factor >= 1 on the constant in a language whose gestures are more alike than usual: people
        do not differ less for that.

    """
    if others.suffice:
        return min(MOST, float(np.quantile(others.right, 1.0 - refused)))
    return alike * (LIMIT_OF_ARMS if arms else LIMIT_OF_HANDS)


def is_rejected(novelty: float) -> bool:
    """Return whether a gesture is rejected; profile ``paper`` (NaN) never rejects."""
    return novelty > 1.0


def find_answer(
    scores: FloatArray, novelty: FloatArray, opinion: int | None = None
) -> tuple[int, ...]:
    """Find the gestures that a take may be: one is the label, two a pair; else none.

    The table that decides, in `docs/recognizer.md`.

    Parameters
    ----------
    scores
        ``(G,)``, smaller = more alike, infinite where not comparable; one of them finite.
    novelty
        ``(G,)``, above 1: rejected; NaN where nothing is rejected.
    opinion
        Index of the second opinion's nearest gesture; None where it abstains.

    Returns
    -------
    Indices of the gestures, nearest first; empty where the nearest one is rejected.

    """
    order = np.argsort(scores, kind="stable").tolist()
    novel = float(novelty[order[0]])
    if is_rejected(novel):
        return ()
    farther = 1.0 if opinion is None else max(1.0, novel / USUAL_NOVELTY) ** FARTHER_EXPONENT
    alike, close = (
        tuple(index for index in order if scores[index] <= ratio * scores[order[0]])
        for ratio in (ASK_RATIO, ASK_RATIO * farther)
    )
    if opinion is not None and opinion in close[1:]:
        return order[0], opinion
    return alike if len(alike) > 2 else close[:2]


CONFIDENCE_AT_ZERO = 5.4
CONFIDENCE_PER_DISTANCE = -2.9
"""Coefficients of `estimate_confidence`, by `python -m benchmarks FOLDER --only confidence`; how
they differ without a set, and what else was tried: `benchmarks/studies/people.md`."""

SURE = 0.2
"""Least confidence of a take with a label, and largest of one that lies between gestures."""


def sum_distances(novelty: float, nearest: float, second: float) -> float:
    """Return the sum of three distances of the nearest gesture, each relative to another one.

    Novelty is relative to the limit, the score to the usual distance between two gestures, and the
    ratio of the scores to the second gesture.

    Parameters
    ----------
    novelty
        Novelty of the nearest gesture. NaN where nothing is rejected: then the score is
        used, which is about 1 for another gesture.
    nearest, second
        Scores by `fusion.fuse`. Without a second gesture `second` is infinite and counts as the
        typical distance 1.

    """
    far = novelty if math.isfinite(novelty) else nearest
    other = second if math.isfinite(second) else 1.0
    return far + nearest + (nearest / other if other else 1.0)


def estimate_confidence(novelty: float, nearest: float, second: float) -> float:
    """Estimate the probability that the nearest gesture is the one meant.

    ``1 / (1 + exp(-(b0 + b1 d)))`` for the sum d of `sum_distances`, whose parameters it has. The
    coefficients are a logistic regression on recorded takes, half of them out-of-vocabulary; the
    reliability table is in `docs/results.md`.
    """
    odds = CONFIDENCE_AT_ZERO + CONFIDENCE_PER_DISTANCE * sum_distances(novelty, nearest, second)
    # The exponent is at most 700, just below the overflow of a double.
    return 1.0 / (1.0 + math.exp(min(-odds, 700.0)))


def bound_confidence(confidence: float, answers: int, novelty: float) -> float:
    """Return a confidence of at least `SURE` with one answer, of at most `SURE` between several.

    Beyond the limit it stays as it is.
    """
    if answers == 1:
        return max(SURE, confidence)
    return confidence if is_rejected(novelty) else min(SURE, confidence)
