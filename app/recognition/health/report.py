"""Health report: the result of a check, with its forecast and findings, and the trigger's rates.

`check_trigger` counts how often a trigger is missed, and how often ordinary movement sets it off.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from app.recognition.decision.fused_vote import FusedVote
from app.recognition.gestures.gesture import Gesture
from app.recognition.gestures.switches import Sensitivity
from app.recognition.health.finding import DIGITS, Finding, Rate, to_plain
from app.recognition.health.forecast import Forecast
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.recognizer import Recognizer
from app.recognition.recording.salute import ENTER_SCORE, HeldTrigger
from app.recognition.recording.segmentation import create_held_pose
from app.recognition.simulation.background_motion import (
    simulate_background_motion,
    simulate_held_poses,
)
from app.recognition.triggers.trigger import ArmPose, Trigger, locate_joints

PEOPLE = 100
"""Simulated people who hold each pose: the interval of a rate of 5 % is about 2 to 11 %."""

EXAMPLES = 30
"""Examples of each kind of ordinary movement: about 20 minutes of arms that move all the time."""

MOST_MISSED = 0.1
"""Share of people whose pose is missed from which it is an error: each has to show it again."""

MOST_AN_HOUR = 60.0
"""Least number of takes, begun in an hour of arms that move all the time, for a note: one a minute.
Each costs a take that is rejected, not a command, since the second pose is missing."""

SECONDS_AN_HOUR = 3600.0


@dataclass(frozen=True)
class TriggerHealth:
    """Rates of a trigger that is a pose of the arms, by simulated people and ordinary movement.

    Attributes
    ----------
    words
        The trigger, for people.
    missed
        Rate of other people whose pose is not seen; the higher rate of two poses.
    false_per_hour
        Times that ordinary movement begins a take, in an hour of arms that move all the time.
    set_off_by
        Kinds of ordinary movement that begin a take, the most frequent first.

    """

    words: str
    missed: Rate
    false_per_hour: float
    set_off_by: tuple[str, ...]


def check_trigger(trigger: Trigger) -> TriggerHealth | None:
    """Count the rates of a trigger in simulated movement; None unless it is a pose of the arms."""
    if trigger.start is None:
        return None
    poses = [pose for pose in (trigger.start, trigger.stop) if pose is not None]
    missed = max(map(_count_missed, poses), key=lambda each: each.rate)
    begun: dict[str, int] = {}
    seconds = 0.0
    for movement in simulate_background_motion(EXAMPLES):
        shown = movement.trajectory
        seconds += float(shown.time[-1])
        if times := _count_held(trigger.start, shown):
            begun[movement.kind] = begun.get(movement.kind, 0) + times
    return TriggerHealth(
        words=trigger.words,
        missed=missed,
        false_per_hour=sum(begun.values()) * SECONDS_AN_HOUR / seconds,
        set_off_by=tuple(sorted(begun, key=lambda kind: -begun[kind])),
    )


def list_trigger_findings(
    trigger: Trigger, health: TriggerHealth | None, gestures: Sequence[Gesture]
) -> Iterator[Finding]:
    """Yield the findings about a trigger and the gestures that resemble it."""
    if trigger.kind == "none":
        message = (
            "the language has no trigger, so that gestures are found anywhere: ordinary movement "
            "is recognised as a gesture more often than between triggers"
        )
        yield Finding("untriggered", (), message)
    if health is None:
        return
    if health.missed.rate > MOST_MISSED:
        message = (
            f"the trigger's pose is not seen of {health.missed.rate:.0%} of other people: choose "
            "one with the hands farther from where they usually are"
        )
        yield Finding("trigger_missed", (), message, error=True)
    if health.false_per_hour > MOST_AN_HOUR:
        message = (
            f"ordinary movement holds the trigger's pose about {health.false_per_hour:.0f} times "
            f"in an hour of moving arms: {', '.join(health.set_off_by)}"
        )
        yield Finding("trigger_accidental", (), message)
    poses = [pose for pose in (trigger.start, trigger.stop) if pose is not None]
    for gesture in gestures:
        if gesture.trajectory is not None:
            yield from _check_gesture(gesture.label, gesture.trajectory, poses)


def _check_gesture(label: str, shown: Trajectory, poses: Sequence[ArmPose]) -> Iterator[Finding]:
    if any(_count_held(pose, shown) for pose in poses):
        message = (
            f"{label} holds the trigger's pose, which ends the take in the middle of it: choose "
            "another trigger, or show the gesture without that pose"
        )
        yield Finding("trigger_like", (label,), message, error=True)
    elif any((_score(pose, shown) >= ENTER_SCORE).any() for pose in poses):
        message = (
            f"{label} passes through the trigger's pose: shown slowly, it ends the take in the "
            "middle of it"
        )
        yield Finding("trigger_passed", (label,), message)


def _count_missed(pose: ArmPose) -> Rate:
    people = simulate_held_poses(pose, PEOPLE)
    seen = sum(_run(create_held_pose(), each.time, pose.score(each.places)) > 0 for each in people)
    return Rate(len(people) - seen, len(people))


def _count_held(pose: ArmPose, shown: Trajectory) -> int:
    return _run(create_held_pose(), shown.time, _score(pose, shown))


def _score(pose: ArmPose, shown: Trajectory) -> FloatArray:
    return pose.score(locate_joints(shown.landmarks, shown.xy))


def _run(held: HeldTrigger, time: FloatArray, scores: FloatArray) -> int:
    """Return how many times a stream of scores becomes held."""
    states = [held.update(*each) for each in zip(time.tolist(), scores.tolist(), strict=True)]
    return int(np.count_nonzero(np.diff(np.array([False, *states], dtype=np.int8)) > 0))


@dataclass(frozen=True)
class LandmarkHealth:
    """A salient landmark of a gesture.

    Attributes
    ----------
    landmark
        Its name.
    displacement
        Its displacement, peak to peak, in the demonstration's unit.
    visible
        Share of the demonstration's moments in which it is seen.

    """

    landmark: str
    displacement: float
    visible: float


@dataclass(frozen=True)
class GestureHealth:
    """What is known of one gesture.

    Attributes
    ----------
    label
        Its label.
    seconds
        Duration of its demonstration; None without one.
    landmarks
        Its salient landmarks.
    counts
        What tells it apart beside its figure; None without a movement.
    nearest
        The other gesture whose demonstration is nearest, and the fused distance between both, 1 =
        as different as two typical gestures; None where no other one is comparable.

    """

    label: str
    seconds: float | None
    landmarks: tuple[LandmarkHealth, ...]
    counts: Sensitivity | None
    nearest: tuple[str, float] | None

    def to_dict(self, forecast: Forecast) -> dict[str, Any]:
        """Return plain JSON types, with the gesture's part of the forecast."""
        near = self.nearest and dict(zip(("label", "distance"), self.nearest, strict=True))
        return dict(to_plain(vars(self) | {"nearest": near} | forecast.counts(self.label)))


