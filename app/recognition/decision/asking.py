"""Asking back: a take between two gestures is answered with both, and the diver is asked."""

from __future__ import annotations

from typing import Final

import numpy as np

from app.recognition.decision.rejection import is_rejected
from app.recognition.poses.sequence import FloatArray

ASK_RATIO: Final = 1.16
"""Largest ratio of a gesture's score to the nearest one's at which the take may be either."""


def find_answer(scores: FloatArray, novelty: FloatArray) -> tuple[int, ...]:
    """Find the gestures that a take may be: one is the label, two are a pair, more a rejection.

    Parameters
    ----------
    scores
        ``(G,)``, smaller = more alike, infinite where not comparable; one of them finite.
    novelty
        ``(G,)``, above 1: rejected; NaN where nothing is rejected.

    Returns
    -------
    Indices of the gestures, nearest first: those within `ASK_RATIO` of the nearest one that are not
    rejected themselves. Empty where the nearest one is rejected.

    """
    order = np.argsort(scores, kind="stable").tolist()
    if is_rejected(float(novelty[order[0]])):
        return ()
    limit = ASK_RATIO * float(scores[order[0]])
    return tuple(
        index
        for index in order
        if scores[index] <= limit and not is_rejected(float(novelty[index]))
    )
