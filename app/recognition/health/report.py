"""Health report: the result of a check, with its forecast and findings."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from app.recognition.decision.fused_vote import FusedVote
from app.recognition.gestures.switches import Sensitivity
from app.recognition.health.finding import Finding
from app.recognition.health.forecast import OUTCOMES, Forecast
from app.recognition.health.rate import DIGITS, Rate
from app.recognition.health.trigger_health import TriggerHealth
from app.recognition.poses.sequence import FloatArray
from app.recognition.recognizer import Recognizer


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
        rates = {outcome: forecast.count(outcome, self.label) for outcome in OUTCOMES}
        return {
            "label": self.label,
            "seconds": None if self.seconds is None else round(self.seconds, DIGITS),
            "landmarks": [landmark.to_dict() for landmark in self.landmarks],
            "counts": self.counts and vars(self.counts),
            "nearest": self.nearest
            and {"label": self.nearest[0], "distance": round(self.nearest[1], DIGITS)},
            **{outcome: rate and rate.to_dict() for outcome, rate in rates.items()},
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

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON types."""
        return {
            "people": self.people,
            "most_refused": self.most_refused,
            "limit": round(self.limit, DIGITS),
            "measured": self.measured,
            "refused": self.refused and self.refused.to_dict(),
            "accepted": self.accepted and self.accepted.to_dict(),
        }


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
        ``(G, 2)``: the gestures on a map, see `embedding.embed_gestures`.
    trigger
        Rates of the trigger where that is a pose of the arms.
    limit
        The limit and its costs; None in a language without movements.

    """

    language: str
    revision: int
    forecast: Forecast
    gestures: tuple[GestureHealth, ...]
    findings: tuple[Finding, ...]
    places: FloatArray
    trigger: TriggerHealth | None = None
    limit: LimitHealth | None = None

    @property
    def ok(self) -> bool:
        """Whether there is no error."""
        return not any(finding.error for finding in self.findings)

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON types."""
        labels = [gesture.label for gesture in self.gestures]
        places = np.round(self.places, DIGITS).tolist()
        return {
            "language": self.language,
            "revision": self.revision,
            "ok": self.ok,
            "forecast": self.forecast.to_dict(),
            "trigger": self.trigger and self.trigger.to_dict(),
            "limit": self.limit and self.limit.to_dict(),
            "gestures": [gesture.to_dict(self.forecast) for gesture in self.gestures],
            "warnings": [finding.to_dict() for finding in self.findings],
            "map": [
                {"label": label, "x": x, "y": y}
                for label, (x, y) in zip(labels, places, strict=True)
            ],
        }
