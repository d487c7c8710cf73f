"""Trigger of a language: what a diver holds before and after a gesture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from app.recognition.errors import TriggerError
from app.recognition.poses.landmarks import SHOULDERS
from app.recognition.poses.sequence import FloatArray, PoseSequence
from app.recognition.triggers.arm_pose import ARM_JOINTS, ArmPose, locate_arms

TriggerKind = Literal["salute", "pose", "none"]

MOST_ALIKE = 0.1
"""Largest score of the stop pose as the start pose: between the two lie then a tolerance and more
of another body."""


@dataclass(frozen=True)
class Trigger:
    """What begins and ends a take.

    Attributes
    ----------
    kind
        ``salute``: a Vulcan salute. ``pose``: a held pose of the arms. ``none``: nothing; gestures
        are found anywhere (`app.recognition.spotting`).
    start
        Of kind ``pose``, the pose that begins a take.
    stop
        The pose that ends it; None: `start` ends it too.

    Raises
    ------
    TriggerError
        When a pose is missing or superfluous, or start and stop are too much alike.

    """

    kind: TriggerKind = "salute"
    start: ArmPose | None = None
    stop: ArmPose | None = None

    def __post_init__(self) -> None:
        """Validate the poses."""
        if (self.start is not None) != (self.kind == "pose") or (self.stop and not self.start):
            raise TriggerError(
                f"a trigger of kind {self.kind!r} "
                + ("needs a start pose" if self.kind == "pose" else "has no poses")
            )
        if self.start and self.stop:
            alike = max(self.start.resembles(self.stop), self.stop.resembles(self.start))
            if alike > MOST_ALIKE:
                raise TriggerError(
                    f"the poses for start and stop are too much alike (score {alike:.2f}, at most "
                    f"{MOST_ALIKE:g}): hold clearly different ones, or leave the stop pose out"
                )

    @property
    def words(self) -> str:
        """What is held, for people."""
        if self.kind == "none":
            return "without a trigger, gestures anywhere"
        if self.start is None:
            return "between two salutes"
        if self.stop is None:
            return f"between two poses of the arms ({self.start.words})"
        return f"between two poses of the arms ({self.start.words}; {self.stop.words})"

    @property
    def noun(self) -> str:
        """What a diver holds, such as "salute"."""
        return "pose of the arms" if self.kind == "pose" else "salute"

    @property
    def landmarks(self) -> tuple[str, ...]:
        """The body's landmarks by which it is seen."""
        return (*SHOULDERS, *ARM_JOINTS) if self.kind == "pose" else ()

    def score(self, poses: PoseSequence, salute: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return how much every frame shows what begins a take, and what ends it.

        Parameters
        ----------
        poses
            T frames of a recording, or one of a stream.
        salute
            ``(T,)``: score of the best salute.

        Returns
        -------
        Two arrays ``(T,)`` in [0, 1], the same one twice where start and stop are the same. Of two
        poses, only the one that is held more has a score.

        """
        if self.kind == "salute":
            return salute, salute
        if self.start is None:
            nothing = np.zeros(len(poses))
            return nothing, nothing
        places = locate_arms(poses)
        start = self.start.score(places)
        if self.stop is None:
            return start, start
        stop = self.stop.score(places)
        return np.where(start >= stop, start, 0.0), np.where(stop > start, stop, 0.0)


SALUTE: Final = Trigger()
NO_TRIGGER: Final = Trigger("none")
