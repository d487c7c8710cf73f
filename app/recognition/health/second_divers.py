"""Second divers: the gestures that another diver's demonstration would help most."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from app.recognition.gestures.gesture import Gesture
from app.recognition.health.finding import Finding
from app.recognition.health.report import MOST_MISSED, GestureHealth
from app.recognition.language.language import Language
from app.recognition.text.wording import join_words

MOST_NAMED = 3
"""Gestures named in the finding, the worst first: a dive's time for demonstrations is short."""


def advise_second_divers(
    language: Language, gestures: Sequence[GestureHealth]
) -> Iterator[Finding]:
    """Yield one finding that names the gestures in need of a second diver's demonstration.

    These are the gestures shown by one diver, of which more takes by other people are missed than
    the threshold allows. Simulated takes vary about the given demonstration, so that the effect of
    a second one cannot be simulated; the gestures are ordered by their missed takes.

    Parameters
    ----------
    language
        The language.
    gestures
        The estimates of its gestures, in its order, with another person as the performer.

    """
    missed = [
        (health.missed.rate, health.label)
        for gesture, health in zip(language.gestures, gestures, strict=True)
        if health.missed is not None
        and health.missed.rate > MOST_MISSED
        and _is_shown_by_one_diver(gesture)
    ]
    worst = [label for _, label in sorted(missed, key=lambda each: -each[0])[:MOST_NAMED]]
    if worst:
        yield Finding(
            "one_diver",
            tuple(worst),
            f"a second diver's demonstration would help most for {join_words(worst)}: people show "
            "a gesture differently, and two demonstrations cover more of that than one",
        )


def _is_shown_by_one_diver(gesture: Gesture) -> bool:
    """Return whether all demonstrations are by one diver; of several, unnamed divers differ."""
    shown = gesture.single_demonstrations()
    divers = {each.diver for each in shown}
    return len(shown) == 1 or (len(divers) == 1 and "" not in divers)
