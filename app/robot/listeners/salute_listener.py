"""Salute listener: segments landmarks into takes between two salutes and recognises each take."""

from __future__ import annotations

from typing import Protocol

from app.recognition import PoseSequence, Take
from app.recognition.recording.live_segmentation import LiveTakes
from app.recognition.recording.segmentation import LONGEST_TAKE, TakeState
from app.robot.active_language import ActiveLanguage
from app.robot.events import Event, StateChanged
from app.robot.take_result import judge_take, reject_take

NOT_ENDED_IN_TIME = (
    f"no salute ended it within {LONGEST_TAKE:g} s: forgotten, not seen, or the diver swam away"
)
NOT_ENDED_AT_ALL = "the stream ended before a second salute"


class LandmarkListener(Protocol):
    """Protocol of listeners, with salutes (`Listener`) or without (`SpottingListener`)."""

    @property
    def language(self) -> ActiveLanguage:
        """The active language."""
        ...

    @property
    def state(self) -> TakeState:
        """State of the salutes."""
        ...

    def feed(self, moment: PoseSequence, salute: float) -> tuple[Event, ...]:
        """Process the next frame and return its events."""
        ...

    def abandon(self, time: float, reason: str) -> tuple[Event, ...]:
        """Clear the memory; an open take is rejected for `reason`."""
        ...

    def finish(self) -> tuple[Event, ...]:
        """End the stream and return the events that were still pending."""
        ...

    def set_language(self, language: ActiveLanguage) -> None:
        """Recognise another language from the next frame on, without clearing the memory."""
        ...


class Listener:
    """Listener for gestures between two salutes.

    State and memory are cleared between two takes, and bounded within one: it keeps the landmarks
    of at most `LONGEST_TAKE` and of the salute before it.

    Parameters
    ----------
    language
        The language to recognise.

    """

    def __init__(self, language: ActiveLanguage) -> None:
        self._language = language
        self._takes: LiveTakes | None = None
        self._last: PoseSequence | None = None
        self._state: TakeState | None = None

    @property
    def language(self) -> ActiveLanguage:
        """The active language."""
        return self._language

    @property
    def state(self) -> TakeState:
        """Waiting for a salute, in a take, or holding the salute that ended the take."""
        return self._state or TakeState.idle

    def __len__(self) -> int:
        """Return the number of frames in memory."""
        return len(self._takes) if self._takes else 0

    def feed(self, moment: PoseSequence, salute: float) -> tuple[Event, ...]:
        """Process the next frame.

        An earlier time or another size means another camera, so the memory is cleared.

        Parameters
        ----------
        moment
            The body in this frame alone (`extraction.build_frame_sequence`).
        salute
            Salute score of the best hand, in [0, 1] (`salute.best_salute`).

        Returns
        -------
        `StateChanged`, `TakeRecognized` and `TakeRejected`; for most frames none.

        """
        time = float(moment.time[0])
        events: tuple[Event, ...] = ()
        if self._last is not None and (reason := describe_break(self._last, moment)):
            events = self.abandon(time, reason)
        self._last = moment
        if self._takes is None:
            self._takes = LiveTakes(moment.frame_size)
        sight = self._takes.feed_moment(moment, salute)
        events += self._set_state(time, sight.state)
        if sight.take is None:
            return events
        return (*events, judge_take(self._language, sight.take, time, NOT_ENDED_IN_TIME))

    def abandon(self, time: float, reason: str) -> tuple[Event, ...]:
        """Clear the memory.

        Parameters
        ----------
        time
            Current time of the source, in seconds.
        reason
            Reason for rejecting an open take.

        """
        take = self._clear()
        rejected = (reject_take(self._language, take, time, reason),) if take else ()
        return (*rejected, *(self._set_state(time, TakeState.idle) if self._state else ()))

    def finish(self) -> tuple[Event, ...]:
        """End the stream; an open take is rejected, with its nearest gesture."""
        time = 0.0 if self._last is None else float(self._last.time[0])
        take = self._clear()
        if take is None:
            return ()
        return (judge_take(self._language, take, time, NOT_ENDED_AT_ALL),)

    def set_language(self, language: ActiveLanguage) -> None:
        """Recognise the takes that end from now on by another language."""
        self._language = language

    def _clear(self) -> Take | None:
        """Clear the memory and return the take that was open."""
        take = self._takes.finish() if self._takes else None
        self._takes = self._last = None
        return take

    def _set_state(self, time: float, state: TakeState) -> tuple[Event, ...]:
        if state is self._state:
            return ()
        self._state = state
        return (StateChanged(time, state),)


def describe_break(last: PoseSequence, moment: PoseSequence) -> str:
    """Return why one frame cannot follow another in the same take; empty where it can."""
    before, now = float(last.time[0]), float(moment.time[0])
    if now <= before:
        return f"the source's time went back, from {before:.2f} s to {now:.2f} s"
    if moment.frame_size != last.frame_size:
        old, new = (f"{width} x {height}" for width, height in (last.frame_size, moment.frame_size))
        return f"the picture's size changed, from {old} to {new} pixels"
    if moment.landmarks != last.landmarks:
        return f"the landmarks changed, from {len(last.landmarks)} to {len(moment.landmarks)}"
    return ""
