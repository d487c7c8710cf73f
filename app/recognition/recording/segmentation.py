"""Segmentation: finds the takes of a recording or a stream, each between two triggers.

A trigger is a salute unless a language names a pose of the arms (`app.recognition.triggers`).
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from enum import Enum
from pathlib import Path

from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.water import WaterCorrection
from app.recognition.poses.sequence import PoseSequence
from app.recognition.preprocessing.repair import repair_poses
from app.recognition.recording.extraction import Progress, record
from app.recognition.recording.recording import Recording, find_holes, find_missable
from app.recognition.recording.salute import ENTER_SCORE, HeldTrigger
from app.recognition.recording.salute import LONGEST_TAKE as LONGEST_TAKE
from app.recognition.recording.salute import SHORTEST_TAKE as SHORTEST_TAKE
from app.recognition.recording.trimming import Span, find_stroke
from app.recognition.triggers.trigger import LEAVE_SCORE as POSE_LEAVE_SCORE
from app.recognition.triggers.trigger import POSE_SECONDS, SALUTE, Trigger


class TakeState(str, Enum):
    """State of a `TakeMachine`."""

    idle = "idle"
    """Waits for a trigger."""
    recording = "recording"
    """A trigger was held; the gesture is shown, or about to be."""
    done = "done"
    """A second trigger ended the take and is still held."""


@dataclass(frozen=True)
class Bracket:
    """The triggers around a take; the closing one may be missing.

    Attributes
    ----------
    opening
        From the first frame of the start trigger to its last one.
    closing
        From the first frame of the stop trigger to when it had been held long enough; None: the
        stream or the time for a take ended without one.
    end
        Seconds: when the take ends, by the stop trigger or without one.
    unseen
        Spans of the take in which a trigger may have been missed (`find_missable`).

    """

    opening: Span
    closing: Span | None
    end: float
    unseen: tuple[Span, ...] = ()

    @property
    def start(self) -> float:
        """When the take begins, in seconds."""
        return self.opening.end

    @property
    def closed(self) -> bool:
        """Whether a stop trigger ended the take."""
        return self.closing is not None


@dataclass
class TakeMachine:
    """Turns a stream of trigger scores into takes.

    Idle until a trigger is held; then recording. The take begins when this trigger is released and
    ends where the next one begins. Then done, until that trigger is released too: one trigger never
    ends one take and begins the next.
    A trigger that returns within `SHORTEST_TAKE` of its release continues. A take longer than
    `LONGEST_TAKE` ends unclosed.

    Where start and stop triggers differ, each has its own effect: a start trigger during a take
    leaves that take unclosed and begins the next; a stop trigger without a take does nothing.

    Attributes
    ----------
    trigger
        Detects held triggers.
    stop
        Detects the stop trigger; None: the start trigger also ends a take.
    state
        Current state.
    gap
        What lies between the trigger that ended the last take and the one that begins a take with
        this frame; None with every other frame. Where a trigger was missed, the gap is the take.

    """

    trigger: HeldTrigger = field(default_factory=HeldTrigger)
    stop: HeldTrigger | None = None
    state: TakeState = field(default=TakeState.idle, init=False)
    _began: float = field(default=0.0, init=False)
    _released: float | None = field(default=None, init=False)
    gap: Bracket | None = field(default=None, init=False)
    _closing: float = field(default=0.0, init=False)
    _ended: Span | None = field(default=None, init=False)
    _clear: deque[float] = field(default_factory=deque, init=False)  # frames without a trigger

    @classmethod
    def of(cls, trigger: Trigger) -> TakeMachine:
        """Create the machine for a language's trigger."""
        if trigger.start is None:
            return cls()
        stop = None if trigger.stop is None else create_held_pose()
        return cls(trigger=create_held_pose(), stop=stop)

    @property
    def held(self) -> bool:
        """Whether a trigger is held now."""
        return self.trigger.held or (self.stop is not None and self.stop.held)

    def update(self, time: float, score: float, stop_score: float = 0.0) -> Bracket | None:
        """Process the next frame.

        Parameters
        ----------
        time
            Seconds, later than in every call before.
        score
            Score in [0, 1] of the start trigger; of a salute, of the best hand (`best_salute`).
        stop_score
            Score in [0, 1] of the stop trigger, for a machine with a `stop`.

        Returns
        -------
        The take that this frame ends, if it ends one.

        """
        held = self.trigger.update(time, score)
        self.gap = None
        if max(score, stop_score) < ENTER_SCORE:
            self._clear.append(time)
        while self._clear and time - self._clear[0] > 2 * LONGEST_TAKE:
            self._clear.popleft()
        if self.stop is not None:
            return self._update_both(time, held, self.stop.update(time, stop_score))
        match self.state:
            case TakeState.idle if held:
                self.state = TakeState.recording
                self._began = time if self.trigger.since is None else self.trigger.since
                self._released = None
                self.gap = self._find_gap(time)
            case TakeState.recording:
                return self._recording(time, held)
            case TakeState.done if not held:
                self.state = TakeState.idle
                released = self.trigger.until
                self._ended = Span(self._closing, time if released is None else released)
        return None

    def end_gap(self) -> None:
        """Let the trigger that began a take with this frame end the gap instead."""
        self.state, self._closing = TakeState.done, self._began

    def remembers(self, time: float) -> bool:
        """Return whether a gap that lasts at `time` seconds may still become a take."""
        return self._ended is not None and time - self._ended.end <= LONGEST_TAKE

    def finish(self, time: float) -> Bracket | None:
        """End the stream at `time` seconds.

        Returns
        -------
        The unclosed take, if there is one.

        """
        released = self._released
        if self.state is not TakeState.recording or released is None:
            return None
        self.state = TakeState.idle
        return self._unclosed(released, time) if time - released >= SHORTEST_TAKE else None

    def _update_both(self, time: float, held: bool, stopped: bool) -> Bracket | None:
        """Process a frame where start and stop triggers differ."""
        assert self.stop is not None
        found = None
        if self.state is TakeState.done and not stopped:
            self.state = TakeState.idle
        if self.state is TakeState.recording:
            found = self._end_by_stop(time, stopped)
        begun = self.trigger.since if held else None
        if self.state is TakeState.idle and begun is not None:
            self.state, self._began, self._released = TakeState.recording, begun, None
        elif self.state is TakeState.recording and self._released is None:
            if not held:
                self._released = self.trigger.until
        elif self.state is TakeState.recording and self._released is not None and begun is not None:
            if begun - self._released >= SHORTEST_TAKE:
                found = self._unclosed(self._released, begun)
                self._began = begun
            self._released = None
        return found

    def _end_by_stop(self, time: float, stopped: bool) -> Bracket | None:
        """End a take by its stop trigger, or because it is too long."""
        assert self.stop is not None
        since = self.stop.since
        released = self.trigger.until if self._released is None else self._released
        assert released is not None
        if stopped and since is not None:
            ended = self._end(released, since, time)
            return ended if since - released >= SHORTEST_TAKE else None
        return None if self._released is None else self._end_too_long(released, time)

    def _recording(self, time: float, held: bool) -> Bracket | None:
        released, since = self._released, self.trigger.since
        if released is None:
            if not held:
                self._released = self.trigger.until
            return None
        if not held or since is None:
            return self._end_too_long(released, time)
        if since - released < SHORTEST_TAKE:
            self._released = None
            return None
        return self._end(released, since, time)

    def _end(self, released: float, since: float, time: float) -> Bracket:
        """End the take by a trigger that is held since then."""
        self.state, self._closing = TakeState.done, since
        return self._bracket(Span(self._began, released), Span(since, time), since)

    def _end_too_long(self, released: float, time: float) -> Bracket | None:
        """End the take without a trigger, if it lasts longer than a take may."""
        if time - released <= LONGEST_TAKE:
            return None
        self.state = TakeState.idle
        return self._unclosed(released, released + LONGEST_TAKE)

    def _find_gap(self, time: float) -> Bracket | None:
        ended, self._ended = self._ended, None
        if ended is None or not SHORTEST_TAKE <= self._began - ended.end <= LONGEST_TAKE:
            return None
        return self._bracket(ended, Span(self._began, time), self._began)

    def _unclosed(self, released: float, end: float) -> Bracket:
        return self._bracket(Span(self._began, released), None, end)

    def _bracket(self, opening: Span, closing: Span | None, end: float) -> Bracket:
        """Build a bracket, with the spans in which another trigger may have been missed."""
        unseen = find_missable(tuple(self._clear), opening.end, end, self.trigger.hold)
        return Bracket(opening, closing, end, unseen)


