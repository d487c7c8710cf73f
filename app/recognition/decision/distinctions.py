"""Distinctions: the directions, sides and tempos that tell two gestures of a language apart."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.recognition.decision.references import References
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.registry import VOTER_NAMES

SAME_FIGURE = 0.25
"""Score below which two gestures are the same figure: that of two people's takes of one gesture. On
air-drawn digits and commands the accuracy falls beyond 0.4, when useful traversals are lost."""

TURNED = 0.2
"""Ratio of backward to forward score below which two figures are one in opposite directions, such
as two swipes."""

CLEARANCE = 0.63
"""Largest ratio of backward to forward score at which a direction matters: two circles with
different starting points are about as near either way."""

CLEARLY_SLOWER = 0.8
"""Doublings of the duration from which two gestures differ in tempo: 1.75 times as long. One
person's takes of a gesture differ by a quarter of a doubling, two people's by half."""


def find_tempo_dependent(references: References, scores: FloatArray) -> npt.NDArray[np.bool_]:
    """Return ``(S,)``: the demonstrations whose tempo counts, by their switch or automatically.

    The tempo counts automatically for two gestures that differ in duration only. Parameters as for
    `find_unambiguous_traversals`.
    """
    rows, owners = references.as_shown, references.row_owners
    count = len(scores)
    doublings = references.own_distances[VOTER_NAMES.index("tempo"), :count][:, rows]
    apart = owners[rows[:count]][:, None] != owners[rows]
    twins = (scores[:, rows] < SAME_FIGURE) & (doublings > CLEARLY_SLOWER) & apart
    switches = np.array([each.switches.tempo for each in references.shown])
    automatic = np.zeros(len(switches), dtype=bool)
    automatic[references.rows[rows]] = twins.any(axis=0)
    return np.asarray(np.where(switches == "auto", automatic, switches == "on"))


def find_unambiguous_traversals(references: References, scores: FloatArray) -> npt.NDArray[np.intp]:
    """Return the rows of the traversals by which no gesture is confused with another one.

    Backward traversals are left out when another gesture is the same figure in the opposite
    direction: for some starting points, the score with one of them reversed is below
    `SAME_FIGURE` or `TURNED` times the forward score, and also below `CLEARANCE` times the forward
    score. Exchanged sides are left out by the same rule. A direction that is switched off never
    counts.

    Parameters
    ----------
    references
        In all traversals.
    scores
        ``(N, R)`` of the first N demonstrated traversals for all rows, without penalties.

    """
    owners = references.row_owners
    scores = np.where(owners[references.as_shown[: len(scores)]][:, None] == owners, np.inf, scores)
    backward = np.array([each.backward for each in references.traversals], dtype=bool)
    exchanged = np.array([each.exchanged for each in references.traversals], dtype=bool)
    free = {
        owner
        for owner, each in zip(references.owners.tolist(), references.shown, strict=True)
        if each.switches.direction == "off"
    }
    keep = np.ones(len(references), dtype=bool)
    for owner in np.unique(owners).tolist():
        rows = owners == owner
        plain = scores[:, rows & ~backward & ~exchanged].min(axis=1)
        for otherwise, matters in ((backward, owner not in free), (exchanged, True)):
            turned = scores[:, rows & otherwise].min(axis=1, initial=np.inf)
            alike = np.maximum(SAME_FIGURE, TURNED * plain)
            if matters and ((turned < alike) & (turned < CLEARANCE * plain)).any():
                keep[rows & otherwise] = False
    return np.flatnonzero(keep)
