"""From landmarks to takes, and from takes to what was said, frame by frame."""

from __future__ import annotations

from typing import Protocol

from app.recognition import PoseSequence, Take
from app.recognition.recording.live_segmentation import LiveTakes
from app.recognition.recording.segmentation import LONGEST_TAKE, TakeState
from app.robot.active_language import SpokenLanguage
from app.robot.events import Event, StateChanged
from app.robot.take_result import rejection, verdict_on_take

NOT_ENDED_IN_TIME = (
    f"no salute ended it within {LONGEST_TAKE:g} s: forgotten, not seen, or the diver swam away"
)
NOT_ENDED_AT_ALL = "the stream ended before a second salute"


class Hearing(Protocol):
    """Whatever listens to landmarks: with salutes (`Listener`) or without (`SpottingListener`)."""

    @property
    def language(self) -> SpokenLanguage:
        """The language that is listened for."""
        ...

    @property
    def state(self) -> TakeState:
        """What the salutes are at."""
        ...

    def feed(self, moment: PoseSequence, salute: float) -> tuple[Event, ...]:
        """Take the next frame and tell what it changes."""
        ...

    def abandon(self, time: float, reason: str) -> tuple[Event, ...]:
        """Forget what was seen; a take that was begun is rejected for that reason."""
        ...

    def finish(self) -> tuple[Event, ...]:
        """End the stream and tell what was still awaited."""
        ...

    def speak(self, language: SpokenLanguage) -> None:
        """Listen for another language from the next frame on, without forgetting what was seen."""
        ...


class Listener:
    """Hears what is shown between two salutes.

    State and memory are cleared between two takes, and bounded within one: landmarks of no more
    than `LONGEST_TAKE` and the salute before it are kept.

    Parameters
    ----------
    language
        The language to listen for.

    """

    def __init__(self, language: SpokenLanguage) -> None:
        self._language = language
        self._takes: LiveTakes | None = None
        self._last: PoseSequence | None = None
        self._state: TakeState | None = None

    @property
    def language(self) -> SpokenLanguage:
        """The language that is listened for."""
        return self._language

    @property
    def state(self) -> TakeState:
        """Whether a salute is awaited, a take goes on, or the salute that ended it is held."""
        return self._state or TakeState.idle

    def __len__(self) -> int:
        """Count the frames that are remembered."""
        return len(self._takes) if self._takes else 0

    def feed(self, moment: PoseSequence, salute: float) -> tuple[Event, ...]:
        """Take the next frame.

        A frame from before the last one, or of another size, is another camera's: what was seen
        until then is forgotten.

        Parameters
        ----------
        moment
            The body in that frame alone (`extraction.moment_of`).
        salute
            In [0, 1]: how much the best hand salutes (`salute.best_salute`).

        Returns
        -------
        `StateChanged`, `TakeRecognized` and `TakeRejected`, mostly none.

        """
        time = float(moment.time[0])
        told: tuple[Event, ...] = ()
        if self._last is not None and (broken := break_between(self._last, moment)):
            told = self.abandon(time, broken)
        self._last = moment
        if self._takes is None:
            self._takes = LiveTakes(moment.frame_size)
        sight = self._takes.feed_moment(moment, salute)
        told += self._changed(time, sight.state)
        if sight.take is None:
            return told
        return (*told, verdict_on_take(self._language, sight.take, time, NOT_ENDED_IN_TIME))

    def abandon(self, time: float, reason: str) -> tuple[Event, ...]:
        """Forget what was seen.

        Parameters
        ----------
        time
            Seconds: now.
        reason
            Why a take that was begun is rejected.

        """
        take = self._unclosed()
        rejected = (rejection(self._language, take, time, reason),) if take else ()
        return (*rejected, *(self._changed(time, TakeState.idle) if self._state else ()))

    def finish(self) -> tuple[Event, ...]:
        """End the stream; a take that was begun is rejected, and what it resembles is told."""
        time = 0.0 if self._last is None else float(self._last.time[0])
        take = self._unclosed()
        if take is None:
            return ()
        return (verdict_on_take(self._language, take, time, NOT_ENDED_AT_ALL),)

    def speak(self, language: SpokenLanguage) -> None:
        """Recognise by another language whatever ends from now on."""
        self._language = language

    def _unclosed(self) -> Take | None:
        """Return the take that was begun, and forget everything."""
        take = self._takes.finish() if self._takes else None
        self._takes = self._last = None
        return take

    def _changed(self, time: float, state: TakeState) -> tuple[Event, ...]:
        if state is self._state:
            return ()
        self._state = state
        return (StateChanged(time, state),)


def break_between(last: PoseSequence, moment: PoseSequence) -> str:
    """Say why one frame cannot follow another in the same take; empty where it can."""
    before, now = float(last.time[0]), float(moment.time[0])
    if now <= before:
        return f"the source's time went back, from {before:.2f} s to {now:.2f} s"
    if moment.frame_size != last.frame_size:
        old, new = (f"{width} x {height}" for width, height in (last.frame_size, moment.frame_size))
        return f"the picture's size changed, from {old} to {new} pixels"
    if moment.landmarks != last.landmarks:
        return f"the landmarks changed, from {len(last.landmarks)} to {len(moment.landmarks)}"
    return ""
