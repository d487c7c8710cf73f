"""Language listener: listens with or without triggers, as the active language specifies."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from app.recognition import PoseSequence
from app.recognition.errors import EstimatorError
from app.recognition.phrases.parser import CancelReason, PhraseEvent, PhraseParser
from app.recognition.recording.segmentation import TakeState
from app.recognition.spotting import LONGEST_MEMORY, Spotted, Spotter
from app.robot.active_language import ActiveLanguage
from app.robot.events import (
    Event,
    PhraseHeard,
    StateChanged,
    TakeEvent,
    TakeRecognized,
    TakeRejected,
)
from app.robot.listeners.stream_order import StreamOrder
from app.robot.listeners.trigger_listener import LandmarkListener, TriggerListener, WrappingListener
from app.robot.take_result import judge_recognition


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


class SpottingListener:
    """Listener for gestures without salutes; a `LandmarkListener`.

    Parameters
    ----------
    language
        The language to recognise.
    triggered
        Whether a trigger gesture is respected: only gestures between two triggers are then
        reported.

    Attributes
    ----------
    language
        The active language; `set_language` changes it.
    order
        What is known of the order of the frames.

    Raises
    ------
    OsgError
        When its profile is not ``full``, or none of its gestures has a demonstration.

    """

    def __init__(self, language: ActiveLanguage, *, triggered: bool = True) -> None:
        self.language = language
        self._triggered = triggered
        self._spotter = Spotter(language.recognizer, triggered=triggered)
        self.order = StreamOrder()
        self._begun = False

    @property
    def state(self) -> TakeState:
        """Always idle: there are no salutes."""
        return TakeState.idle

    def __len__(self) -> int:
        """Return the number of frames in memory."""
        return len(self._spotter)

    def feed(self, moment: PoseSequence, salute: float) -> tuple[Event, ...]:
        """Process the next frame; see `Listener.feed`. `salute` is ignored."""
        frames = self.order.admit(moment, salute)
        events: list[Event] = []
        if self.order.reason:
            events += self._start_again(float(moment.time[0]))
        for each, _ in frames:
            time = float(each.time[0])
            if not self._begun:
                events.append(StateChanged(time, TakeState.idle))
            self._begun = True
            events += self._to_events(time, self._spotter.feed(each))
        return tuple(events)

    def abandon(self, time: float, reason: str) -> tuple[Event, ...]:
        """Clear the memory; return the events of gestures that had already ended."""
        self.order.restart()
        return self._start_again(time)

    def _start_again(self, time: float) -> tuple[Event, ...]:
        events = self._to_events(time, self._spotter.finish())
        self._spotter = Spotter(self.language.recognizer, triggered=self._triggered)
        return events

    def finish(self) -> tuple[Event, ...]:
        """End the stream and return the events that were still pending."""
        return self._to_events(self.order.time, self._spotter.finish())

    def set_language(self, language: ActiveLanguage) -> None:
        """Spot the gestures of another language from the next frame on.

        Raises
        ------
        OsgError
            When none of its gestures has a demonstration; the previous language stays active.

        """
        self._spotter = self._spotter.for_language(language.recognizer)
        self.language = language

    def _to_events(self, time: float, spotted: tuple[Spotted, ...]) -> tuple[Event, ...]:
        return tuple(
            judge_recognition(self.language, each.recognition, time, each.start, each.end)
            for each in spotted
        )


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
