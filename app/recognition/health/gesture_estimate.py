"""Gesture estimate: predicted rates of one gesture, fast enough to update while it is edited."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from app.recognition.gestures.demonstration import condense
from app.recognition.health.check import TAKES, check_pairs
from app.recognition.health.neighbours import find_neighbours
from app.recognition.health.report import PairHealth
from app.recognition.health.simulated_trials import simulate_trials
from app.recognition.recognizer import Recognizer
from app.recognition.simulation.rate_estimate import RateEstimate

MOST_NEIGHBOURS = 3
"""Number of nearest gestures that are simulated with it; farther ones are hardly ever confused with
it, and all would take as long as the whole check."""


@dataclass(frozen=True)
class GestureEstimate:
    """Estimated rates of one gesture.

    Attributes
    ----------
    pairs
        It and each of its nearest gestures, the nearest first.
    missed
        Rate of its takes that are confused or rejected.
    refused
        Rate of its takes that are rejected.

    """

    pairs: tuple[PairHealth, ...]
    missed: RateEstimate
    refused: RateEstimate


def estimate_gesture(
    recognizer: Recognizer, label: str, *, advance: Callable[[], None] = lambda: None
) -> GestureEstimate | None:
    """Simulate trials of one gesture and its nearest ones, as `check_health` does for all.

    Parameters
    ----------
    recognizer
        Of its language, profile ``full``.
    label
        The gesture's.
    advance
        Called after each comparison; an exception that it raises ends the work.

    Returns
    -------
    The estimates equal those of the health report; None for a gesture without a demonstration.

    Raises
    ------
    LanguageError
        When the language has no such gesture.

    """
    language = recognizer.language
    if language.gesture(label).trajectory is None:
        return None
    own = language.labels.index(label)
    distances = np.full((len(language.gestures),) * 2, np.inf)

    def measure(index: int) -> None:
        shown = language.gestures[index].trajectory
        if shown is not None:
            distances[index] = recognizer.compare(condense(shown)).scores
        advance()

    measure(own)
    others = [index for index in find_neighbours(recognizer)[own].tolist() if index != own]
    nearest = sorted(others, key=lambda index: distances[own, index])[:MOST_NEIGHBOURS]
    for index in nearest:
        measure(index)
    trials = simulate_trials(recognizer, TAKES, gestures=(own, *nearest), advance=advance)
    pairs = (check_pairs(language, (own, index), trials, distances) for index in nearest)
    return GestureEstimate(pairs=tuple(pairs), missed=trials.missed(0), refused=trials.refused(0))
