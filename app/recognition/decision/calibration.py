"""Calibration: computes each gesture's rejection thresholds from its demonstration alone.

The threshold of a voter is a multiple (`REACH`) of the geometric mean of its distances to simulated
takes (`variation`) and of its within-class distance, because the logarithms of distances have about
the same spread for all gestures. Other people's takes are about twice as far as the demonstrator's
own. Simulated out-of-vocabulary movements that would be accepted lower the thresholds a little.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from app.recognition.decision.fused_vote import FusedVote
from app.recognition.decision.hand_references import PALM_EXPONENT, HeldShapes, measure_mean_palm
from app.recognition.decision.motion_references import (
    MAX_GESTURES_TRAVERSED,
    describe_movement,
)
from app.recognition.decision.moving_shapes import OTHER_SHAPE, SAME_MOVEMENT
from app.recognition.decision.rejection import (
    CLEAR_SHARE,
    build_novelty_weights,
    compare_with_other,
    measure_novelty,
)
from app.recognition.gestures.gesture import Gesture, Rates
from app.recognition.poses.hand_shape import HandShape
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.simulation.out_of_vocabulary import draw_out_of_vocabulary
from app.recognition.simulation.rate_estimate import RateEstimate
from app.recognition.simulation.variant_bias import VARIANT_BIASES
from app.recognition.simulation.variation import SPREADS, draw_variants
from app.recognition.voters.registry import HAND_VOTERS, MOTION_VOTERS, VOTER_NAMES, VOTERS

TAKES = 12
"""Simulated takes of each gesture; their mean is accurate to a quarter of its value."""

OWN = 0.5
"""Weight of the gesture's own mean distance against that of all gestures (`Voter.within`), in the
geometric mean of both."""

REACH = 5.0
"""Ratio of a threshold to the typical distance of the demonstrator's own further takes.

