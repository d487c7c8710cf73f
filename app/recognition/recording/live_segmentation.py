"""Live segmentation: finds takes frame by frame, with the same rules as in recorded clips."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np

from app.recognition.poses.frame import FrameLandmarks
from app.recognition.poses.sequence import PoseSequence, join_sequences
from app.recognition.recording.extraction import build_frame_sequence
from app.recognition.recording.salute import best_salute
from app.recognition.recording.segmentation import (
    LONGEST_TAKE,
    Bracket,
    Take,
    TakeMachine,
    TakeState,
    cut_take,
)
from app.recognition.triggers.trigger import SALUTE, Trigger

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
