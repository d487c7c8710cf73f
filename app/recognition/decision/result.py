"""Recognition result: label and confidence, with the distances and votes behind them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from types import MappingProxyType
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, PlainSerializer

from app.recognition.decision.rejection import find_answer
from app.recognition.gestures.profile import ProfileName
from app.recognition.poses.sequence import FloatArray
from app.recognition.preprocessing.quality import QualityFaultKind
from app.recognition.voters.motion_voters import SecondOpinion

Outcome = Literal["recognized", "pair", "rejected"]
"""What a recognition answers: a label, a pair that the diver decides between, or neither."""


def _list_finite(values: Any) -> Any:
    """Return nested lists in which None stands for NaN and infinity."""
    if isinstance(values, np.ndarray):
        values = values.tolist()
    if isinstance(values, list | tuple):
        return [_list_finite(each) for each in values]
    return None if isinstance(values, float) and not math.isfinite(values) else values


WRITTEN = ConfigDict(json_schema_serialization_defaults_required=True)
"""Of types whose JSON always has all keys, also those with a default."""

Distance = Annotated[
    float,
    PlainSerializer(lambda value: value if math.isfinite(value) else None, float | None),
]
"""A number that is null in JSON where it is infinite or NaN: nothing can be compared."""

Number = Annotated[float | None, Field(description="null: it cannot be compared.")]
Numbers = Annotated[list[Number], BeforeValidator(_list_finite)]
Pair = Annotated[
    tuple[str, str] | None,
    Field(
        description="The two gestures between which the take lies, nearest first: the diver is "
        "asked back; null: it lies between no two."
    ),
]


class RecognitionEntry(BaseModel):
    """A recognition in JSON: the stored record, the HTTP answer, the report, the messages.

    G gestures and V voters are in the order of their lists. Results of earlier versions lack the
    keys with defaults.
    """

    model_config = ConfigDict(extra="allow", from_attributes=True, **WRITTEN)

    profile: ProfileName
    label: Annotated[
        str | None, Field(description="The gesture; null for a pair and where it was rejected.")
    ]
    pair: Pair = None
    nearest: Annotated[str, Field(description="The best gesture even where it was rejected.")]
    confidence: Annotated[float, Field(ge=0, le=1)]
    votes: Annotated[dict[str, str], Field(description="Per voter the gesture nearest to it.")]
    weights: Annotated[
        dict[str, float],
        Field(description="Per voter its normalised weight; 0: it does not count."),
    ] = {}
    findings: Annotated[
        list[str], Field(description="Repairs of keypoints, and an unseen hand, as sentences.")
    ] = []
    fault: Annotated[
        str | None,
        Field(
            description="Why there is no recognition: the keypoints are too poor to judge, or no "
            "second trigger ended the take; null: there is one."
        ),
    ] = None
    fault_kind: Annotated[
        QualityFaultKind | None, Field(description="The kind of the keypoints' fault, or null.")
    ] = None
    voters: list[str]
    gestures: list[str]
    distances: Annotated[
        list[list[Number]],
        BeforeValidator(_list_finite),
        Field(description="V rows of G, each voter in its own unit; smaller is more alike."),
    ]
    scores: Annotated[Numbers, Field(description="G fused scores, smaller is more alike.")] = []
    novelty: Annotated[Numbers, Field(description="G values; above 1 a take is rejected.")] = []
    novelty_by_view: Annotated[
        dict[str, Numbers], Field(description="The same of the movement and of the hands.")
    ] = {}
    facing: Annotated[
        float | None,
        Field(
            description="Degrees the diver is turned by, positive to the diver's left; "
            "null: not known."
        ),
    ] = None
    views: Annotated[
        list[float],
        BeforeValidator(_list_finite),
        Field(
            description="G degrees by which the demonstrations were turned to be compared; empty "
            "in profile paper."
        ),
    ] = []


@dataclass(frozen=True, eq=False, kw_only=True)
class Recognition:
    """The outcome of one recognition.

    Attributes
    ----------
    label
        The recognised gesture, or None for a pair, when rejected (profile ``paper`` never rejects)
        or when the poses are too poor to recognise; `outcome` tells these apart.
    pair
        The two gestures between which the take lies, nearest first: the diver is asked to show it
        again. None otherwise, for profile ``paper``, and in results of earlier versions.
    nearest
        The best gesture even when rejected.
    confidence
        In [0, 1]. Profile ``full``: the estimated probability that `nearest` is the gesture
        meant, if half of all movements are out-of-vocabulary, see `estimate_confidence`; at least
        `confidence.SURE` with a label, at most with a pair. Profile
        ``paper``: the mean of the winner's share of the votes and of its margin, 1 - (its mean
        relative distance over that of the nearest other gesture), or 0 where the other one is
        nearer; it is relative to the language and does not detect out-of-vocabulary movements.
    profile
        The recogniser's profile.
    voters
        V names.
    gestures
        G labels.
    distances
        ``(V, G)``, smaller = more alike, each voter in its own unit; infinite where query and
        gesture cannot be compared because the query lacks a salient landmark or does not move it.
    votes
        By voter's name, the label of its nearest gesture, whether or not the vote has weight.
    weights
        Per voter's name its weight, summing to 1; 0 for a voter that does not separate the
        gestures of this language. In profile ``paper`` all voters have the same weight.
    findings
        Repairs of the poses before recognition, as sentences with counts; and a sentence if more
        shapes are held than a gesture has.
    fault
        Reason why there is no recognition, in words: the poses are too poor, no hand is seen
        although the hand shape of `nearest` counts, or the take is not closed; `label` is then
        None.
    fault_kind
        The kind of a `fault` of the poses; None without one, and in results of earlier versions.
    scores
        ``(G,)``, smaller = more alike, infinite where not comparable. Profile ``full``: the fused
        distance, whose smallest one is `nearest`, about 1 for another gesture. Profile ``paper``:
        the mean relative distance. Empty in results of earlier versions.
    novelty
        ``(G,)``: score relative to the language's limit; if that of `nearest` is above 1, the take
        is rejected (`rejection`). The second opinion's part of a score does not count; the gesture
        that it names may be `second_opinion.AGREED` times as far. NaN in profile ``paper``.
    novelty_by_view
        By `rejection.NOVELTIES` the novelties ``(G,)`` of the movement and of the hand alone, of
        which `novelty` is the larger; NaN where that is not compared. Empty for profile ``paper``,
        and in results of earlier versions.
    facing
        Degrees by which the diver is turned from the camera, positive to the diver's own left; None
        where the poses have no depth, for profile ``paper``, and in results of earlier versions.
    views
        ``(G,)``: degrees by which each gesture's demonstration was turned before it was compared
        (`views.Views`); empty for profile ``paper``, and in results of earlier versions.

    """

    label: str | None
    pair: tuple[str, str] | None = None
    nearest: str
    confidence: float
    profile: str
    voters: tuple[str, ...]
    gestures: tuple[str, ...]
    distances: FloatArray
    votes: Mapping[str, str]
    weights: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    findings: tuple[str, ...] = ()
    fault: str | None = None
    fault_kind: QualityFaultKind | None = None
    scores: FloatArray = field(default_factory=lambda: np.empty(0))
    novelty: FloatArray = field(default_factory=lambda: np.empty(0))
    novelty_by_view: Mapping[str, FloatArray] = field(default_factory=lambda: MappingProxyType({}))
    facing: float | None = None
    views: FloatArray = field(default_factory=lambda: np.empty(0))

    def __post_init__(self) -> None:
        """Freeze private copies of the arrays; without weights all voters have the same."""
        if not self.weights:
            equal = dict.fromkeys(self.voters, 1.0 / max(len(self.voters), 1))
            object.__setattr__(self, "weights", MappingProxyType(equal))
        for name in ("distances", "scores", "novelty", "views"):
            object.__setattr__(self, name, _freeze(getattr(self, name)))
        by_view = {view: _freeze(values) for view, values in self.novelty_by_view.items()}
        object.__setattr__(self, "novelty_by_view", MappingProxyType(by_view))

    @property
    def outcome(self) -> Outcome:
        """Whether a gesture was recognised, the diver is asked back, or the take is rejected."""
        if self.pair is not None:
            return "pair"
        return "rejected" if self.label is None else "recognized"

    @property
    def between(self) -> tuple[str, ...]:
        """The gestures between which the take lies, nearest first: the pair, or three or more.

        Three or more are the reason of a rejection. Empty for any other reason, and for a label.
        """
        if self.outcome != "rejected" or self.fault or not self.scores.size:
            return self.pair or ()
        answer = find_answer(self.scores, self.novelty)
        return tuple(self.gestures[index] for index in answer) if len(answer) > 2 else ()

    @property
    def disagreed(self) -> bool:
        """Whether the diver is asked because the second opinion names the other of the two."""
        return self.pair is not None and self.votes.get(SecondOpinion.name) == self.pair[1]

    @property
    def runner_up(self) -> str | None:
        """The gesture with the smallest score but `nearest`; None where no other is comparable."""
        if not self.scores.size:
            return None
        scores = self.scores.copy()
        scores[self.gestures.index(self.nearest)] = np.inf
        return self.gestures[int(scores.argmin())] if np.isfinite(scores).any() else None

    @property
    def nearest_novelty(self) -> float:
        """The novelty of `nearest`; NaN in profile ``paper`` and in results of earlier versions."""
        return (
            float(self.novelty[self.gestures.index(self.nearest)])
            if self.novelty.size
            else math.nan
        )

    @property
    def counted(self) -> dict[str, str]:
        """The votes with weight above 0."""
        return {voter: label for voter, label in self.votes.items() if self.weights[voter] > 0}

    @property
    def support(self) -> dict[str, float]:
        """By label the weight of the voters that chose it, largest first; the sum is 1.

        Voters that cannot compare this take have no vote, and their weight does not count.
        """
        totals: dict[str, float] = {}
        for voter, label in self.counted.items():
            totals[label] = totals.get(label, 0.0) + self.weights[voter]
        whole = sum(totals.values())
        ordered = sorted(totals.items(), key=lambda each: -each[1])
        return {label: total / whole for label, total in ordered}

    @property
    def margin(self) -> float:
        """How much nearer `nearest` is than every other gesture, in the unit of `scores`.

        Negative where, in profile ``paper``, a gesture with more votes wins over a nearer one;
        infinite where no other can be compared; NaN in results of earlier versions without
        `scores`.
        """
        if not self.scores.size:
            return math.nan
        at = self.gestures.index(self.nearest)
        return float(np.delete(self.scores, at).min(initial=np.inf) - self.scores[at])

    @classmethod
    def from_dict(cls, content: Mapping[str, Any]) -> Recognition:
        """Return the recognition of a dictionary by `to_dict`, of this or an earlier version."""
        entry = RecognitionEntry.model_validate(content)
        infinite = [
            [math.inf if value is None else value for value in row] for row in entry.distances
        ]
        arrays = {
            "distances": np.array(infinite, dtype=np.float64),
            "scores": np.array(entry.scores, dtype=np.float64),
            "novelty": np.array(entry.novelty, dtype=np.float64),
            "novelty_by_view": {
                view: np.array(values, dtype=np.float64)
                for view, values in entry.novelty_by_view.items()
            },
            "views": np.array(entry.views, dtype=np.float64),
        }
        lists = {name: tuple(getattr(entry, name)) for name in ("voters", "gestures", "findings")}
        known = {each.name: getattr(entry, each.name) for each in fields(cls)}
        return cls(**(known | lists | arrays))

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON types; infinite values and NaN become None."""
        return RecognitionEntry.model_validate(self).model_dump(mode="json")


def _freeze(values: FloatArray) -> FloatArray:
    """Return a read-only copy."""
    frozen = values.copy()
    frozen.setflags(write=False)
    return frozen
