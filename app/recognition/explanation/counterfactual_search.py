"""Counterfactuals: the interventions that would have corrected a recognition.

Each is verified by applying the intervention and running the recogniser again.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final

import numpy as np

from app.recognition.errors import OsgError
from app.recognition.explanation.context import RecognitionContext
from app.recognition.explanation.counterfactual_candidates import list_interventions
from app.recognition.explanation.counterfactual_kinds import Intervention
from app.recognition.gestures.demonstration import condense
from app.recognition.poses.trajectory import Trajectory
from app.recognition.simulation.variation import draw_variants

MOST = 8
"""Most counterfactuals returned, few enough to read."""

MOST_OF_A_KIND = 2
"""Most counterfactuals of one kind."""

ORDER: Final = (
    "further_demonstration",
    "switch",
    "salient",
    "trim",
    "keypoint_repair",
    "profile",
    "simplification",
    "voter_weight",
    "demonstration",
)
"""Kinds of interventions, from those that add most evidence to those that fit one take only: a
further demonstration adds evidence, weights are fitted to this take, and a replaced demonstration
is lost."""

VARIANTS = 1
"""Simulated takes of each gesture by another person, used with its demonstration to measure the
effect of an intervention on the rest of the language."""


@dataclass(frozen=True, kw_only=True)
class LanguageEffect:
    """The effect of an intervention on the other gestures.

    Attributes
    ----------
    takes
        Number of demonstrations and simulated takes that were recognised again.
    right_before, right_after
        How many of them are recognised without and with the intervention.
    lost
        Labels of gestures of which a take is no longer recognised.

    """

    takes: int
    right_before: int
    right_after: int
    lost: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON types."""
        return vars(self) | {"lost": list(self.lost)}


@dataclass(frozen=True, kw_only=True)
class Counterfactual:
    """An intervention with which the expected gesture is recognised.

    Attributes
    ----------
    change
        The intervention; its `size` orders the counterfactuals.
    label, confidence
        The recognition after the intervention.
    margin
        The score of the nearest other gesture minus that of the expected one, after it.
    effect
        Its effect on the rest of the language; None for an intervention on this take alone.

    """

    change: Intervention
    label: str
    confidence: float
    margin: float
    effect: LanguageEffect | None

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON types."""
        return {
            "change": self.change.to_dict(),
            "label": self.label,
            "confidence": self.confidence,
            "margin": self.margin if np.isfinite(self.margin) else None,
            "effect": None if self.effect is None else self.effect.to_dict(),
        }


@dataclass(frozen=True, kw_only=True)
class Counterfactuals:
    """The interventions that correct a recognition, in the order in which to try them.

    They are in the `ORDER` of their kinds; within a kind, the smallest is first. None of them makes
    a gesture of the language lose a take.

    Attributes
    ----------
    found
        At most `MOST`, each verified.
    tried
        Number of interventions that were tried.

    """

    found: tuple[Counterfactual, ...]
    tried: int


NONE_NEEDED = Counterfactuals(found=(), tried=0)


def measure_margin(scores: Sequence[float], expected: int) -> float:
    """Return the least other score minus the expected gesture's: positive when it is nearest.

    Infinite where nothing else can be compared, minus infinite where the expected cannot.
    """
    if not np.isfinite(scores[expected]):
        return -np.inf
    return float(np.delete(scores, expected).min(initial=np.inf) - scores[expected])


def find_counterfactuals(context: RecognitionContext, expected: str) -> Counterfactuals:
    """Find the interventions with which `expected` is recognised and no gesture loses a take.

    Of each series of increasing interventions the first that succeeds is kept.

    Parameters
    ----------
    context
        The context, in which another label was recognised, or none.
    expected
        A label of the language.

    """
    found: list[_Found] = []
    tried = 0
    for series in list_interventions(context, expected):
        for change in sorted(series, key=lambda each: each.size):
            tried += 1
            if (helps := _verify(context, change, expected)) is not None:
                found.append(helps)
                break
    rest = _Rest(context)
    described = (_describe(each, expected, rest) for each in sorted(found, key=_rank))
    return Counterfactuals(found=tuple(_choose(described)), tried=tried)


@dataclass(frozen=True, eq=False)
class _Found:
    """A successful intervention, and the context after it."""

    change: Intervention
    after: RecognitionContext
    margin: float


def _rank(found: _Found) -> tuple[int, float, float]:
    """Return the sort key of an intervention: kind, size, margin."""
    return ORDER.index(found.change.kind), found.change.size, -found.margin


def _choose(described: Iterable[Counterfactual]) -> Iterator[Counterfactual]:
    """Choose at most `MOST`, `MOST_OF_A_KIND` of a kind, with which no gesture loses a take."""
    kinds: Counter[str] = Counter()
    for each in described:
        kind = each.change.kind
        if kinds[kind] < MOST_OF_A_KIND and (each.effect is None or not each.effect.lost):
            kinds[kind] += 1
            yield each
        if kinds.total() == MOST:
            return


def _verify(context: RecognitionContext, change: Intervention, expected: str) -> _Found | None:
    """Run the recogniser with an intervention; None if it fails or cannot be applied."""
    try:
        after = change.apply(context)
        if after.result.label != expected:
            return None
    except OsgError:
        return None
    at = after.result.gestures.index(expected)
    return _Found(change, after, measure_margin(after.score_table.scores.tolist(), at))


def _describe(found: _Found, expected: str, rest: _Rest) -> Counterfactual:
    effect = None
    if found.change.reach != "take":
        now = rest.recognised(found.after)
        lost = {label for label in rest.labels if now.count(label) < rest.before.count(label)}
        effect = LanguageEffect(
            takes=len(rest.labels),
            right_before=len(rest.before),
            right_after=len(now),
            lost=tuple(sorted(lost)),
        )
    return Counterfactual(
        change=found.change,
        label=expected,
        confidence=found.after.result.confidence,
        margin=found.margin,
        effect=effect,
    )


class _Rest:
    """Takes of all gestures of a language, to test whether they are still recognised."""

    def __init__(self, context: RecognitionContext) -> None:
        self._situation = context

    @cached_property
    def _takes(self) -> list[tuple[str, Trajectory]]:
        return list(self._all())

    def _all(self) -> Iterator[tuple[str, Trajectory]]:
        shown = (
            each
            for gesture in self._situation.language.gestures
            for each in gesture.single_demonstrations()
        )
        for gesture in shown:
            if gesture.trajectory is not None:
                yield gesture.label, gesture.trajectory
                for variant in draw_variants(gesture.trajectory, VARIANTS, person="another"):
                    yield gesture.label, condense(variant)

    @property
    def labels(self) -> list[str]:
        """Labels of the takes."""
        return [label for label, _ in self._takes]

    @cached_property
    def before(self) -> list[str]:
        """Labels of the takes that are recognised without intervention."""
        return self.recognised(self._situation)

    def recognised(self, context: RecognitionContext) -> list[str]:
        """Return the labels of the takes that are recognised in another context."""
        return [label for label, take in self._takes if _is_recognised(context, label, take)]


def _is_recognised(context: RecognitionContext, label: str, take: Trajectory) -> bool:
    try:
        return context.recognizer.recognize_trajectory(take).label == label
    except OsgError:
        return False
