"""Simulated trials: recognises variants of every demonstration, to estimate error rates.

The variants come from `variation` and are recognised by the recogniser itself.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from app.recognition.decision.rejection import SCORE_FLOOR
from app.recognition.gestures.demonstration import condense
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.recognizer import Recognizer
from app.recognition.simulation.rate_estimate import RateEstimate
from app.recognition.simulation.variant_bias import VARIANT_BIASES, VariantBias
from app.recognition.simulation.variation import Person, draw_variants

WIDEST_MARGIN = 4.0
"""Largest margin; exp(4) is fifty times as far, also used for takes that cannot be compared."""

MOST_REMEMBERED = 32
"""Gestures whose takes are cached, half a megabyte each: remedies and previews simulate the same
gestures repeatedly beside an edited one."""


@dataclass(frozen=True, eq=False, kw_only=True)
class SimulatedTrials:
    """Scores and novelties of simulated takes.

    Attributes
    ----------
    gestures
        ``(P,)`` indices of the simulated gestures.
    scores
        ``(P, N, G)``: of N takes each the score of every gesture, smaller = more alike; infinite
        where not comparable.
    novelty
        ``(P, N)``: novelty of each take for its own gesture; above 1 it is rejected. NaN for a
        gesture without thresholds.
    bias
        The performer's entry of `VARIANT_BIASES`.

    """

    gestures: npt.NDArray[np.intp]
    scores: FloatArray
    novelty: FloatArray
    bias: VariantBias

    @property
    def margins(self) -> FloatArray:
        """``(P, N, G)``: margin of a take between its own gesture and each other one.

        The logarithm of the ratio of the scores; below 0 where the other one is nearer.
        """
        logarithms = np.log(np.minimum(self.scores, 1e9) + SCORE_FLOOR)
        own = np.take_along_axis(logarithms, self.gestures[:, None, None], axis=2)
        return np.asarray(np.clip(logarithms - own, -WIDEST_MARGIN, WIDEST_MARGIN))

    def confusion(self, performer: int, other: int) -> RateEstimate:
        """Estimate the rate of takes that are nearer to another given gesture.

        A take that shows something else is as near to any gesture.
        """
        astray = 1 / self.scores.shape[2]
        return RateEstimate.of_margins(self.margins[performer, :, other], self.bias, astray)

    def misread(self, performer: int) -> RateEstimate:
        """Estimate the rate of takes that are nearer to any other gesture."""
        astray = 1 - 1 / self.scores.shape[2]
        return RateEstimate.of_margins(self._to_rivals(performer), self.bias, astray)

    def refused(self, performer: int) -> RateEstimate:
        """Estimate the rate of takes that are rejected."""
        return RateEstimate.of_margins(self._to_refusal(performer), self.bias)

    def missed(self, performer: int) -> RateEstimate:
        """Estimate the rate of takes that are confused or rejected."""
        margins = np.minimum(self._to_rivals(performer), self._to_refusal(performer))
        return RateEstimate.of_margins(margins, self.bias)

    def _to_rivals(self, performer: int) -> FloatArray:
        """Return ``(N,)`` margins to the nearest other gesture."""
        rivals = np.delete(self.margins[performer], int(self.gestures[performer]), axis=1)
        return np.asarray(rivals.min(axis=1, initial=WIDEST_MARGIN))

    def _to_refusal(self, performer: int) -> FloatArray:
        """Return ``(N,)`` margins to the thresholds, as logarithms."""
        novelty = np.nan_to_num(self.novelty[performer], nan=0.0)
        margins = -np.log(np.maximum(novelty, np.exp(-WIDEST_MARGIN)))
        return np.asarray(np.maximum(margins, -WIDEST_MARGIN))


def simulate_trials(
    recognizer: Recognizer,
    count: int,
    *,
    gestures: Sequence[int] | None = None,
    seed: int = 0,
    person: Person = "another",
    advance: Callable[[], None] = lambda: None,
) -> SimulatedTrials:
    """Simulate takes of gestures and recognise them.

    Parameters
    ----------
    recognizer
        Of the language.
    count
        Takes of each gesture, at least 2.
    gestures
        Indices of the gestures; all that have a demonstration when not given.
    seed
        Of the variants. The n-th take of a gesture is the same in every language.
    person
        Who performs: the demonstrator, or another person.
    advance
        Called after each take; an exception that it raises ends the trials.

    """
    language = recognizer.language
    performed = [
        index
        for index in (range(len(language.gestures)) if gestures is None else gestures)
        if language.gestures[index].trajectory is not None
    ]
    scores = np.full((len(performed), count, len(language.gestures)), np.inf)
    novelty = np.full((len(performed), count), np.nan)
    for row, index in enumerate(performed):
        demonstration = language.gestures[index].trajectory
        assert demonstration is not None  # gestures without one are left out above
        for take, performed_take in enumerate(_perform(demonstration, count, seed, person)):
            compared = recognizer.compare(performed_take)
            scores[row, take] = compared.scores
            novelty[row, take] = compared.novelty[index]
            advance()
    return SimulatedTrials(
        gestures=np.array(performed, dtype=np.intp),
        scores=scores,
        novelty=novelty,
        bias=VARIANT_BIASES[person],
    )


@lru_cache(maxsize=MOST_REMEMBERED)
def _perform(
    demonstration: Trajectory, count: int, seed: int, person: Person
) -> tuple[Trajectory, ...]:
    """Return simulated takes of a demonstration, condensed."""
    takes = draw_variants(demonstration, count, seed=seed, person=person)
    return tuple(condense(take) for take in takes)
