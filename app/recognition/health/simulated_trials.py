"""Simulated trials: recognises variants of every demonstration, to estimate error rates.

The variants come from `variation` and are recognised by the recogniser itself.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
import numpy.typing as npt

from app.recognition.decision.fused_vote import FusedVote
from app.recognition.decision.rejection import SCORE_FLOOR
from app.recognition.gestures.demonstration import condense
from app.recognition.health.neighbours import find_neighbours
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.recognizer import Recognizer
from app.recognition.simulation.rate_estimate import RateEstimate
from app.recognition.simulation.variant_bias import VARIANT_BIASES, VariantBias
from app.recognition.simulation.variation import Person, draw_variants, take_turns

WIDEST_MARGIN = 4.0
"""Largest margin; exp(4) is fifty times as far, also used for takes that cannot be compared."""

DEPTH_ERROR = 0.1
"""Standard deviation of a landmark's depth as a pose model sees it, torso lengths: 5 cm."""

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
    rivals
        ``(P, K)``: the gestures that the takes of each one are compared with, in ascending order,
        itself among them; in a language that is not large all, K = G.
    count
        G, the number of gestures in the language.
    scores
        ``(P, N, K)``: of N takes each the score of every rival, smaller = more alike; infinite
        where not comparable.
    novelty
        ``(P, N)``: novelty of each take for its own gesture; above 1 it is rejected. NaN for a
        gesture that is not compared.
    bias
        The performer's entry of `VARIANT_BIASES`.

    """

    gestures: npt.NDArray[np.intp]
    rivals: npt.NDArray[np.intp]
    count: int
    scores: FloatArray
    novelty: FloatArray
    bias: VariantBias

    @cached_property
    def margins(self) -> FloatArray:
        """``(P, N, K)``: margin of a take between its own gesture and each rival.

        The logarithm of the ratio of the scores; below 0 where the other one is nearer.
        """
        logarithms = np.log(np.minimum(self.scores, 1e9) + SCORE_FLOOR)
        own = np.take_along_axis(logarithms, self._own[:, None, None], axis=2)
        return np.asarray(np.clip(logarithms - own, -WIDEST_MARGIN, WIDEST_MARGIN))

    @cached_property
    def _own(self) -> npt.NDArray[np.intp]:
        """``(P,)``: place of each simulated gesture among its rivals."""
        return np.asarray((self.rivals == self.gestures[:, None]).argmax(axis=1), dtype=np.intp)

    @cached_property
    def _performers(self) -> dict[int, int]:
        return {gesture: row for row, gesture in enumerate(self.gestures.tolist())}

    def performer(self, gesture: int) -> int | None:
        """Return the row of a gesture, None where it was not simulated."""
        return self._performers.get(gesture)

    def confusion(self, performer: int, other: int) -> RateEstimate | None:
        """Estimate the rate of takes that are nearer to another given gesture; None for no rival.

        A take that shows something else counts as equally near to all gestures.
        """
        rivals = self.rivals[performer]
        place = int(np.searchsorted(rivals, other))
        if place == len(rivals) or rivals[place] != other:
            return None
        return RateEstimate.of_margins(self.margins[performer, :, place], self.bias, 1 / self.count)

    def misread(self, performer: int) -> RateEstimate:
        """Estimate the rate of takes that are nearer to any other gesture."""
        astray = 1 - 1 / self.count
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
        rivals = np.delete(self.margins[performer], int(self._own[performer]), axis=1)
        return np.asarray(rivals.min(axis=1, initial=WIDEST_MARGIN))

    def _to_refusal(self, performer: int) -> FloatArray:
        """Return ``(N,)`` margins to the limit, as logarithms."""
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
    turned: int = 0,
) -> SimulatedTrials:
    """Simulate takes of gestures and recognise them.

    Parameters
    ----------
    recognizer
        Of the language.
    count
        Takes of each gesture, at least 2, of its demonstrations in turn.
    gestures
        Indices of the gestures; all that have a demonstration when not given.
    seed
        Of the variants. The n-th take of a gesture is the same in every language.
    person
        Who performs: the demonstrator, or another person.
    advance
        Called after each take; an exception that it raises ends the trials.
    turned
        Degrees by which the diver is turned from the demonstration (`Trajectory.turn`); the depth
        of the turned takes has a pose model's error.

    """
    language, vote = recognizer.language, recognizer.vote
    performed = [
        index
        for index in (range(len(language.gestures)) if gestures is None else gestures)
        if language.gestures[index].trajectory is not None
    ]
    every = find_neighbours(recognizer)
    rivals = every[performed]
    scores = np.full((len(performed), count, rivals.shape[1]), np.inf)
    novelty = np.full((len(performed), count), np.nan)
    for row, index in enumerate(performed):
        assert isinstance(vote, FusedVote)  # profile `full`
        among = vote if rivals.shape[1] == len(every) else vote.among(rivals[row])
        own = int(np.searchsorted(rivals[row], index))
        demonstrations = language.gestures[index].trajectories
        takes = take_turns([_perform(each, count, seed, person) for each in demonstrations])
        if turned:
            takes = _turn(takes, turned, seed)
        for take, performed_take in enumerate(takes):
            compared = among.compare(performed_take)
            scores[row, take] = compared.scores
            novelty[row, take] = compared.novelty[own]
            advance()
    return SimulatedTrials(
        gestures=np.array(performed, dtype=np.intp),
        rivals=rivals,
        count=len(every),
        scores=scores,
        novelty=novelty,
        bias=VARIANT_BIASES[person],
    )


def _turn(takes: Sequence[Trajectory], degrees: int, seed: int) -> tuple[Trajectory, ...]:
    """Turn takes with a depth error of `DEPTH_ERROR`, constant for each landmark of a take."""
    draws = np.random.default_rng([seed, degrees % 360])
    turned = []
    for take in takes:
        if take.depth is not None:
            error = DEPTH_ERROR * draws.standard_normal(len(take.landmarks))
            take = replace(take, depth=take.depth + error)
        turned.append(condense(take.turn(degrees)))
    return tuple(turned)


@lru_cache(maxsize=MOST_REMEMBERED)
def _perform(
    demonstration: Trajectory, count: int, seed: int, person: Person
) -> tuple[Trajectory, ...]:
    """Return simulated takes of a demonstration, condensed."""
    takes = draw_variants(demonstration, count, seed=seed, person=person)
    return tuple(condense(take) for take in takes)
