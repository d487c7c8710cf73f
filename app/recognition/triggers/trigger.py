"""Trigger of a language: what a diver holds before and after a gesture."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np

from app.recognition.errors import TriggerError
from app.recognition.poses.landmarks import SHOULDERS
from app.recognition.poses.sequence import FloatArray, PoseSequence
from app.recognition.triggers.arm_pose import ARM_JOINTS, ArmPose, locate_arms

TriggerKind = Literal["salute", "pose", "gesture", "none"]

MOST_ALIKE = 0.1
"""Largest score of the stop pose as the start pose: the two then differ by more than the tolerance
for another body."""


@dataclass(frozen=True)
class Trigger:
    """What begins and ends a take.

    Attributes
    ----------
    kind
        ``salute``: a Vulcan salute. ``pose``: a held pose of the arms. ``gesture``: a gesture of
        the language; gestures spotted between two of them count (`app.recognition.spotting`).
        ``none``: nothing; gestures are spotted anywhere.
    start
        Of kind ``pose``, the pose that begins a take.
    stop
        The pose that ends it; None: `start` ends it too.
    start_label, stop_label
        Of kind ``gesture``, the labels of the gestures that begin and end; empty for other kinds.
        An empty `stop_label` becomes `start_label`.

    Raises
    ------
    TriggerError
        When a pose or label is missing or superfluous, or start and stop are too much alike.

    """

    kind: TriggerKind = "salute"
    start: ArmPose | None = None
    stop: ArmPose | None = None
    start_label: str = ""
    stop_label: str = ""

    def __post_init__(self) -> None:
        """Validate the poses and labels."""
        if bool(self.start_label) != (self.kind == "gesture"):
            raise TriggerError(
                f"a trigger of kind {self.kind!r} "
                + ("needs a gesture" if self.kind == "gesture" else "has no gestures")
            )
        if self.stop_label and not self.start_label:
            raise TriggerError(f"a trigger of kind {self.kind!r} has no gestures")
        object.__setattr__(self, "stop_label", self.stop_label or self.start_label)
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
        """The trigger in words, for people."""
        if self.kind == "none":
            return "without a trigger, gestures anywhere"
        if self.kind == "gesture":
            return f"between the gestures {self.start_label!r} and {self.stop_label!r}"
        if self.start is None:
            return "between two salutes"
        if self.stop is None:
            return f"between two poses of the arms ({self.start.words})"
        return f"between two poses of the arms ({self.start.words}; {self.stop.words})"

    @property
    def labels(self) -> frozenset[str]:
        """Labels of the gestures that begin and end; none of other kinds."""
        return frozenset({self.start_label, self.stop_label} - {""})

    @property
    def spots(self) -> bool:
        """Whether gestures are spotted in continuous motion, as no held trigger brackets them."""
        return self.kind in ("gesture", "none")

    def renamed(self, before: str, after: str) -> Trigger:
        """Return the trigger in which a gesture has another label."""
        start, stop = (
            after if label == before else label for label in (self.start_label, self.stop_label)
        )
        return replace(self, start_label=start, stop_label=stop)

    @property
    def noun(self) -> str:
        """What a diver shows before and after a gesture: "salute" without another trigger."""
        return {"pose": "pose of the arms", "gesture": "gesture"}.get(self.kind, "salute")

    @property
    def landmarks(self) -> tuple[str, ...]:
        """The body's landmarks by which it is seen."""
        return (*SHOULDERS, *ARM_JOINTS) if self.kind == "pose" else ()

    def score(self, poses: PoseSequence, salute: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the scores of every frame for what begins a take and for what ends it.

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
