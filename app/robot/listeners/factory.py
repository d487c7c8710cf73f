"""Listener factory: creates the listener for a language, with or without salutes."""

from __future__ import annotations

from app.recognition.spotting import LONGEST_MEMORY
from app.robot.active_language import ActiveLanguage
from app.robot.listeners.phrase_listener import PhraseListener
from app.robot.listeners.salute_listener import Listener
from app.robot.listeners.spotting_listener import SpottingListener


def create_listener(language: ActiveLanguage, *, without_salutes: bool = False) -> PhraseListener:
    """Create the listener for a language's gestures and phrases.

    Parameters
    ----------
    language
        The language to recognise.
    without_salutes
        Spot gestures in continuous motion, without salutes around them.

    Raises
    ------
    OsgError
        When the language cannot be spotted without salutes; see `SpottingListener`.

    """
    if without_salutes:
        return PhraseListener(SpottingListener(language), lag=LONGEST_MEMORY)
    return PhraseListener(Listener(language))
