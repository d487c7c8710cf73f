"""Trigger listener: recognises each take between two triggers, and a confident gesture in a gap.

A gap is what is shown between two takes: where a salute was missed, it is a take as well.
"""

from __future__ import annotations

from typing import Final, Protocol

from app.recognition import PoseSequence, Take
from app.recognition.recording.live_segmentation import LiveTakes
from app.recognition.recording.segmentation import LONGEST_TAKE, TakeState
from app.recognition.triggers.trigger import Trigger, mostly_hang
from app.robot.active_language import ActiveLanguage
from app.robot.events import Event, StateChanged, TakeRecognized, TakeRejected
from app.robot.listeners.stream_order import StreamOrder
from app.robot.take_result import judge_take, reject_take

GAP_CONFIDENCE: Final = 0.85
"""Confidence asked for in a gap between two takes, from which it is recognised as a gesture. Fewer
than one salute in ten is missed, so that a gap is seldom a take."""


def explain_unclosed(trigger: Trigger) -> str:
    """Return why a take has no end, in words."""
    again = "" if trigger.stop is None else ", or what begins a take came again"
    why = f"within {LONGEST_TAKE:g} s: forgotten, not seen, or the diver swam away{again}"
    if trigger.kind == "pose":
        return f"no pose of the arms ended it {why}"
    return f"no salute ended it {why}"


class LandmarkListener(Protocol):
    """Protocol of listeners, with triggers (`TriggerListener`) or without (`SpottingListener`)."""

    @property
    def language(self) -> ActiveLanguage:
        """The active language."""

    @property
    def state(self) -> TakeState:
        """State of the triggers."""

    @property
    def order(self) -> StreamOrder:
        """What is known of the order of the frames."""

    def feed(self, moment: PoseSequence, salute: float) -> tuple[Event, ...]:
        """Process the next frame and return its events; a late frame has none."""

    def abandon(self, time: float, reason: str) -> tuple[Event, ...]:
        """Clear the memory; an open take is rejected for `reason`."""

    def finish(self) -> tuple[Event, ...]:
        """End the stream and return the events that were still pending."""

    def set_language(self, language: ActiveLanguage) -> None:
        """Recognise another language from the next frame on, without clearing the memory."""


class TriggerListener:
    """Listener for gestures between two salutes, or other triggers of the language.

    State and memory are cleared between two takes, and bounded within one: it keeps the landmarks
    of at most `LONGEST_TAKE` and of the salute before it.

    Parameters
    ----------
    language
        The language to recognise.

    Attributes
    ----------
    language
        The active language; `set_language` changes it.
    order
        What is known of the order of the frames.

    """

    def __init__(self, language: ActiveLanguage) -> None:
        self.language = language
        self._takes: LiveTakes | None = None
        self.order = StreamOrder()
        self._state: TakeState | None = None
        self._doubtful = False  # whether the last take was rejected

    @property
    def state(self) -> TakeState:
        """Waiting for a salute, in a take, or holding the salute that ended the take."""
        return self._state or TakeState.idle

    def __len__(self) -> int:
        """Return the number of frames in memory."""
        return len(self._takes) if self._takes else 0

    def feed(self, moment: PoseSequence, salute: float) -> tuple[Event, ...]:
        """Process the next frame.

        A late or repeated frame is dropped. A frame with another clock or size comes from another
        camera, so the memory is cleared.

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
        frames = self.order.admit(moment, salute)
        events: list[Event] = []
        if self.order.reason:
            events += self._reject_open(float(moment.time[0]), self.order.reason)
        for frame in frames:
            events += self._process(*frame)
        return tuple(events)

    def abandon(self, time: float, reason: str) -> tuple[Event, ...]:
        """Clear the memory.

        Parameters
        ----------
        time
            Current time of the source, in seconds.
        reason
            Reason for rejecting an open take.

        """
        self.order.restart()
        return self._reject_open(time, reason)

    def finish(self) -> tuple[Event, ...]:
        """End the stream; an open take is rejected, with its nearest gesture."""
        time = self.order.time
        self.order.restart()
        take = self._clear()
        if take is None:
            return ()
        what = self.language.trigger.noun
        unclosed = f"the stream ended before a second {what}"
        return (judge_take(self.language, take, time, unclosed),)

    def set_language(self, language: ActiveLanguage) -> None:
        """Recognise the takes that end from now on with another language.

        If its trigger differs, an open take is rejected with the next frame.
        """
        self.language = language

    def _process(self, moment: PoseSequence, salute: float) -> tuple[Event, ...]:
        """Process a frame that is in order."""
        time, trigger = float(moment.time[0]), self.language.trigger
        left: tuple[Event, ...] = ()
        if self._takes is not None and self._takes.trigger != trigger:
            left = self._reject_open(time, "the language's trigger changed")
        if self._takes is None:
            self._takes = LiveTakes(moment.frame_size, trigger)
        sight = self._takes.feed_moment(moment, salute)
        if (missed := self._recognize_gap(time)) is not None:
            return (*left, *self._set_state(time, TakeState.done), missed)
        changed = (*left, *self._set_state(time, sight.state))
        if sight.take is None:
            return changed
        judged = judge_take(self.language, sight.take, time, explain_unclosed(trigger))
        self._doubtful = isinstance(judged, TakeRejected) and judged.pair is None
        return (*changed, judged)

    def _recognize_gap(self, time: float) -> TakeRecognized | None:
        """Recognise the gap before the salute that begins a take; None where it is no gesture."""
        assert self._takes is not None
        gap = self._takes.cut_gap() if self._doubtful else None
        if gap is None or mostly_hang(gap.untrimmed.landmarks, gap.untrimmed.xy):
            return None
        judged = judge_take(self.language, gap, time, explain_unclosed(self.language.trigger))
        if not isinstance(judged, TakeRecognized) or judged.confidence < GAP_CONFIDENCE:
            return None
        self._takes.end_gap()
        self._doubtful = False
        return judged

    def _reject_open(self, time: float, reason: str) -> tuple[Event, ...]:
        """Clear the memory and reject an open take for `reason`."""
        take = self._clear()
        rejected = (reject_take(self.language, take, time, reason),) if take else ()
        return (*rejected, *(self._set_state(time, TakeState.idle) if self._state else ()))

    def _clear(self) -> Take | None:
        """Clear the memory and return the take that was open."""
        take = self._takes.finish() if self._takes else None
        self._takes, self._doubtful = None, False
        return take

    def _set_state(self, time: float, state: TakeState) -> tuple[Event, ...]:
        if state is self._state:
            return ()
        self._state = state
        return (StateChanged(time, state),)


class WrappingListener:
    """Listener whose language, state and order are those of the wrapped listener.

    Parameters
    ----------
    listener
        The wrapped listener.

    """

    def __init__(self, listener: LandmarkListener) -> None:
        self._listener = listener

    @property
    def language(self) -> ActiveLanguage:
        """The active language."""
        return self._listener.language

    @property
    def state(self) -> TakeState:
        """State of the triggers."""
        return self._listener.state

    @property
    def order(self) -> StreamOrder:
        """What is known of the order of the frames."""
        return self._listener.order
