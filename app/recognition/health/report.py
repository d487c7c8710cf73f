"""Health report: the result of a check, with its forecast and findings."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from app.recognition.decision.fused_vote import FusedVote
from app.recognition.gestures.switches import Sensitivity
from app.recognition.health.finding import Finding
from app.recognition.health.forecast import Forecast
from app.recognition.health.rate import DIGITS, Rate, to_plain
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
        ``(G, 2)``: the gestures on a map, see `embedding.embed_gestures`.
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
