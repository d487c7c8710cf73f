"""Calibration: each gesture's thresholds, without a recording more than its demonstration.

Plausible takes of the demonstration (`variation`) tell how far each voter's distances reach for
this gesture. Their logarithms spread alike for all gestures, so that one multiple of their
geometric mean, the voter's `REACH`, serves for all: other people's takes lie twice as far as the
demonstrator's own, and about one in twenty of them beyond it. Movements that mean nothing
(`foreign`) then pull the thresholds in, a little, when they would pass them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Final

import numpy as np

from app.recognition.decision.fused_vote import FusedVote
from app.recognition.decision.motion_references import (
    MAX_GESTURES_TRAVERSED,
    describe_movement,
)
from app.recognition.decision.rejection import build_novelty_weights, measure_novelty
from app.recognition.gestures.gesture import Gesture, Rates
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.simulation.negatives import draw_negatives
from app.recognition.simulation.rate_estimate import RateEstimate
from app.recognition.simulation.variant_bias import VARIANT_BIASES
from app.recognition.simulation.variation import SPREADS, draw_variants
from app.recognition.voters.registry import MOTION_VOTERS, VOTER_NAMES, VOTERS

TAKES = 12
"""Plausible takes drawn of each gesture: their mean is known to a quarter of its value."""

OWN = 0.75
"""How much of the typical distance is the gesture's own, the rest being that of any gesture
(`Voter.within`), geometrically: twelve takes of one demonstration know more than the average
over other gestures, but not all. From 0.7 to 1 the result is the same."""

REACH: Final[Mapping[str, float]] = MappingProxyType(
    {
        voter.name: voter.cue.reach
        for voter in sorted(VOTERS, key=lambda voter: -voter.cue.reach if voter.cue else 0.0)
        if voter.cue is not None
    }
)
"""Per voter with a cue its `Cue.reach`, the longest first, as thresholds stand in language files.
Over five recorded sets one in twenty of the demonstrator's takes lies beyond."""

LEAST_DISTANCE = 0.1
"""Least distance to a take, as a share of the typical one: where only one bone is seen, its
attitude may hardly differ."""

OTHERS = 2.0
"""How much farther other people's takes lie than the demonstrator's own, in squared distances:
variants by 1.9 to 2.1 times, recorded takes by 1.9 to 2.6."""

LEAST_SHARE = 0.9
"""How far foreign movements pull the thresholds in, at most: with 0.8, one in a hundred more of the
foreign movements is accepted at as many true ones refused."""

PLAUSIBLE = 0.2
"""Novelty below which a foreign movement is the gesture, whatever it was spliced from: about that
of a typical take, 1 / `REACH`."""

DIGITS = 4
"""Significant decimal digits kept of a threshold: far more than it is known to."""

RULE = repr((*REACH.items(), OWN, LEAST_SHARE, SPREADS["same"]))
"""What thresholds depend on beside the gestures: those by another rule are made anew."""


@dataclass(frozen=True, eq=False)
class _Reach:
    """How far plausible takes of the gestures lie.

    Attributes
    ----------
    thresholds
        ``(V, G)``: the multiples `REACH` of typical distances to further takes by the
        demonstrator; infinite for voters that no view asks.
    takes
        ``(G, TAKES)``: novelties of other people's; NaN for gestures without demonstration.

    """

    thresholds: FloatArray
    takes: FloatArray


def calibrate(gestures: Sequence[Gesture]) -> tuple[Gesture, ...]:
    """Give every gesture thresholds, and the rates of errors to expect with them.

    Gestures without a demonstration get none: they are never rejected. Of more than
    `MAX_GESTURES_TRAVERSED`, all get those of a typical gesture and no rates.

    Parameters
    ----------
    gestures
        Of one language, at least one.

    """
    vote = FusedVote(gestures)
    reach = _reach(gestures, vote)
    foreign = _foreign(gestures, vote, reach.thresholds)
    return tuple(
        replace(gesture, thresholds={}, rates=None)
        if gesture.trajectory is None
        else _with_thresholds(gesture, reach.thresholds[:, index], reach.takes[index], others)
        for index, (gesture, others) in enumerate(zip(gestures, foreign.T, strict=True))
    )


