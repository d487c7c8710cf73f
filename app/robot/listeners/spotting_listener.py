"""Spotting listener: recognises gestures in continuous motion, without salutes."""

from __future__ import annotations

from app.recognition import PoseSequence
from app.recognition.recording.segmentation import TakeState
from app.recognition.spotting import Spotted, Spotter
from app.robot.active_language import ActiveLanguage
from app.robot.events import Event, StateChanged
from app.robot.listeners.salute_listener import describe_break
from app.robot.take_result import judge_recognition


class SpottingListener:
    """Listener for gestures without salutes; a `LandmarkListener`.

    Parameters
    ----------
    language
        The language to recognise.

    Raises
    ------
    OsgError
        When its profile is not ``full``, or none of its gestures has a demonstration.

    """

    def __init__(self, language: ActiveLanguage) -> None:
        self._language = language
        self._spotter = Spotter(language.recognizer)
        self._last: PoseSequence | None = None

    @property
    def language(self) -> ActiveLanguage:
        """The active language."""
        return self._language

    @property
    def state(self) -> TakeState:
        """Always idle: there are no salutes."""
        return TakeState.idle

    def __len__(self) -> int:
        """Return the number of frames in memory."""
        return len(self._spotter)

    def feed(self, moment: PoseSequence, salute: float) -> tuple[Event, ...]:
        """Process the next frame; see `Listener.feed`. `salute` is ignored."""
        time = float(moment.time[0])
        events: tuple[Event, ...] = ()
        if self._last is None:
            events = (StateChanged(time, TakeState.idle),)
        elif reason := describe_break(self._last, moment):
            events = self.abandon(time, reason)
        self._last = moment
        return events + self._to_events(time, self._spotter.feed(moment))

    def abandon(self, time: float, reason: str) -> tuple[Event, ...]:
        """Clear the memory; return the events of gestures that had already ended."""
        events = self._to_events(time, self._spotter.finish())
        self._spotter = Spotter(self._language.recognizer)
        return events

    def finish(self) -> tuple[Event, ...]:
        """End the stream and return the events that were still pending."""
        time = 0.0 if self._last is None else float(self._last.time[0])
        return self._to_events(time, self._spotter.finish())

    def set_language(self, language: ActiveLanguage) -> None:
        """Spot the gestures of another language from the next frame on.

        Raises
        ------
        OsgError
            When none of its gestures has a demonstration; the previous language stays active.

        """
        self._spotter = self._spotter.for_language(language.recognizer)
        self._language = language

    def _to_events(self, time: float, spotted: tuple[Spotted, ...]) -> tuple[Event, ...]:
        return tuple(
            judge_recognition(self._language, each.recognition, time, each.start, each.end)
            for each in spotted
        )
