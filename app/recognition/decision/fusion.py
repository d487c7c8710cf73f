"""Fusion: one score from the distances of all voters, and what is compared for it.

**Weights** (`weigh_voters`, `fuse`). A voter's distances are divided by its between-class distance,
so that 1 means "as different as two gestures of the language", whatever the voter's unit. Its
weight is

    weight = prior * max(0, 1 - within / between),

where `within` is its within-class distance, measured between two people's takes of one gesture
(`Voter.within`), and `between` its between-class distance, the median distance between two gestures
of this language. A voter whose between-class distance does not exceed its within-class distance
gets weight 0.

**Second opinion** (`add_second_opinion`). The score is a weighted mean, of which compressed
velocities are the largest part. The voter `second_opinion` compares the same rows by directions
alone. It fails on other takes, so that a take of which both say the same is more often right, and
one of which they differ is more often wrong.

**Distinctions** (`find_tempo_dependent`, `find_unambiguous_traversals`) are the directions, sides
and tempos that tell two gestures of a language apart.

**Virtual views** (`list_views`, `choose_turn`). A camera sees a gesture differently when the diver
is turned. A demonstration with depth is turned by the angle between the two divers, and compared as
the camera would see it then. Depth itself is never compared: the depth of a pose model is too noisy
for that.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np
import numpy.typing as npt

from app.recognition.decision.outcome import find_answer
from app.recognition.decision.references import References
from app.recognition.decision.result import ScoreTable
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.motion_voters import SecondOpinion
from app.recognition.voters.registry import VOTER_NAMES
from app.recognition.voters.voter import WeightedVoter

PAIRS_BEFORE = 1
"""Weight, in pairs of gestures, of the voter's general between-class distance: a language of two
has one pair, which may be alike by chance."""


def weigh_voters(
    voters: Sequence[WeightedVoter], own: Sequence[FloatArray], *, arms: bool
) -> tuple[FloatArray, FloatArray]:
    """Compute the weight of each voter in a language.

    Parameters
    ----------
    voters
        V voters.
    own
        Per voter all its finite distances between gestures of the language.
    arms
        Whether the elbows are seen.

    Returns
    -------
    ``(V,)`` weights, not normalised, and ``(V,)`` between-class distances, > 0.

    """
    weights, between = np.zeros(len(voters)), np.ones(len(voters))
    for index, (voter, distances) in enumerate(zip(voters, own, strict=True)):
        known = np.concatenate([distances, np.full(PAIRS_BEFORE, voter.between)])
        between[index] = float(np.median(known))
        apart = max(0.0, 1.0 - voter.within / max(between[index], 1e-9))
        weights[index] = voter.prior_for(arms=arms) * apart
    return weights, np.maximum(between, 1e-9)


def fuse(distances: FloatArray, weights: FloatArray, between: FloatArray) -> FloatArray:
    """Compute fused scores of distances ``(V, ...)``: the sums of `weigh_distances`.

    Returns
    -------
    The weighted mean of the relative distances: 0 for the same, about 1 for another gesture;
    infinite where no voter with a weight can compare.

    """
    return np.asarray(weigh_distances(distances, weights, between).sum(axis=0), dtype=np.float64)


def weigh_distances(distances: FloatArray, weights: FloatArray, between: FloatArray) -> FloatArray:
    """Compute each voter's contribution to the fused score.

    Returns
    -------
    The contributions, in the shape of `distances`, ``(V, ...)``: 0 where a voter has no weight or
    cannot compare; all infinite where no voter with a weight can compare.

    """
    shape = (-1,) + (1,) * (distances.ndim - 1)
    known = np.isfinite(distances)
    if known.all() and (whole := weights.sum()) > 0:
        return np.asarray(distances * (weights / (between * whole)).reshape(shape))
    known_weights = np.where(known, weights.reshape(shape), 0.0)
    relative = np.where(known, distances, 0.0) / between.reshape(shape)
    total = np.broadcast_to(known_weights.sum(axis=0), known_weights.shape)
    shares: FloatArray = np.full(known_weights.shape, np.inf)
    np.divide(known_weights * relative, total, out=shares, where=total > 0)
    return shares


OPINION_EXPONENT: Final = 0.2
"""Exponent of the second opinion's ratios, where the score's own ratios have 1; also its weight
beside that of all other voters (`benchmarks/studies/rejection.md`)."""

DISTANCE_FLOOR: Final = 0.02
"""Added to the second opinion's distances before their ratio: below the distance of two takes by
one careful person."""

ORDER_RATIO: Final = 1.05
"""Largest ratio of a score to the smallest one at which the second opinion may make it the nearest.
"""

AGREED: Final = 1.15
"""Factor of the limit for the gesture that is nearest by the second opinion too, in a clear take.
"""


def add_second_opinion(table: ScoreTable, factor: float) -> ScoreTable:
    """Let the second opinion add its part to the scores, and release a clear take that it names.

    A score is multiplied by the ratio of the second opinion's distance to its smallest one, to the
    power of `OPINION_EXPONENT`. It chooses among the gestures within `ORDER_RATIO`; no other
    becomes the nearest. What it adds is its contribution.

    Parameters
    ----------
    table
        Without its part.
    factor
        On the exponent, by the language's tuning.

    Returns
    -------
    Where it abstains, with `factor` 0, and where fewer than two gestures are comparable, the table
    with all its distances infinite.

    """
    row, scores = table.voters.index(SecondOpinion.name), table.scores
    known, opinion = np.isfinite(scores), table.distances[row]
    if not factor or known.sum() < 2 or not np.isfinite(opinion[known]).all():
        silent = np.arange(len(table.distances))[:, None] == row
        return replace(table, distances=np.where(silent, np.inf, table.distances))
    ratios = (opinion[known] + DISTANCE_FLOOR) / (opinion[known].min() + DISTANCE_FLOOR)
    apart = scores[known] * ratios ** (OPINION_EXPONENT * factor)
    near = scores[known] <= ORDER_RATIO * scores[known].min()
    apart[~near] = np.maximum(apart[~near], ORDER_RATIO * apart[near].min())
    contributions, novelty = table.contributions.copy(), table.novelty_by_view.copy()
    contributions[row, known] += apart - scores[known]
    named = int(opinion.argmin())
    novelty[0, named] /= AGREED
    heard = replace(table, contributions=contributions)
    released = replace(heard, novelty_by_view=novelty)
    answer = find_answer(released.scores, released.novelty, named)
    return released if answer == (named,) else heard


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


STEP = 30
"""Degrees between views: DTW tolerates the up to 15 degrees from the nearest view; steps of 15
degrees changed no result by more than sampling error (`benchmarks/studies/views.md`)."""

FARTHEST = 60
"""Largest turn of a view in degrees: beyond, one shoulder hides the other."""

PRECISION = 10
"""Degrees to which the query's turn is rounded: about the precision of a pose model's depth, so
that a dive has few views."""

SIDEWAYS = 105
"""Degrees from which a diver counts as not turned: seen from behind, left and right are uncertain.
"""


def list_views(references: References, facing: float | None) -> list[References]:
    """Return the references as seen in the views that a query is compared with.

    Parameters
    ----------
    references
        As demonstrated.
    facing
        `Trajectory.facing` of the query. Where it is None but demonstrations have depth, all turns
        are listed, because the diver may face any direction.

    """
    trajectories = [each.trajectory for each in references.shown]
    facings = [None if each is None else each.facing for each in trajectories]
    if all(each is None for each in facings):
        return [references]
    if facing is not None:
        rounded = PRECISION * round(facing / PRECISION)
        return [references.turn([choose_turn(rounded, each) for each in facings])]
    return [
        references.turn([0 if each is None else turn for each in facings])
        for turn in sorted(range(-FARTHEST, FARTHEST + 1, STEP), key=abs)
    ]


def choose_turn(query: float, reference: float | None) -> int:
    """Return the degrees by which a reference is turned to face as a query does.

    Parameters
    ----------
    query, reference
        Degrees by which each is turned from the camera; None: not known.

    """
    if reference is None:
        return 0
    between = (query - reference + 180.0) % 360.0 - 180.0
    if abs(between) > SIDEWAYS:
        return 0
    return int(np.clip(round(between / STEP) * STEP, -FARTHEST, FARTHEST))