def _with_thresholds(
    gesture: Gesture, reach: FloatArray, takes: FloatArray, foreign: FloatArray
) -> Gesture:
    """Set the thresholds of one gesture.

    Parameters
    ----------
    gesture
        The gesture.
    reach
        ``(V,)`` thresholds as far as takes reach.
    takes, foreign
        Novelties with these thresholds, of other people's takes and of foreign movements; infinite
        for a foreign movement that is nearer to another gesture, NaN for what is not known.

    """
    near = foreign[foreign > PLAUSIBLE].min(initial=1.0)
    limit = max(LEAST_SHARE, float(near))
    thresholds = {
        voter: float(f"{limit * reach[VOTER_NAMES.index(voter)]:.{DIGITS}g}") for voter in REACH
    }
    if not np.isfinite(takes).all() or np.isnan(foreign).any():
        return replace(gesture, thresholds=thresholds, rates=None)
    margins = np.log(limit) - np.log(np.maximum(takes, 1e-9))
    rates = Rates(
        miss=round(RateEstimate.of_margins(margins, VARIANT_BIASES["another"]).rate, DIGITS),
        false_alarm=round(float((foreign < limit).mean()), DIGITS),
    )
    return replace(gesture, thresholds=thresholds, rates=rates)


def _reach(gestures: Sequence[Gesture], vote: FusedVote) -> _Reach:
    """Draw plausible takes of every gesture and measure how far they lie."""
    typical = np.array([voter.within for voter in VOTERS])
    cues = [voter.cue for voter in VOTERS]
    multiples = np.array([cue.reach if cue else np.inf for cue in cues])
    own = np.array([0.0 if cue and not cue.varies_by_gesture else OWN for cue in cues])
    farther = np.array([OTHERS**0.5 if cue and not cue.squared else OTHERS for cue in cues])
    weights = build_novelty_weights(VOTER_NAMES)
    thresholds = np.repeat((multiples * typical)[:, None], len(gestures), axis=1)
    takes = np.full((len(gestures), TAKES), np.nan)
    if len(gestures) > MAX_GESTURES_TRAVERSED:
        return _Reach(thresholds, takes)
    for row in vote.references.as_shown:
        index = int(vote.references.gestures[row])
        if index >= len(gestures):
            continue  # a mirror image varies as much as what it mirrors
        distances = _distances_to_takes(gestures[index], vote, int(row))
        known = np.isfinite(distances).all(axis=1)
        least = LEAST_DISTANCE * typical[known, None]
        mean = np.exp(np.log(np.maximum(distances[known], least)).mean(axis=1))
        thresholds[known, index] *= (mean / typical[known]) ** own[known]
        others = farther[:, None] * distances
        takes[index] = measure_novelty(others, thresholds[:, [index]], weights)
    return _Reach(thresholds, takes)


def _takes(demonstration: Trajectory) -> tuple[Trajectory, ...]:
    return demonstration.compute_once("variants", lambda: draw_variants(demonstration, TAKES))


def _distances_to_takes(gesture: Gesture, vote: FusedVote, row: int) -> FloatArray:
    """Compare a gesture as shown with `TAKES` plausible takes of it: ``(V, TAKES)``.

    Infinite for voters of drawings, which are slow to make and not asked.
    """
    assert gesture.trajectory is not None  # it has a row
    references = vote.references
    takes = [describe_movement(take, references.landmarks) for take in _takes(gesture.trajectory)]
    distances = np.full((len(VOTERS), TAKES), np.inf)
    for voter in MOTION_VOTERS:
        described = np.array([take[voter.name] for take in takes])
        shown = references.descriptors[voter.name][row]
        distances[VOTER_NAMES.index(voter.name)] = voter.distances(shown, described)
    return distances


def _foreign(gestures: Sequence[Gesture], vote: FusedVote, thresholds: FloatArray) -> FloatArray:
    """Measure how far foreign movements lie from the gesture they are nearest to.

    Returns
    -------
    ``(N, G)`` novelties, infinite for the gestures they are not nearest to. Where the
    landmarks of the gestures are of another body than the accidental movements', or there are
    more than `MAX_GESTURES_TRAVERSED` gestures, NaN: nothing is known.

    """
    if len(gestures) > MAX_GESTURES_TRAVERSED:
        return np.full((1, len(gestures)), np.nan)
    measuring = vote.with_thresholds(thresholds)
    found = []
    for movement in draw_negatives(gestures):
        compared = measuring.compare(movement, drawn=False)
        if np.isfinite(compared.scores).any():
            nearest = int(compared.scores.argmin())
            novelties = np.full(len(gestures), np.inf)
            novelties[nearest] = compared.novelty[nearest]
            found.append(novelties)
    return np.array(found) if found else np.full((1, len(gestures)), np.nan)
