"""Live segmentation: finds takes frame by frame, with the same rules as in recorded clips.

`LiveTakes` finds the takes. `PeopleInStream` decides whose body counts where several are seen and
the future is not known.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from app.recognition.estimation.person_tracker import PATIENCE_SECONDS, PeopleTracks
from app.recognition.poses.frame import FrameLandmarks
from app.recognition.poses.sequence import PoseSequence, join_sequences
from app.recognition.recording.extraction import build_frame_sequence
from app.recognition.recording.people import keep_person, see_people
from app.recognition.recording.salute import (
    ENTER_SCORE,
    LEAVE_SCORE,
    LONGEST_TAKE,
    SHORTEST_TAKE,
    HeldTrigger,
    best_salute,
)
from app.recognition.recording.segmentation import (
    Bracket,
    Take,
    TakeMachine,
    TakeState,
    cut_take,
)
from app.recognition.triggers.trigger import SALUTE, Trigger


@dataclass(frozen=True, eq=False)
class Followed:
    """What a stream shows of the person who is followed, up to its newest frame.

    Attributes
    ----------
    frames
        Times and landmarks: the newest frame, or, where the person was changed after the fact, all
        frames since that person's first salute.
    change
        A sentence where another person is followed from now on; empty otherwise.

    """

    frames: tuple[tuple[float, FrameLandmarks], ...]
    change: str = ""

    @property
    def restarts(self) -> bool:
        """Whether the frames replace those that were given before."""
        return len(self.frames) > 1


@dataclass(eq=False)
class _Diver:
    """A person in a stream: held salutes, and the frames since one that was ignored."""

    trigger: HeldTrigger = field(default_factory=HeldTrigger)
    held: bool = False
    released: float = -np.inf
    ignored: bool = False
    frames: list[tuple[float, FrameLandmarks]] = field(default_factory=list)

    def begins_salute(self, time: float, score: float) -> bool:
        """Process a frame's salute score, and return whether a held salute begins with it."""
        was_held, self.held = self.held, self.trigger.update(time, score)
        if not self.held:
            return False
        since, before = self.trigger.since, self.released
        self.released = time
        return not was_held and since is not None and since - before >= SHORTEST_TAKE


class PeopleInStream:
    """Follows one person in the frames of a camera, in order.

    It is the one whom the estimator follows, until another one salutes. During a take, which one
    salute has begun and another one will end, the salute of another diver changes nothing. Only
    that diver's second one does, since it ends a take too: the frames since the first one are then
    given again, with that diver's body.

    Parameters
    ----------
    by_salute
        Whether salutes change the person; not where a language has another trigger.

    """

    def __init__(self, *, by_salute: bool = True) -> None:
        self.by_salute = by_salute
        self.reset()

    def reset(self) -> None:
        """Forget everybody, before another stream."""
        self._tracks = PeopleTracks()
        self._divers: dict[int, _Diver] = {}
        self._owner: int | None = None
        self._told: int | None = None
        self._since = -np.inf
        self._open: float | None = None
        self._time = -np.inf

    def follow(self, time: float, found: FrameLandmarks) -> Followed:
        """Process the next frame.

        Parameters
        ----------
        time
            Seconds; a time that is not later than in the call before begins another stream.
        found
            The landmarks of everybody in it.

        """
        if time <= self._time:
            self.reset()
        self._time = time
        people, _ = see_people(found)
        who = self._tracks.assign([person.xy for person in people], time)
        salutes = {track: person.salute for track, person in zip(who, people, strict=True)}
        for track in who:
            self._divers.setdefault(track, _Diver())
        self._drop_gone()
        begun = {
            track
            for track, diver in self._divers.items()
            if diver.begins_salute(time, salutes.get(track, 0.0))
        }
        kept = {track: keep_person(found, place) for place, track in enumerate(who)}
        self._stay(time, who)
        if self.by_salute:
            if self._open is None:
                self._turn_to_salute(time, salutes, begun)
            elif (other := self._find_second(time, begun)) is not None:
                frames = (*self._divers[other].frames, (time, kept[other]))
                self._owner, self._open = other, None
                return Followed(frames, self._tell_change())
            self._remember(time, kept, salutes)
        change = self._tell_change() if self._open == time else ""
        owner = self._owner
        return Followed(
            ((time, kept[owner] if owner in kept else keep_person(found, None)),), change
        )

    def _stay(self, time: float, who: Sequence[int]) -> None:
        """Keep the followed person, or take the first one in view where they are gone."""
        if self._owner in who:
            self._since = time
        elif who and self._open is None and time - self._since > PATIENCE_SECONDS:
            self._owner, self._since = who[0], time
        if self._told is None:
            self._told = self._owner
        if self._open is not None and time - self._open > LONGEST_TAKE:
            self._end_take()

    def _turn_to_salute(self, time: float, salutes: dict[int, float], begun: set[int]) -> None:
        """Follow whoever salutes, where no take is open; a held salute opens one."""
        own = -1 if self._owner is None else self._owner
        best = max(salutes, key=salutes.__getitem__, default=own)
        if salutes.get(own, 0.0) < LEAVE_SCORE and salutes.get(best, 0.0) >= ENTER_SCORE:
            self._owner = best
        if self._owner in begun:
            self._open = time

    def _find_second(self, time: float, begun: set[int]) -> int | None:
        """Close the take at the second salute of the diver who began it, or of another one."""
        lost = time - self._since > PATIENCE_SECONDS
        if self._owner in begun or (lost and begun):
            self._end_take()
            return None
        for track in sorted(begun):
            diver = self._divers[track]
            if diver.ignored:
                return track
            diver.ignored = True
        return None

    def _remember(
        self, time: float, kept: dict[int, FrameLandmarks], salutes: dict[int, float]
    ) -> None:
        """Keep the frames of others from the first one of an ignored salute on."""
        for track, found in kept.items():
            diver = self._divers[track]
            salutes_on = diver.ignored or diver.held or salutes[track] >= LEAVE_SCORE
            if self._open is not None and track != self._owner and salutes_on:
                diver.frames.append((time, found))
            else:
                diver.frames.clear()

    def _drop_gone(self) -> None:
        """Forget people who cannot be known again, so that memory does not grow."""
        alive = self._tracks.alive
        self._divers = {track: each for track, each in self._divers.items() if track in alive}

    def _end_take(self) -> None:
        self._open = None
        for diver in self._divers.values():
            diver.ignored = False
            diver.frames.clear()

    def _tell_change(self) -> str:
        """Return what to say where another person is followed than was said last."""
        if self._owner == self._told:
            return ""
        self._told = self._owner
        return "another diver salutes; the body is that diver's from now on"


