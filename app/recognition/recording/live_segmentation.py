"""Takes found while a camera runs: the same salutes and the same cut as in a recorded clip."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

from app.recognition.poses.frame import FrameLandmarks
from app.recognition.poses.sequence import PoseSequence, join_sequences
from app.recognition.recording.extraction import build_frame_sequence
from app.recognition.recording.salute import best_salute
from app.recognition.recording.segmentation import (
    LONGEST_TAKE,
    Take,
    TakeMachine,
    TakeState,
    cut_take,
)

LONGEST_SALUTE = 10.0
"""Seconds of a start salute that are remembered beside the longest take: the way of the hand from
it takes one, and a camera that stalls may need some until the salute counts."""


@dataclass(frozen=True, eq=False)
class Sight:
    """What one frame of a camera adds.

    Attributes
    ----------
    salute
        In [0, 1]: how much the best hand salutes.
    held
        Whether a salute was held long enough to count, and still is.
    state
        Whether a salute is awaited, a take goes on, or the salute that ended it is still held.
    take
        The take that this frame ends, if it ends one.

    """

    salute: float
    held: bool
    state: TakeState
    take: Take | None


class LiveTakes:
    """Finds the takes of a camera's frames, one frame at a time.

    Memory is bounded: no more than the longest take and its start salute are kept, as landmarks.

    Parameters
    ----------
    frame_size
        Width and height of the images in pixels.

    """

    def __init__(self, frame_size: tuple[int, int]) -> None:
        self.frame_size = frame_size
        self._machine = TakeMachine()
        self._moments: deque[PoseSequence] = deque()

    def __len__(self) -> int:
        """Count the frames that are remembered."""
        return len(self._moments)

    def feed(self, time: float, found: FrameLandmarks) -> Sight:
        """Take the next frame.

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
        """Take the next frame, whose landmarks and salute came apart.

        Parameters
        ----------
        moment
            The body in that frame alone, later than in every call before.
        salute
            In [0, 1]: how much the best hand salutes (`best_salute`).

        """
        time = float(moment.time[0])
        self._moments.append(moment)
        idle = self._machine.state is TakeState.idle
        memory = LONGEST_SALUTE if idle else LONGEST_TAKE + LONGEST_SALUTE
        while time - self._moments[0].time[0] > memory:
            self._moments.popleft()
        bracket = self._machine.update(time, salute)
        return Sight(
            salute=salute,
            held=self._machine.trigger.held,
            state=self._machine.state,
            take=cut_take(join_sequences(self._moments), bracket) if bracket else None,
        )

    def finish(self) -> Take | None:
        """End the stream; return the take that was begun and not closed, if there is one."""
        if not self._moments:
            return None
        bracket = self._machine.finish(float(self._moments[-1].time[0]))
        return cut_take(join_sequences(self._moments), bracket) if bracket else None
