"""Phrase listener: parses recognised gestures into phrases by the language's grammar."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from app.recognition import PoseSequence
from app.recognition.phrases.parser import CancelReason, PhraseEvent, PhraseParser
from app.recognition.recording.segmentation import TakeState
from app.robot.active_language import ActiveLanguage
from app.robot.events import Event, PhraseHeard, TakeEvent, TakeRecognized, TakeRejected
from app.robot.listeners.trigger_listener import LandmarkListener, WrappingListener


class PhraseListener(WrappingListener):
    """Listener that adds phrases to the events of another listener; a `LandmarkListener`.

    Without a grammar it adds nothing. A message is cancelled when its language, its source or the
    stream ends, even where a pause would have completed it.

    Parameters
    ----------
    listener
        Recognises the gestures.
    lag
        Longest delay in seconds from the end of a gesture to its report by `listener`, or a
        function that returns it if it depends on the language. A pause counts as too long only
        after this delay, when no gesture within it can be reported any more.

    """

    def __init__(self, listener: LandmarkListener, lag: float | Callable[[], float] = 0.0) -> None:
        super().__init__(listener)
        self._lag = lag if callable(lag) else lambda: lag
        self._parser = create_parser(listener.language)
        self._time = 0.0
        self._takes: list[TakeRecognized] = []  # candidates for the current message
        self._cancelled: tuple[PhraseEvent, ...] = ()  # by a change of the language

    def feed(self, moment: PoseSequence, salute: float) -> tuple[Event, ...]:
        """Process the next frame; see `LandmarkListener.feed`."""
        time = float(moment.time[0])
        events: list[Event] = [*self._to_events(time, self._cancelled)]
        self._cancelled, late = (), self.order.late
        found = self._listener.feed(moment, salute)
        if self.order.late > late:
            return tuple(events)
        if time < self._time:  # another stream
            events += self._cancel_message(time, "lost_source")
        self._time = time
        events += self._add_phrases(found)
        # An open take may still continue the message, so a pause cannot end it yet.
        if self._parser is not None and self._listener.state is not TakeState.recording:
            events += self._to_events(time, self._parser.expire(time - self._lag()))
        return tuple(events)

    def abandon(self, time: float, reason: str) -> tuple[Event, ...]:
        """Clear the memory and cancel an open message."""
        events = self._add_phrases(self._listener.abandon(time, reason))
        return (*events, *self._cancel_message(time, "lost_source"))

    def finish(self) -> tuple[Event, ...]:
        """End the stream and cancel an open message."""
        events = self._add_phrases(self._listener.finish())
        return (*events, *self._cancel_message(self._time, "end"))

    def set_language(self, language: ActiveLanguage) -> None:
        """Recognise another language; an open message of the previous one is cancelled."""
        self._listener.set_language(language)
        if self._parser is not None:
            self._cancelled += self._parser.abandon("new_language")
        self._parser = create_parser(language)

    def _add_phrases(self, events: Iterable[Event]) -> tuple[Event, ...]:
        added: list[Event] = []
        for event in events:
            added.append(event)
            if self._parser is None or not isinstance(event, TakeEvent):
                continue
            label = pair = None
            if isinstance(event, TakeRejected):
                pair = event.pair
            else:
                label = event.label
                # A take that does not end before this one belongs to another stream.
                before = [take for take in self._takes if take.end <= event.start]
                self._takes = [*before, event]
            heard = self._parser.feed(label, event.start, event.end, pair)
            added += self._to_events(event.time, heard)
        return tuple(added)

    def _cancel_message(self, time: float, reason: CancelReason) -> tuple[PhraseHeard, ...]:
        return () if self._parser is None else self._to_events(time, self._parser.abandon(reason))

    def _to_events(self, time: float, phrases: Iterable[PhraseEvent]) -> tuple[PhraseHeard, ...]:
        active = self.language
        return tuple(
            PhraseHeard(time, each, self._take_confidence(each), active.sha256, active.revision)
            for each in phrases
        )

    def _take_confidence(self, phrase: PhraseEvent) -> float:
        """Return the lowest confidence of the message's takes; drop the takes before it."""
        self._takes = [take for take in self._takes if take.start >= phrase.start]
        # The event of a pause may follow the gesture after the pause, which belongs to the next
        # message.
        confidences = (take.confidence for take in self._takes if take.end <= phrase.end)
        return min(confidences, default=0.0)


def create_parser(language: ActiveLanguage) -> PhraseParser | None:
    """Create the phrase parser of a language; None where it has no phrases."""
    grammar = language.recognizer.language.grammar
    return None if grammar is None or not grammar.phrases else PhraseParser(grammar)
