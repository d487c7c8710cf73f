"""What hears a language: between salutes or without them, and its phrases."""

from __future__ import annotations

from app.recognition.spotting import LONGEST_MEMORY
from app.robot.active_language import SpokenLanguage
from app.robot.listeners.phrase_listener import PhraseListener
from app.robot.listeners.salute_listener import Listener
from app.robot.listeners.spotting_listener import SpottingListener


def hearing_of(language: SpokenLanguage, *, without_salutes: bool = False) -> PhraseListener:
    """Return what hears a language's gestures and phrases.

    Parameters
    ----------
    language
        The language to listen for.
    without_salutes
        Spot gestures that no salute announces, in whatever a diver does.

    Raises
    ------
    OsgError
        When the language cannot be heard without salutes; see `SpottingListener`.

    """
    if without_salutes:
        return PhraseListener(SpottingListener(language), lag=LONGEST_MEMORY)
    return PhraseListener(Listener(language))
