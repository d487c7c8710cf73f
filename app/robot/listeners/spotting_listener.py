"""Spotting listener: recognises gestures in continuous motion, without salutes."""

from __future__ import annotations

from app.recognition import PoseSequence
from app.recognition.recording.segmentation import TakeState
from app.recognition.spotting import Spotted, Spotter
from app.robot.active_language import ActiveLanguage
from app.robot.events import Event, StateChanged
from app.robot.listeners.stream_order import StreamOrder
from app.robot.take_result import judge_recognition


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
