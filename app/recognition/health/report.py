"""Health report: the result of a check, with estimated rates and findings."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from app.recognition.decision.fused_vote import FusedVote
from app.recognition.health.finding import Finding
from app.recognition.health.remedy import is_worse
from app.recognition.health.trigger_health import TriggerHealth
from app.recognition.health.viewing_angles import AngleHealth
from app.recognition.poses.sequence import FloatArray
from app.recognition.recognizer import Recognizer
from app.recognition.simulation.rate_estimate import DIGITS, RateEstimate
from app.recognition.simulation.variation import Person

MOST_CONFUSION = 0.05
"""Threshold for the confusion of a pair: one wrong action in twenty commands."""

MOST_MISSED = 0.1
"""Threshold for missed takes of a gesture, which cost a repetition only. Rejection is calibrated to
one take in twenty; twice as many point to the gesture itself."""


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

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON types."""
        return {
            "landmark": self.landmark,
            "displacement": round(self.displacement, DIGITS),
            "visible": round(self.visible, DIGITS),
        }


@dataclass(frozen=True)
class GestureHealth:
    """Estimated rates of one gesture.

    Attributes
    ----------
    label
        Its label.
    seconds
        Duration of its demonstration; None without one.
    landmarks
        Its salient landmarks.
    missed
        Rate of its takes that are confused or rejected; None without demonstration.
    refused
        Rate of its takes that are rejected.
    false_alarms
        Rate of background motion that is recognised as it; None where the simulated movements lack
        its landmarks.
    set_off_by
        Kinds of background motion that are recognised as it, in words.
    angles
        Its rates when the diver is turned; empty where its demonstration has no depth.

    """

    label: str
    seconds: float | None
    landmarks: tuple[LandmarkHealth, ...]
    missed: RateEstimate | None
    refused: RateEstimate | None
    false_alarms: RateEstimate | None
    set_off_by: tuple[str, ...]
    angles: tuple[AngleHealth, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON types."""
        return {
            "label": self.label,
            "seconds": None if self.seconds is None else round(self.seconds, DIGITS),
            "landmarks": [landmark.to_dict() for landmark in self.landmarks],
            "missed": self.missed and self.missed.to_dict(),
            "refused": self.refused and self.refused.to_dict(),
            "false_alarms": self.false_alarms and self.false_alarms.to_dict(),
            "set_off_by": list(self.set_off_by),
            "angles": [angle.to_dict() for angle in self.angles],
        }


@dataclass(frozen=True)
class PairHealth:
    """Estimated confusion of two gestures.

    Attributes
    ----------
    gestures
        The two labels.
    first_as_second, second_as_first
        Rate of takes of the one that are nearer to the other; None without its demonstration.
    distance
        Fused distance of the two demonstrations, 1 = as different as two typical gestures; None
        where they cannot be compared.

    """

    gestures: tuple[str, str]
    first_as_second: RateEstimate | None
    second_as_first: RateEstimate | None
    distance: float | None

    @property
    def confusion(self) -> RateEstimate | None:
        """The worse of the two directions."""
        if self.first_as_second is None or self.second_as_first is None:
            return self.first_as_second or self.second_as_first
        return is_worse(self.first_as_second, self.second_as_first)

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON types."""
        confusion, forth, back = self.confusion, self.first_as_second, self.second_as_first
        return {
            "gestures": list(self.gestures),
            "confusion": confusion and confusion.to_dict(),
            "first_as_second": forth and forth.to_dict(),
            "second_as_first": back and back.to_dict(),
            "distance": None if self.distance is None else round(self.distance, DIGITS),
        }


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
    takes
        Numbers of demonstrations behind `refused` and `accepted`.

    """

    people: int
    most_refused: float
    limit: float
    measured: bool
    refused: RateEstimate | None
    accepted: RateEstimate | None
    takes: tuple[int, int]

    @classmethod
    def measure(cls, recognizer: Recognizer) -> LimitHealth | None:
        """Measure the costs of a language's limit; None in a language without movements."""
        vote = recognizer.vote
        if not isinstance(vote, FusedVote) or not vote.others.people:
            return None
        others, limit = vote.others, vote.limit
        takes = len(others.right), len(others.foreign)
        refused, accepted = int((others.right > limit).sum()), int((others.foreign <= limit).sum())
        return cls(
            people=others.people,
            most_refused=recognizer.language.most_refused,
            limit=limit,
            measured=others.suffice,
            refused=RateEstimate.of_count(refused, takes[0]) if takes[0] else None,
            accepted=RateEstimate.of_count(accepted, takes[1]) if takes[1] else None,
            takes=takes,
        )

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON types."""
        refused, accepted = (
            rate and {**rate.to_dict(), "n": count}
            for rate, count in zip((self.refused, self.accepted), self.takes, strict=True)
        )
        return {
            "people": self.people,
            "most_refused": self.most_refused,
            "limit": round(self.limit, DIGITS),
            "measured": self.measured,
            "refused": refused,
            "accepted": accepted,
        }


@dataclass(frozen=True, eq=False, kw_only=True)
class HealthReport:
    """The result of a check.

    Attributes
    ----------
    language, revision
        Name and revision of the checked language.
    person
        The diver: the demonstrator (``same``), or another person.
    takes
        Number of simulated takes of each gesture.
    gestures
        In the language's order.
    pairs
        Those that were compared, the most confused first.
    findings
        Errors first, then notes.
    places
        ``(G, 2)``: the gestures on a map, see `embedding.embed_gestures`.
    neighbours
        Number of nearest gestures that each one is compared with; None: with all of them.
    trigger
        Rates of the trigger where that is a pose of the arms or a gesture.
    limit
        The limit and its costs; None in a language without movements.

    """

    language: str
    revision: int
    person: Person
    takes: int
    gestures: tuple[GestureHealth, ...]
    pairs: tuple[PairHealth, ...]
    findings: tuple[Finding, ...]
    places: FloatArray
    neighbours: int | None = None
    trigger: TriggerHealth | None = None
    limit: LimitHealth | None = None

    @property
    def ok(self) -> bool:
        """Whether there is no error."""
        return not any(finding.below_bar for finding in self.findings)

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON types."""
        labels = [gesture.label for gesture in self.gestures]
        places = np.round(self.places, DIGITS).tolist()
        return {
            "language": self.language,
            "revision": self.revision,
            "person": self.person,
            "takes": self.takes,
            "bar": {"confusion": MOST_CONFUSION, "missed": MOST_MISSED},
            "ok": self.ok,
            "neighbours": self.neighbours,
            "trigger": self.trigger and self.trigger.to_dict(),
            "limit": self.limit and self.limit.to_dict(),
            "gestures": [gesture.to_dict() for gesture in self.gestures],
            "pairs": [pair.to_dict() for pair in self.pairs],
            "warnings": [finding.to_dict() for finding in self.findings],
            "map": [
                {"label": label, "x": x, "y": y}
                for label, (x, y) in zip(labels, places, strict=True)
            ],
        }