def create_held_pose() -> HeldTrigger:
    """Create the detector of a held pose of the arms."""
    return HeldTrigger(hold=POSE_SECONDS, leave=POSE_LEAVE_SCORE)


@dataclass(frozen=True)
class Take:
    """One take: what lies between two triggers.

    Attributes
    ----------
    start, end
        Seconds in the clip: the release of the start trigger, the beginning of the stop trigger.
    closed
        Whether a stop trigger ended it; else `end` is where the clip (or the time allowed) ends.
    poses
        The stroke, without the transits from and to the triggers.
    stroke_start, stroke_end
        Seconds in the clip between which `poses` lies.
    untrimmed
        Everything between the triggers.
    unseen
        Spans in which a trigger may have been missed: such a take gets no label.

    """

    start: float
    end: float
    closed: bool
    poses: PoseSequence
    stroke_start: float
    stroke_end: float
    untrimmed: PoseSequence
    unseen: tuple[Span, ...] = ()


def takes_in(
    recording: Recording, *, trim: bool = True, trigger: Trigger = SALUTE
) -> tuple[Take, ...]:
    """Find the takes of a recording.

    Parameters
    ----------
    recording
        The recording of a clip.
    trim
        Whether to trim the transits from and to the triggers (`recording.trimming`).
    trigger
        What begins and ends a take, as the language says (`Language.trigger`).

    Returns
    -------
    The takes in order; none without triggers, and none for a language without trigger, whose
    gestures a `Spotter` finds. Only the last one can be unclosed, unless a stop trigger was
    forgotten for `LONGEST_TAKE` seconds, or start and stop triggers differ.

    """
    return tuple(
        cut_take(recording.poses, bracket, trim=trim, trigger=trigger)
        for bracket in find_brackets(recording, trigger)
    )


