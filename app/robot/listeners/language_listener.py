"""Language listener: listens with or without triggers, as the active language specifies."""

from __future__ import annotations

from app.recognition import PoseSequence
from app.recognition.errors import EstimatorError
from app.recognition.spotting import LONGEST_MEMORY
from app.robot.active_language import ActiveLanguage
from app.robot.events import Event
from app.robot.listeners.phrase_listener import PhraseListener
from app.robot.listeners.spotting_listener import SpottingListener
from app.robot.listeners.trigger_listener import LandmarkListener, TriggerListener, WrappingListener


class LanguageListener(WrappingListener):
    """Listener that changes with the language's trigger; a `LandmarkListener`.

    Parameters
    ----------
    language
        The language to recognise.
    without_salutes
        Spot gestures in continuous motion, whatever the trigger.
    hands
        Whether the stream shows hands, and so salutes.

    Raises
    ------
    OsgError
        When the language cannot be spotted without triggers; see `SpottingListener`. When it
        needs salutes, and no hand is seen.

    """

    def __init__(
        self, language: ActiveLanguage, *, without_salutes: bool = False, hands: bool = True
    ) -> None:
        self._always_spots = without_salutes
        self._hands = hands
        super().__init__(self._create(language))
        self._left: tuple[Event, ...] = ()  # events of the previous listener, at a change

    @property
    def lag(self) -> float:
        """Seconds by which a gesture may be reported after its end."""
        return LONGEST_MEMORY if isinstance(self._listener, SpottingListener) else 0.0

    def feed(self, moment: PoseSequence, salute: float) -> tuple[Event, ...]:
        """Process the next frame; see `LandmarkListener.feed`."""
        left, self._left = self._left, ()
        return (*left, *self._listener.feed(moment, salute))

    def abandon(self, time: float, reason: str) -> tuple[Event, ...]:
        """Clear the memory; an open take is rejected for `reason`."""
        left, self._left = self._left, ()
        return (*left, *self._listener.abandon(time, reason))

    def finish(self) -> tuple[Event, ...]:
        """End the stream and return the events that were still pending."""
        left, self._left = self._left, ()
        return (*left, *self._listener.finish())

    def set_language(self, language: ActiveLanguage) -> None:
        """Recognise another language from the next frame on.

        If one of the two languages has no trigger, the memory is cleared.

        Raises
        ------
        OsgError
            As for a new listener; the previous language stays active.

        """
        self._require_hands(language)
        if self._spots(language) == isinstance(self._listener, SpottingListener):
            self._listener.set_language(language)
            return
        following = self._create(language)
        time = self._listener.order.time
        self._left += self._listener.abandon(time, "the language's trigger changed")
        self._listener = following

    def _spots(self, language: ActiveLanguage) -> bool:
        return self._always_spots or language.trigger.spots

    def _require_hands(self, language: ActiveLanguage) -> None:
        if not (self._hands or self._spots(language)) and language.trigger.kind == "salute":
            raise EstimatorError(
                f"the language {language.name!r} waits for salutes, and without hands no salute "
                "is seen: choose a hand model, give the language another trigger, or set "
                "without_salutes"
            )

    def _create(self, language: ActiveLanguage) -> LandmarkListener:
        self._require_hands(language)
        if self._spots(language):
            return SpottingListener(language, triggered=not self._always_spots)
        return TriggerListener(language)


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
    listener = LanguageListener(language, without_salutes=without_salutes, hands=hands)
    return PhraseListener(listener, lag=lambda: listener.lag)
