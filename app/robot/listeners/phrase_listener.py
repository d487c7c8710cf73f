"""Listening for phrases: what was recognised, put together by the language's grammar."""

from __future__ import annotations

from collections.abc import Iterable

from app.recognition import PoseSequence
from app.recognition.phrases.parser import PhraseEvent, PhraseParser
from app.recognition.recording.segmentation import TakeState
from app.robot.active_language import SpokenLanguage
from app.robot.events import Event, PhraseHeard, TakeRecognized, TakeRejected
from app.robot.listeners.salute_listener import Hearing


class PhraseListener:
    """Tells beside everything that another listener hears which phrases it makes; a `Hearing`.

    A language without a grammar has none. A message does not outlive its language, its source or
    the stream: it is cancelled, also where a pause would have ended it.

    Parameters
    ----------
    hearing
        Hears the gestures.
    lag
        Seconds by which it may tell a gesture later than it ended; a pause is only too long when
        no gesture within it can be told any more.

    """

    def __init__(self, hearing: Hearing, lag: float = 0.0) -> None:
        self._hearing = hearing
        self._lag = lag
        self._parser = parser_of(hearing.language)
        self._time = 0.0
        self._takes: list[TakeRecognized] = []  # that a message may be made of
        self._left: tuple[PhraseEvent, ...] = ()  # what another language cancelled

    @property
    def language(self) -> SpokenLanguage:
        """The language that is listened for."""
        return self._hearing.language

    @property
    def state(self) -> TakeState:
        """What the salutes are at."""
        return self._hearing.state

    def feed(self, moment: PoseSequence, salute: float) -> tuple[Event, ...]:
        """Take the next frame; see `Hearing.feed`."""
        time = float(moment.time[0])
        told: list[Event] = [*self._heard(time, self._left)]
        if time < self._time:  # another stream
            told += self._abandoned(time)
        self._time, self._left = time, ()
        told += self._with_phrases(self._hearing.feed(moment, salute))
        # While a take goes on nobody knows yet whether it goes on with the message.
        if self._parser is not None and self._hearing.state is not TakeState.recording:
            told += self._heard(time, self._parser.expire(time - self._lag))
        return tuple(told)

    def abandon(self, time: float, reason: str) -> tuple[Event, ...]:
        """Forget what was seen, and a message that was begun."""
        told = self._with_phrases(self._hearing.abandon(time, reason))
        return (*told, *self._abandoned(time))

    def finish(self) -> tuple[Event, ...]:
        """End the stream; a message that was begun is cancelled."""
        told = self._with_phrases(self._hearing.finish())
        return (*told, *self._abandoned(self._time))

    def speak(self, language: SpokenLanguage) -> None:
        """Listen for another language; what was begun in the one before is cancelled."""
        self._hearing.speak(language)
        if self._parser is not None:
            self._left += self._parser.abandon()
        self._parser = parser_of(language)

    def _with_phrases(self, events: Iterable[Event]) -> tuple[Event, ...]:
        told: list[Event] = []
        for event in events:
            told.append(event)
            if self._parser is None or not isinstance(event, TakeRecognized | TakeRejected):
                continue
            label = None
            if isinstance(event, TakeRecognized):
                label = event.label
                # What does not lie before it is of another stream.
                before = [take for take in self._takes if take.end <= event.start]
                self._takes = [*before, event]
            told += self._heard(event.time, self._parser.feed(label, event.start, event.end))
        return tuple(told)

    def _abandoned(self, time: float) -> tuple[PhraseHeard, ...]:
        return () if self._parser is None else self._heard(time, self._parser.abandon())

    def _heard(self, time: float, events: Iterable[PhraseEvent]) -> tuple[PhraseHeard, ...]:
        spoken = self.language
        return tuple(
            PhraseHeard(time, each, self._confidence(each), spoken.sha256, spoken.revision)
            for each in events
        )

    def _confidence(self, phrase: PhraseEvent) -> float:
        """Return that of the message's least sure gesture, and forget those before the message."""
        self._takes = [take for take in self._takes if take.start >= phrase.start]
        # A pause may be told after the gesture that ended it, which is of the next message.
        sure = (take.confidence for take in self._takes if take.end <= phrase.end)
        return min(sure, default=0.0)


def parser_of(language: SpokenLanguage) -> PhraseParser | None:
    """Return what puts a language's gestures together; None where it has no phrases."""
    grammar = language.recognizer.language.grammar
    return None if grammar is None or not grammar.phrases else PhraseParser(grammar)
