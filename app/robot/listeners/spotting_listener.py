"""Listening without salutes: gestures spotted in whatever a diver does."""

from __future__ import annotations

from app.recognition import PoseSequence
from app.recognition.recording.segmentation import TakeState
from app.recognition.spotting import Spotted, Spotter
from app.robot.active_language import SpokenLanguage
from app.robot.events import Event, StateChanged
from app.robot.listeners.salute_listener import break_between
from app.robot.take_result import verdict


class SpottingListener:
    """Hears gestures that no salute announces; a `Hearing`.

    Parameters
    ----------
    language
        The language to listen for.

    Raises
    ------
    OsgError
        When its profile is not ``full``, or none of its gestures has a demonstration.

    """

    def __init__(self, language: SpokenLanguage) -> None:
        self._language = language
        self._spotter = Spotter(language.recognizer)
        self._last: PoseSequence | None = None

    @property
    def language(self) -> SpokenLanguage:
        """The language that is listened for."""
        return self._language

    @property
    def state(self) -> TakeState:
        """Always idle: there are no salutes."""
        return TakeState.idle

    def __len__(self) -> int:
        """Count the frames that are remembered."""
        return len(self._spotter)

    def feed(self, moment: PoseSequence, salute: float) -> tuple[Event, ...]:
        """Take the next frame; see `Listener.feed`, but that `salute` means nothing here."""
        time = float(moment.time[0])
        told: tuple[Event, ...] = ()
        if self._last is None:
            told = (StateChanged(time, TakeState.idle),)
        elif broken := break_between(self._last, moment):
            told = self.abandon(time, broken)
        self._last = moment
        return told + self._told(time, self._spotter.feed(moment))

    def abandon(self, time: float, reason: str) -> tuple[Event, ...]:
        """Forget what was seen; a gesture that ended already is still told."""
        told = self._told(time, self._spotter.finish())
        self._spotter = Spotter(self._language.recognizer)
        return told

    def finish(self) -> tuple[Event, ...]:
        """End the stream and tell the gestures that were still awaited."""
        time = 0.0 if self._last is None else float(self._last.time[0])
        return self._told(time, self._spotter.finish())

    def speak(self, language: SpokenLanguage) -> None:
        """Spot the gestures of another language from the next frame on.

        Raises
        ------
        OsgError
            When none of its gestures has a demonstration; the language before it is kept.

        """
        self._spotter = self._spotter.for_language(language.recognizer)
        self._language = language

    def _told(self, time: float, spotted: tuple[Spotted, ...]) -> tuple[Event, ...]:
        return tuple(
            verdict(self._language, each.recognition, time, each.start, each.end)
            for each in spotted
        )