@dataclass(frozen=True)
class LimitHealth:
    """The limit of a language and its two costs, measured by its own demonstrations.

    Attributes
    ----------
    people
        Number of people who have shown movements; those who are not named count as one.
    most_refused
        The dial: share of right takes that may be rejected.
    limit
        Score beyond which a movement is rejected.
    measured
        Whether the limit follows from the dial; otherwise it is a cautious constant.
    refused
        Rate of demonstrations that the other people's demonstrations of their gesture reject; None
        where no gesture is shown by two people.
    accepted
        Rate of demonstrations that the other people's demonstrations of the other gestures accept:
        of takes of a gesture that the language lacks. None where there are no such demonstrations.

    """

    people: int
    most_refused: float
    limit: float
    measured: bool
    refused: Rate | None
    accepted: Rate | None

    @classmethod
    def measure(cls, recognizer: Recognizer) -> LimitHealth | None:
        """Measure the costs of a language's limit; None in a language without movements."""
        vote = recognizer.vote
        if not isinstance(vote, FusedVote) or not vote.others.people:
            return None
        others, limit = vote.others, vote.limit
        refused, accepted = int((others.right > limit).sum()), int((others.foreign <= limit).sum())
        return cls(
            people=others.people,
            most_refused=recognizer.language.most_refused,
            limit=limit,
            measured=others.suffice,
            refused=Rate(refused, len(others.right)) if len(others.right) else None,
            accepted=Rate(accepted, len(others.foreign)) if len(others.foreign) else None,
        )


@dataclass(frozen=True, eq=False, kw_only=True)
class HealthReport:
    """The result of a check.

    Attributes
    ----------
    language, revision
        Name and revision of the checked language.
    forecast
        What other people's takes will be read as, as far as it can be foretold.
    gestures
        In the language's order.
    findings
        Errors first, then notes.
    places
        ``(G, 2)``: the gestures on a map, see `check.embed_gestures`.
    trigger
        Rates of the trigger where that is a pose of the arms.
    limit
        The limit and its costs; None in a language without movements.

    """

    language: str
    revision: int
    forecast: Forecast
    gestures: tuple[GestureHealth, ...] = ()
    findings: tuple[Finding, ...]
    places: FloatArray = field(default_factory=lambda: np.zeros((0, 2)))
    trigger: TriggerHealth | None = None
    limit: LimitHealth | None = None

    @property
    def errors(self) -> int:
        """Number of errors."""
        return sum(finding.error for finding in self.findings)

    @property
    def ok(self) -> bool:
        """Whether there is no error."""
        return not self.errors

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON types."""
        limit = self.limit and to_plain(self.limit) | {"most_refused": self.limit.most_refused}
        places = zip(self.gestures, np.round(self.places, DIGITS).tolist(), strict=True)
        return {
            "language": self.language,
            "revision": self.revision,
            "ok": self.ok,
            "forecast": self.forecast.to_dict(),
            "trigger": to_plain(self.trigger),
            "limit": limit,
            "gestures": [gesture.to_dict(self.forecast) for gesture in self.gestures],
            "warnings": [finding.to_dict() for finding in self.findings],
            "map": [{"label": each.label, "x": x, "y": y} for each, (x, y) in places],
        }
