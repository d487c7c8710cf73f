"""Rejection: novelty detection, which decides whether a take is a gesture of the language.

The fused score (`fusion`) is relative to the language: 1 is as far as two of its gestures are.
Novelty (Pimentel et al. 2014) is the score divided by one limit for all gestures, and more for a
take that is much smaller than the gesture; above 1 the gesture is rejected. Where several people
have shown the gestures, the limit is measured: it is the quantile of the scores of one person's
demonstrations among those of the others (leave one person out). One person's demonstrations do not
tell how other people's takes differ; then the limit is a cautious constant. Held hand shapes have a
limit of their own (`hand_references`).
"""

from __future__ import annotations

from typing import Final

import numpy as np

from app.recognition.poses.sequence import FloatArray

NOVELTIES: Final = ("movement", "hand")
"""What may be too far from a gesture: its movement, or the shape of the hand."""

LIMIT_OF_ARMS: Final = 0.82
"""Limit of languages of whole arms that one person has shown: of what people do when they do not
sign, 5 % is accepted at most on every set left out (`benchmarks/studies/people.md`)."""

LIMIT_OF_HANDS: Final = 0.48
"""The same where no elbow is seen: the paths of hands differ less between people than arms do."""

MOST: Final = 1.0
"""Largest limit: a take that is farther is as far from its gesture as another gesture is."""

FEWEST: Final = 8
"""Least number of demonstrations that others have shown too from which a limit is measured."""

MOST_REFUSED: Final = 0.05
"""Default share of right takes that may be rejected."""

MOST_REFUSED_AT_ALL: Final = 0.5
"""Largest such share: beyond it a gesture is read once in two takes."""

SCORE_FLOOR: Final = 0.02
"""Added to scores and novelties before the logarithm: below that of two takes by one careful
person."""


def choose_limit(others: FloatArray, refused: float, *, arms: bool, alike: float = 1.0) -> float:
    """Choose the limit of a language.

    Parameters
    ----------
    others
        ``(N,)`` scores of demonstrations, each for its own gesture as other people have shown it.
    refused
        Share of right takes that may be rejected.
    arms
        Whether elbows are seen.
    alike
        Factor >= 1 on the constant in a language whose gestures are more alike than usual: people
        do not differ less for that.

    """
    if len(others) >= FEWEST:
        return min(MOST, float(np.quantile(others, 1.0 - refused)))
    return alike * (LIMIT_OF_ARMS if arms else LIMIT_OF_HANDS)


def is_rejected(novelty: float) -> bool:
    """Return whether a gesture is rejected; profile ``paper`` (NaN) never rejects."""
    return novelty > 1.0