Median over seven recorded sets of the ratio that one in twenty of other people's takes exceeds
(`benchmarks/studies/people.md`)."""

CUES: Final = tuple(voter.name for voter in VOTERS if voter.cue is not None)
"""Names of the voters with thresholds, in the order of language files."""

LEAST_DISTANCE = 0.1
"""Least distance to a take, as a share of the typical one: with only one bone seen, attitudes
hardly differ."""

HAND_REACH = 4.8
"""Ratio of a hand voter's threshold to the typical distance of the demonstrator's own further takes
(`Voter.within`), for a hand of `TYPICAL_PALM`: one in seventy out-of-vocabulary shapes is accepted
(`benchmarks/studies/hand-shapes.md`)."""

TYPICAL_PALM = 1.9
"""Palm in sizes of the hand (`HandShape.palm`), between an open hand's 1.6 and a fist's 2.5."""

OTHERS = 2.0
"""Ratio of squared distances of other people's takes to the demonstrator's own: 1.9 to 2.1 for
variants, 1.9 to 2.6 for recorded takes."""

LEAST_SHARE = 0.9
"""Least factor by which out-of-vocabulary movements lower the thresholds: at equal rejections, 0.8
accepts one in a hundred more of them (`benchmarks/studies/rejection.md`)."""

PLAUSIBLE = 0.2
"""Novelty below which a simulated out-of-vocabulary movement counts as the gesture itself: about
the novelty of a typical take, 1 / `REACH`."""

DIGITS = 4
"""Significant digits of a threshold, far more than its accuracy."""

HAND_RULE = repr(
    (HAND_REACH, TYPICAL_PALM, PALM_EXPONENT, *(voter.within for voter in HAND_VOTERS))
)
"""Settings that thresholds of held hand shapes depend on, beside the hands."""

MOVING_HAND_RULE = repr((HAND_RULE, SAME_MOVEMENT, OTHER_SHAPE))
"""Settings that thresholds of moving hands depend on, beside the hands."""

RULE = repr((*CUES, REACH, OWN, LEAST_SHARE, SPREADS["same"], CLEAR_SHARE))
"""Settings that thresholds depend on, beside the gestures; thresholds of other settings are
computed again."""


@dataclass(frozen=True, eq=False)
class _Reach:
    """Distances of simulated takes from the gestures.

    Attributes
    ----------
    thresholds
        ``(V, G)``: the multiples `REACH` of typical distances to further takes by the
        demonstrator; infinite for voters in no cue group.
    takes
        ``(G, TAKES)``: novelties of other people's takes; NaN for gestures without demonstration.

    """

    thresholds: FloatArray
    takes: FloatArray


def calibrate(gestures: Sequence[Gesture]) -> tuple[Gesture, ...]:
    """Return the gestures with thresholds and estimated error rates.

    Gestures without a demonstration get none and are never rejected. In a language of more than
    `MAX_GESTURES_TRAVERSED` gestures, all get the thresholds of a typical one and no rates.

    Parameters
    ----------
    gestures
        Of one language, at least one.

    """
    vote = FusedVote(gestures)
    reach = _measure_reach(gestures, vote)
    movements = _measure_out_of_vocabulary(gestures, vote, reach.thresholds)
    return tuple(
        replace(gesture, thresholds={}, rates=None)
        if gesture.trajectory is None
        else replace(gesture, thresholds=_choose_hand_thresholds(gesture.held_shapes), rates=None)
        if gesture.is_held
        else _add_hand_thresholds(
            _set_thresholds(gesture, reach.thresholds[:, index], reach.takes[index], others),
            vote.find_counting_hands(index),
        )
        for index, (gesture, others) in enumerate(zip(gestures, movements.T, strict=True))
    )


def _add_hand_thresholds(gesture: Gesture, hands: Sequence[HandShape]) -> Gesture:
    """Return a movement with thresholds for its hand shape; unchanged where that does not count."""
    if not hands:
        return gesture
    thresholds = {**gesture.thresholds, **_choose_hand_thresholds([hands])}
    return replace(gesture, thresholds=thresholds)


def _choose_hand_thresholds(shapes: HeldShapes) -> dict[str, float]:
    """Return the thresholds of the hand shapes of a first demonstration."""
    reach = HAND_REACH * (measure_mean_palm(shapes) / TYPICAL_PALM) ** PALM_EXPONENT
    return {voter.name: float(f"{reach * voter.within:.{DIGITS}g}") for voter in HAND_VOTERS}


def _set_thresholds(
    gesture: Gesture, reach: FloatArray, takes: FloatArray, movements: FloatArray
) -> Gesture:
    """Return one gesture with thresholds and rates.

    Parameters
    ----------
    gesture
        The gesture.
    reach
        ``(V,)`` thresholds by the simulated takes alone.
    takes, movements
        Novelties with these thresholds, of other people's takes and of out-of-vocabulary movements;
        infinite for a movement that is nearer to another gesture, NaN if not known.

    """
    near = movements[movements > PLAUSIBLE].min(initial=1.0)
    limit = max(LEAST_SHARE, float(near))
    thresholds = {
        voter: float(f"{limit * reach[VOTER_NAMES.index(voter)]:.{DIGITS}g}") for voter in CUES
    }
    if not np.isfinite(takes).all() or np.isnan(movements).any():
        return replace(gesture, thresholds=thresholds, rates=None)
    margins = np.log(limit) - np.log(np.maximum(takes, 1e-9))
    rates = Rates(
        miss=round(RateEstimate.of_margins(margins, VARIANT_BIASES["another"]).rate, DIGITS),
        false_alarm=round(float((movements < limit).mean()), DIGITS),
    )
    return replace(gesture, thresholds=thresholds, rates=rates)


def _measure_reach(gestures: Sequence[Gesture], vote: FusedVote) -> _Reach:
    """Simulate takes of every gesture and measure their distances."""
    typical = np.array([voter.within for voter in VOTERS])
    multiples = np.array([np.inf if voter.cue is None else REACH for voter in VOTERS])
    weights = build_novelty_weights(VOTER_NAMES)
    thresholds = np.repeat((multiples * typical)[:, None], len(gestures), axis=1)
    takes = np.full((len(gestures), TAKES), np.nan)
    if len(gestures) > MAX_GESTURES_TRAVERSED:
        return _Reach(thresholds, takes)
    for row in vote.references.as_shown:
        index = int(vote.references.gestures[row])
        if index >= len(gestures):
            continue  # a further demonstration, or a mirror image: varies as much as its gesture
        distances = _distances_to_takes(gestures[index], vote, int(row))
        known = np.isfinite(distances).all(axis=1)
        least = LEAST_DISTANCE * typical[known, None]
        mean = np.exp(np.log(np.maximum(distances[known], least)).mean(axis=1))
        thresholds[known, index] *= (mean / typical[known]) ** OWN
        apart = OTHERS * distances
        takes[index] = measure_novelty(apart, thresholds[:, [index]], weights)
        takes[index] *= _measure_clearness(gestures[index], vote, index, apart)
    return _Reach(thresholds, takes)


def _measure_clearness(
    gesture: Gesture, vote: FusedVote, index: int, distances: FloatArray
) -> FloatArray:
    """Compute the clearness of takes ``(N,)`` by their ``(V, N)`` distances to their gesture.

    The other gestures are taken to be as far from a take as from the demonstration, because
    comparing every take with all of them would take G times as long.
    """
    assert gesture.trajectory is not None  # it has a row
    others = np.delete(vote.compare(gesture.trajectory, drawn=False).scores, index)
    scores = vote.fuse(distances)
    if not np.isfinite(others).any() or not np.isfinite(scores).all():
        return np.ones(distances.shape[1])
    return compare_with_other(scores, np.full_like(scores, others.min()))


def _draw_takes(demonstration: Trajectory) -> tuple[Trajectory, ...]:
    return demonstration.compute_once("variants", lambda: draw_variants(demonstration, TAKES))


def _distances_to_takes(gesture: Gesture, vote: FusedVote, row: int) -> FloatArray:
    """Compute the distances of a gesture to `TAKES` simulated takes of it: ``(V, TAKES)``.

    Infinite for shape voters, which are slow and not used in rejection.
    """
    assert gesture.trajectory is not None  # it has a row
    references = vote.references
    takes = [
        describe_movement(take, references.landmarks) for take in _draw_takes(gesture.trajectory)
    ]
    distances = np.full((len(VOTERS), TAKES), np.inf)
    for voter in MOTION_VOTERS:
        described = np.array([take[voter.name] for take in takes])
        shown = references.descriptors[voter.name][row]
        distances[VOTER_NAMES.index(voter.name)] = voter.distances(shown, described)
    return distances


def _measure_out_of_vocabulary(
    gestures: Sequence[Gesture], vote: FusedVote, thresholds: FloatArray
) -> FloatArray:
    """Measure the novelties of out-of-vocabulary movements for their nearest gestures.

    Returns
    -------
    ``(N, G)`` novelties, infinite for gestures that are not the nearest. NaN where the gestures
    use other landmarks than the simulated movements have, or there are more than
    `MAX_GESTURES_TRAVERSED` gestures.

    """
    if len(gestures) > MAX_GESTURES_TRAVERSED:
        return np.full((1, len(gestures)), np.nan)
    measuring = vote.with_thresholds(thresholds)
    found = []
    for movement in draw_out_of_vocabulary(gestures):
        compared = measuring.compare(movement, drawn=False)
        if np.isfinite(compared.scores).any():
            nearest = int(compared.scores.argmin())
            novelties = np.full(len(gestures), np.inf)
            novelties[nearest] = compared.novelty[nearest]
            found.append(novelties)
    return np.array(found) if found else np.full((1, len(gestures)), np.nan)
