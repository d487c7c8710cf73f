"""Outlook of one gesture in its language: quick enough to be asked while the gesture is edited."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.recognition.gestures.gesture import condensed
from app.recognition.health.check import TAKES, pair_health
from app.recognition.health.report import PairHealth
from app.recognition.health.simulated_trials import rehearse
from app.recognition.recognizer import Recognizer
from app.recognition.simulation.rate_estimate import Forecast

MOST_NEIGHBOURS = 3
"""Gestures rehearsed beside the one in question, the nearest: farther ones are hardly ever confused
with it, and all of a language would take as long as its whole health report."""


@dataclass(frozen=True)
class Outlook:
    """What is to be expected of one gesture.

    Attributes
    ----------
    pairs
        It and each of its nearest gestures, the nearest first.
    missed
        How often a take of it is read as another gesture, or refused.
    refused
        How often it is read as no gesture at all.

    """

    pairs: tuple[PairHealth, ...]
    missed: Forecast
    refused: Forecast


def outlook(recognizer: Recognizer, label: str) -> Outlook | None:
    """Rehearse one gesture and its nearest ones, as `check_health` rehearses all by default.

    Parameters
    ----------
    recognizer
        Of its language, profile ``full``.
    label
        The gesture's.

    Returns
    -------
    Its forecasts are those of the health report; None for a gesture without a demonstration.

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
            distances[index] = recognizer.compare(condensed(shown)).scores

    measure(own)
    others = [index for index in range(len(language.gestures)) if index != own]
    nearest = sorted(others, key=lambda index: distances[own, index])[:MOST_NEIGHBOURS]
    for index in nearest:
        measure(index)
    rehearsal = rehearse(recognizer, TAKES, gestures=(own, *nearest))
    pairs = (pair_health(language, (own, index), rehearsal, distances) for index in nearest)
    return Outlook(pairs=tuple(pairs), missed=rehearsal.missed(0), refused=rehearsal.refused(0))
