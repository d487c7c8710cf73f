"""Explanations: what decided a recognition, and what would have corrected it."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from app.recognition.decision.result import Recognition
from app.recognition.decision.score_table import ScoreTable
from app.recognition.errors import OsgError
from app.recognition.explanation.alignment import (
    AlignedBy,
    Alignment,
    Example,
    align,
    find_nearest_example,
)
from app.recognition.explanation.analysis import Analysis
from app.recognition.explanation.context import RecognitionContext
from app.recognition.explanation.counterfactual_search import (
    NONE_NEEDED,
    find_counterfactuals,
)
from app.recognition.explanation.differences import Difference, find_differences
from app.recognition.explanation.hand_differences import (
    find_held_differences,
    find_moving_hand_differences,
)
from app.recognition.explanation.pairing import Pairing
from app.recognition.explanation.sentence import write_sentence
from app.recognition.explanation.vote_breakdown import break_down_votes
from app.recognition.features.motion import build_movement
from app.recognition.gestures.gesture import Gesture
from app.recognition.gestures.profile import PROFILES


@dataclass(frozen=True, eq=False, kw_only=True)
class Explanation(Analysis):
    """What decided one recognition, with a sentence; see `Analysis` for its attributes."""

    @property
    def sentence(self) -> str:
        """The reason for the recognition, in words."""
        return write_sentence(self)

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON types; infinite values become None."""
        return {
            "profile": self.profile,
            "expected": self.expected,
            "label": self.label,
            "pair": list(self.between) if len(self.between) == 2 else None,
            "nearest": self.nearest,
            "right": self.right,
            "confidence": self.confidence,
            "other": self.other,
            "score": _finite(self.score),
            "other_score": _finite(self.other_score),
            "margin": _finite(self.margin),
            "novelty": _finite(self.novelty),
            "fault": self.fault,
            "votes": dict(self.votes),
            "support": dict(self.support),
            "verdicts": [verdict.to_dict() for verdict in self.verdicts],
            "turned": _finite(self.turned),
            "facing": self.facing,
            "view": self.view,
            "alignments": [alignment.to_dict() for alignment in self.alignments],
            "differences": [difference.to_dict() for difference in self.differences],
            "lesson": None if self.lesson is None else self.lesson.to_dict(),
            "counterfactuals": [each.to_dict() for each in self.counterfactuals.found],
            "tried": self.counterfactuals.tried,
            "sentence": self.sentence,
        }


def explain(
    context: RecognitionContext, expected: str, *, with_counterfactuals: bool = True
) -> Explanation:
    """Explain one recognition.

    Parameters
    ----------
    context
        The recogniser and the take.
    expected
        The label that should have been recognised.
    with_counterfactuals
        Whether to search for counterfactuals, which takes most of the time.

    Raises
    ------
    OsgError
        When `expected` is no gesture of the language.
    PoseError
        When no landmark that a gesture needs moves in the take.

    """
    if expected not in context.language.labels:
        raise OsgError(
            f"no gesture {expected!r} in {context.language.name!r}; it has "
            f"{', '.join(context.language.labels)}"
        )
    table, result = context.score_table, context.result
    at = result.gestures.index(expected)
    other = _find_other(table, result, at)
    pairings = _Pairings(context)
    wanted = with_counterfactuals and result.label != expected
    return Explanation(
        profile=result.profile,
        expected=expected,
        label=result.label,
        nearest=result.nearest,
        confidence=result.confidence,
        between=result.between,
        other=None if other is None else result.gestures[other],
        score=float(table.scores[at]),
        other_score=math.inf if other is None else float(table.scores[other]),
        novelty=float(table.novelty[at]),
        fault=result.fault,
        votes=dict(Counter(result.counted.values()).most_common()),
        support=result.support,
        verdicts=break_down_votes(table, result, at, other),
        facing=table.facing,
        view=int(table.views[at]),
        turned=_difference(table, at, other),
        alignments=tuple(
            alignment
            for index in (at, other)
            if index is not None
            for alignment in pairings.alignments(index)
        ),
        differences=pairings.differences(at),
        counterfactuals=find_counterfactuals(context, expected) if wanted else NONE_NEEDED,
    )


def _find_other(table: ScoreTable, result: Recognition, expected: int) -> int | None:
    """Return the nearest gesture, or the runner-up where the nearest is the expected one."""
    nearest = result.gestures.index(result.nearest)
    if nearest != expected:
        return nearest
    scores = table.scores
    scores[expected] = np.inf
    return int(scores.argmin()) if np.isfinite(scores).any() else None


def _difference(table: ScoreTable, expected: int, other: int | None) -> float:
    if other is None or not np.isfinite(table.scores[[expected, other]]).all():
        return 0.0
    return float(table.turned[expected] - table.turned[other])


class _Pairings:
    """Pairings of a context's query with its gestures, as the recogniser compared them."""

    def __init__(self, context: RecognitionContext) -> None:
        self._gestures = context.language.gestures
        self._table = context.score_table
        self._full = PROFILES[context.profile].compares_motion
        self._start = float(context.poses.time[0])
        self._landmarks = context.recognizer.landmarks
        self._query = context.trajectory
        counting = map(context.recognizer.sensitivity, context.language.labels)
        self._counts = [each is not None and each.hand_shape for each in counting]

    def alignments(self, index: int) -> Iterator[Alignment]:
        """Yield alignments of the query with a gesture, if both have a movement."""
        example = self._example(index)
        if example is None or len(self._query) < 2:
            return
        query = build_movement(self._query, self._landmarks)
        kinds: tuple[AlignedBy, ...] = ("path", "posture") if self._full else ("path",)
        for kind in kinds:
            aligned = align(query, example, self._landmarks, start=self._start, by=kind)
            if aligned is not None:
                yield replace(aligned, demonstration=self._table.nearest_demonstration(index))

    def differences(self, index: int) -> tuple[Difference, ...]:
        """Return the differences between the query and a gesture."""
        gesture = self._gesture(index)
        if gesture.is_held:
            return find_held_differences(
                gesture.label, self._query.held_shapes, gesture.held_shapes
            )
        example = self._example(index)
        if example is None:
            return ()
        pairing = Pairing.of(
            self._query,
            self._gesture(index),
            example.traversal,
            mirrored=example.mirrored,
            start=self._start,
        )
        if pairing is None:
            return ()
        found = find_differences(pairing, sees_direction=self._full)
        return (*found, *self._compare_moving_hands(index, mirrored=example.mirrored))

    def _compare_moving_hands(self, index: int, *, mirrored: bool) -> tuple[Difference, ...]:
        """Return how the moving hands differ from those of a gesture whose hand shape counts."""
        gesture = self._gesture(index)
        if gesture.trajectory is None or not self._counts[index]:
            return ()
        shown = gesture.trajectory.mirror() if mirrored else gesture.trajectory
        if not shown.moving_hands:
            return ()
        return find_moving_hand_differences(
            gesture.label, self._query.moving_hands, shown.moving_hands
        )

    def _gesture(self, index: int) -> Gesture:
        return self._table.find_nearest_demonstration(self._gestures, index)

    def _example(self, index: int) -> Example | None:
        gesture, traversal = self._gesture(index), self._table.traversals[index]
        if gesture.is_held:
            return None
        if traversal is None:
            return find_nearest_example(self._query, gesture, self._landmarks)
        mirrored = bool(self._table.mirrored[index])
        return Example.of(gesture, self._landmarks, traversal, mirrored=mirrored)


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
