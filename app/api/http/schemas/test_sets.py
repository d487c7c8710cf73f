"""Schemas of test sets: labelled takes, how they are recognised, and rates."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from app.api.http.schemas.values import (
    Body,
    ExpectedGestureView,
    Identifier,
    RequiredGesture,
    Seconds,
    View,
)
from app.recognition.decision.result import Pair
from app.store.test_sets import MOST_TAKES


class LabelledTakeDraft(RequiredGesture):
    """A clip, or a range of it, with the gesture that it shows."""

    clip_id: Identifier
    start: Seconds | None = None
    """Null, with `end`: every take of the clip, or all of it."""
    end: Seconds | None = None


class LabelledTakesDraft(Body):
    """Takes to add to a test set; one that it has gets the new label."""

    takes: Annotated[list[LabelledTakeDraft], Field(min_length=1, max_length=MOST_TAKES)]


class LabelledTakeChange(RequiredGesture):
    """Another label for a take."""


class LabelledResultView(View):
    """How a revision recognises a labelled take."""

    revision: int
    recognition_id: str | None
    """Null: it could not be recognised, see `fault`."""
    label: str | None
    """Null: a pair, or rejected."""
    pair: Pair
    nearest: str | None
    confidence: float
    right: bool
    fault: str | None
    """Why it could not be recognised, in words."""


class LabelledTakeView(ExpectedGestureView):
    """A take of a test set."""

    id: str
    clip_id: str
    clip: str
    """Name of the clip."""
    start: float
    end: float
    added_by: str
    """Name of who added it; empty: not known."""
    demonstration: bool
    """It is a demonstration of the language, which reads it without that demonstration."""
    testable: bool
    """Whether the language has another demonstration of its gesture; null results otherwise."""
    set_aside: bool
    """It shows the movement that its gesture had before, and counts for nothing; `PATCH` with its
    label brings it back."""
    result: LabelledResultView | None
    """The newest; null: none yet."""
    before: LabelledResultView | None
    """By an older revision than `result`."""


class RateView(View):
    """Rate of right answers, with Wilson's 95 % interval; null without any answer."""

    right: int
    asked: int
    """Takes, those of pairs included."""
    pairs: int
    """Takes that lie between two gestures: neither right nor a wrong label."""
    pairs_right: int
    """Of these, those with the right gesture in the pair."""
    untestable: int
    """Takes beside these: the language has no other demonstration of their gesture."""
    rate: float | None
    low: float | None
    high: float | None


class NoneRateView(View):
    """Answers to takes that show none of the gestures."""

    refused: int
    """Right."""
    asked_back: int
    answered: int
    """Wrong."""


class GestureRateView(RateView):
    """Rate of one gesture."""

    label: str


class TestSetView(View):
    """The test set of a language, with the newest result of each take."""

    __test__ = False

    language_id: str
    revision: int
    """The language's newest."""
    takes: list[LabelledTakeView]
    overall: RateView
    """A refusal is right of a take that shows none of the gestures."""
    gestures: list[GestureRateView]
    """The lowest rate first."""
    none: NoneRateView
    better: list[str]
    """Ids of takes that are answered better than before."""
    worse: list[str]
    """Ids of takes that are answered worse than before: right is better than a pair with the right
    gesture, which is better than anything else."""
    upgraded: bool
    """Whether the results before are of another version of the program, which may answer otherwise
    too."""
    waiting: int
    """Testable takes without a result of the newest revision."""