def find_brackets(recording: Recording, trigger: Trigger = SALUTE) -> list[Bracket]:
    """Find the triggers around each take of a recording; parameters and order as in `takes_in`."""
    machine = TakeMachine.of(trigger)
    times = recording.poses.time.tolist()
    begin, end = trigger.score(recording.poses, recording.salute)
    found = [
        machine.update(time, score, stop_score)
        for time, score, stop_score in zip(times, begin.tolist(), end.tolist(), strict=True)
    ]
    if times:
        found.append(machine.finish(times[-1]))
    return [bracket for bracket in found if bracket]


def list_unseen(recording: Recording, trigger: Trigger = SALUTE) -> tuple[Span, ...]:
    """Return the spans of a recording in which a trigger may have been missed, holes first."""
    takes = find_brackets(recording, trigger)
    return (
        *find_holes(recording.poses.time),
        *(span for take in takes for span in take.unseen),
    )


def find_takes(
    clip: str | Path,
    *,
    estimator: PoseEstimator | None = None,
    progress: Progress | None = None,
    trim: bool = True,
    water: WaterCorrection = "auto",
    trigger: Trigger = SALUTE,
) -> tuple[Take, ...]:
    """Find the takes of a clip; see `extraction.record` and `takes_in`."""
    recording = record(clip, estimator=estimator, progress=progress, water=water)
    return takes_in(recording, trim=trim, trigger=trigger)


def cut_take(
    poses: PoseSequence, bracket: Bracket, *, trim: bool = True, trigger: Trigger = SALUTE
) -> Take:
    """Cut a take out of a pose sequence.

    Parameters
    ----------
    poses
        Poses that cover the bracket with its triggers.
    bracket
        The triggers around the take.
    trim, trigger
        As in `takes_in`.

    """
    untrimmed = poses.between(bracket.start, bracket.end)
    stroke = Span(bracket.start, bracket.end)
    # A camera that stalls may have given no frame in between.
    if trim and len(untrimmed):
        around = poses.between(
            bracket.opening.start,
            bracket.closing.end if bracket.closing else bracket.end,
        )
        stroke = find_stroke(
            repair_poses(around).poses,
            bracket.opening,
            bracket.closing,
            posed=trigger.kind == "pose",
        )
    return Take(
        start=bracket.start,
        end=bracket.end,
        closed=bracket.closed,
        poses=untrimmed.between(stroke.start, stroke.end),
        stroke_start=stroke.start,
        stroke_end=stroke.end,
        untrimmed=untrimmed,
        unseen=bracket.unseen,
    )
