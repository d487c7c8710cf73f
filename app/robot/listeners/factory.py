"""Listener factory: creates the listener for a language, with its trigger or without."""

from __future__ import annotations

from app.robot.active_language import ActiveLanguage
from app.robot.listeners.phrase_listener import PhraseListener
from app.robot.listeners.trigger_listener import TriggerListener


def create_listener(
    language: ActiveLanguage, *, without_salutes: bool = False, hands: bool = True
) -> PhraseListener:
    """Create the listener for a language's gestures and phrases.

    Parameters
    ----------
    language
        The language to recognise, whose trigger begins and ends a take.
    without_salutes
        Spot gestures in continuous motion, whatever the language's trigger.
    hands
        Whether the stream shows hands; where it does not, a language that waits for salutes is
        refused, also later.

    Raises
    ------
    OsgError
        When the language cannot be spotted without triggers; see `SpottingListener`. When it
        needs salutes, and no hand is seen.

    """
    listener = TriggerListener(language, without_salutes=without_salutes, hands=hands)
    return PhraseListener(listener, lag=lambda: listener.lag)