LONGEST_TRIGGER = 10.0
"""Seconds of a start trigger kept in addition to the longest take: the transit takes one, and a
camera that stalls may need some until the trigger counts."""


@dataclass(frozen=True, eq=False)
class Sight:
    """The result of one frame of a camera.

    Attributes
    ----------
    score
        Score in [0, 1] of the trigger; of a salute, that of the best hand.
    held
        Whether it has been held long enough to count, and still is.
    state
        Whether the machine waits for a trigger, is in a take, or waits for the end of the trigger
        that ended it.
    take
        The take that this frame ends, if it ends one.

    """

    score: float
    held: bool
    state: TakeState
    take: Take | None


class LiveTakes:
    """Finds the takes of a camera's frames, one frame at a time.

    Memory is bounded: only the landmarks of the longest take and its start trigger are kept.

    Parameters
    ----------
    frame_size
        Width and height of the images in pixels.
    trigger
        What begins and ends a take.

    """

    def __init__(self, frame_size: tuple[int, int], trigger: Trigger = SALUTE) -> None:
        self.frame_size = frame_size
        self.trigger = trigger
        self._machine = TakeMachine.of(trigger)
        self._moments: deque[PoseSequence] = deque()

    def __len__(self) -> int:
        """Return the number of frames kept."""
        return len(self._moments)

    def feed(self, time: float, found: FrameLandmarks) -> Sight:
        """Process the next frame.

        Parameters
        ----------
        time
            Seconds in any clock, later than in every call before.
        found
            The landmarks of the frame.

        """
        return self.feed_moment(
            build_frame_sequence(found, time, self.frame_size), best_salute(found.hands)
        )

    def feed_moment(self, moment: PoseSequence, salute: float) -> Sight:
        """Process the next frame, given as poses and salute score.

        Parameters
        ----------
        moment
            The poses of that frame alone, later than in every call before.
        salute
            Score in [0, 1] of the best salute (`best_salute`).

        """
        time = float(moment.time[0])
        self._moments.append(moment)
        # Before old frames are dropped: after a pause, the take that it ends is among them.
        begin, end = (
            float(each[0]) for each in self.trigger.score(moment, np.array([salute], np.float64))
        )
        take = self._cut(self._machine.update(time, begin, end))
        if self._machine.gap is None:
            self._drop_old_frames(time)
        return Sight(
            score=max(begin, end),
            held=self._machine.held,
            state=self._machine.state,
            take=take,
        )

    def cut_gap(self) -> Take | None:
        """Cut out the gap before the trigger with which the last frame began a take.

        The gap lies between that trigger and the one that ended the previous take. Where a trigger
        was missed, all later ones are paired wrongly, and the gap is the take.

        Returns
        -------
        None where the last frame began no take, or too little or too much lies in between.

        """
        return self._cut(self._machine.gap)

    def end_gap(self) -> None:
        """Let the trigger that began a take with the last frame end the gap before it instead."""
        self._machine.end_gap()

    def finish(self) -> Take | None:
        """End the stream and return the unclosed take, if there is one."""
        if not self._moments:
            return None
        return self._cut(self._machine.finish(float(self._moments[-1].time[0])))

    def _cut(self, bracket: Bracket | None) -> Take | None:
        if bracket is None:
            return None
        return cut_take(join_sequences(self._moments), bracket, trigger=self.trigger)

    def _drop_old_frames(self, time: float) -> None:
        machine = self._machine
        short = machine.state is TakeState.idle and not machine.remembers(time)
        memory = LONGEST_TRIGGER if short else LONGEST_TAKE + LONGEST_TRIGGER
        while time - self._moments[0].time[0] > memory:
            self._moments.popleft()
