"""Neighbours: the gestures of a large language that each gesture is compared with in a check.

To compare every simulated take with every gesture takes time that grows with the square of their
number. Beyond `MOST_TOGETHER` gestures, each is therefore tried among its nearest ones alone.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.recognition.decision.fused_vote import FusedVote
from app.recognition.decision.motion_references import MAX_GESTURES_TRAVERSED
from app.recognition.poses.sequence import FloatArray
from app.recognition.recognizer import Recognizer
from app.recognition.voters.motion.velocity import Velocity

MOST_TOGETHER = MAX_GESTURES_TRAVERSED
"""Most gestures that are all compared with each other; the recogniser itself changes there too."""

NEIGHBOURS = 24
"""Number of nearest gestures among which each one is tried in a larger language."""


def find_neighbours(recognizer: Recognizer) -> npt.NDArray[np.intp]:
    """Return the gestures that the takes of each one are compared with.

    The nearest are found by their velocities, step by step; the comparison itself uses all voters.

    Parameters
    ----------
    recognizer
        Of a language of G gestures, profile ``full``.

    Returns
    -------
    ``(G, K)`` indices in ascending order, each gesture itself among its own; K is G in a language
    of at most `MOST_TOGETHER` gestures.

    """
    count = len(recognizer.language.gestures)
    if count <= MOST_TOGETHER:
        return np.tile(np.arange(count), (count, 1))
    apart = measure_step_distances(recognizer)
    np.fill_diagonal(apart, -1.0)
    nearest = np.argpartition(apart, NEIGHBOURS, axis=1)[:, : NEIGHBOURS + 1]
    return np.sort(nearest, axis=1)


def measure_step_distances(recognizer: Recognizer) -> FloatArray:
    """Return the distances of the gestures' velocities, ``(G, G)``; infinite without any."""
    vote = recognizer.vote
    count = len(recognizer.language.gestures)
    if not isinstance(vote, FusedVote):  # A language of pictures alone.
        return np.full((count, count), np.inf)
    references, rows = vote.references, vote.references.as_shown
    # References beyond the language's gestures are further demonstrations and mirror images.
    rows = rows[references.gestures[rows] < count]
    steps = np.nan_to_num(references.descriptors[Velocity.name][rows].reshape(len(rows), -1))
    squares = np.vecdot(steps, steps)
    between = squares[:, None] + squares - 2.0 * (steps @ steps.T)
    apart = np.full((count, count), np.inf)
    known = references.gestures[rows]
    apart[np.ix_(known, known)] = np.sqrt(np.maximum(between, 0.0))
    return apart
