"""Recognition result: label and confidence, the table of scores behind them, and the query.

A `Recognition` is the outcome, a `ScoreTable` holds the distances of a query to every gesture and
each voter's contribution, and a `Trace` holds both and the query.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal

import numpy as np
import numpy.typing as npt
from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    PlainSerializer,
    ValidatorFunctionWrapHandler,
    model_validator,
)
from pydantic_core import CoreSchema, core_schema

from app.recognition.decision.outcome import find_answer
from app.recognition.features.traversals import Traversal
from app.recognition.gestures.gesture import Gesture
from app.recognition.gestures.profile import ProfileName
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.quality import QualityFaultKind
from app.recognition.recording.trimming import Span
from app.recognition.text.described import DESCRIBED
from app.recognition.voters.motion_voters import SecondOpinion

Outcome = Literal["recognized", "pair", "rejected"]
"""What a recognition answers: a label, a pair that the diver decides between, or neither."""


def _list_finite(values: Any) -> Any:
    """Return nested lists in which None stands for NaN and infinity."""
    if isinstance(values, np.ndarray):
        values = values.tolist()
    if isinstance(values, list):
        return [_list_finite(each) for each in values]
    return values if math.isfinite(values) else None


@dataclass(frozen=True)
class InLists:
    """Annotation of a float array that is lists of one kind in JSON, and read-only here."""

    kind: Any
    missing: float = math.nan
    """What null is in the array."""

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        lists = handler.generate_schema(self.kind)
        written = core_schema.plain_serializer_function_ser_schema(
            _list_finite, return_schema=lists
        )
        return core_schema.no_info_wrap_validator_function(
            self._read_array, lists, serialization=written
        )

    def _read_array(self, values: Any, read_lists: ValidatorFunctionWrapHandler) -> FloatArray:
        """Return a private copy of an array, or the array of lists."""
        array: FloatArray
        if isinstance(values, np.ndarray):
            array = np.array(values, dtype=np.float64)
        else:
            array = np.array(read_lists(values), dtype=np.float64)
            array[np.isnan(array)] = self.missing
        array.setflags(write=False)
        return array


WRITTEN = ConfigDict(json_schema_serialization_defaults_required=True)
"""Of types whose JSON always has all keys, also those with a default."""

Distance = Annotated[
    float,
    PlainSerializer(lambda value: value if math.isfinite(value) else None, float | None),
]
"""A number that is null in JSON where it is infinite or NaN: nothing can be compared."""

Number = Annotated[float | None, Field(description="null: it cannot be compared.")]
Numbers = Annotated[FloatArray, InLists(list[Number])]
Pair = Annotated[
    tuple[str, str] | None,
    Field(
        description="The two gestures between which the take lies, nearest first: the diver is "
        "asked back; null: it lies between no two."
    ),
]
Nothing = Field(default_factory=lambda: np.empty(0))


class Recognition(BaseModel):
    """The outcome of one recognition: here, in records, HTTP answers, reports and messages.

    G gestures and V voters are in the order of their lists. Results of earlier versions lack the
    keys with defaults.
    """

    model_config = ConfigDict(**DESCRIBED, **WRITTEN)

    profile: ProfileName
    """The recogniser's."""
    label: str | None
    """The gesture; null for a pair, where it was rejected (profile ``paper`` never rejects) and
    where the poses are too poor to recognise; `outcome` tells these apart."""
    pair: Pair = None
    nearest: str
    """The best gesture even where it was rejected."""
    confidence: Annotated[float, Field(ge=0, le=1)]
    # See `estimate_confidence`; a label has at least `outcome.SURE`, a pair at most.
    """Profile ``full``: the estimated probability that `nearest` is the gesture meant, if half of
    all movements are out-of-vocabulary. Profile ``paper``: the mean of the winner's share of the
    votes and of its margin, 1 - (its mean relative distance over that of the nearest other
    gesture), or 0 where the other one is nearer: relative to the language, it does not detect
    out-of-vocabulary movements."""
    votes: Mapping[str, str]
    """Per voter the gesture nearest to it, whether or not the vote has weight."""
    weights: Mapping[str, float] = {}
    """Per voter its normalised weight; 0: it does not count, as it does not separate the gestures
    of this language. In profile ``paper`` all voters have the same weight."""
    findings: tuple[str, ...] = ()
    """Repairs of keypoints, an unseen hand, more shapes held than a gesture has, as sentences."""
    fault: str | None = None
    """Why there is no recognition: the keypoints are too poor to judge, no hand is seen although
    the hand shape of `nearest` counts, or no second trigger ended the take; null: there is one."""
    fault_kind: QualityFaultKind | None = None
    """The kind of the keypoints' fault, or null."""
    unseen: tuple[Span, ...] = ()
    """Spans of the take in which a trigger may have been missed; a take with one has no label."""
    voters: tuple[str, ...]
    gestures: tuple[str, ...]
    distances: Annotated[FloatArray, InLists(list[list[Number]], missing=math.inf)]
    """V rows of G, each voter in its own unit; smaller is more alike. Infinite where the take lacks
    a salient landmark of the gesture or does not move it."""
    scores: Numbers = Nothing
    """G fused scores, smaller is more alike. Profile ``full``: the fused distance, whose smallest
    one is `nearest`, about 1 for another gesture. Profile ``paper``: the mean relative distance."""
    novelty: Numbers = Nothing
    # `fusion.AGREED` says how much farther.
    """G values, the score relative to the language's limit: if that of `nearest` is above 1, the
    take is rejected. The second opinion's part of a score does not count; the gesture that it names
    may be farther. NaN in profile ``paper``."""
    novelty_by_view: Mapping[str, Numbers] = {}
    """The same of the movement and of the hands, of which `novelty` is the larger; NaN where that
    is not compared. Empty in profile ``paper``."""
    facing: float | None = None
    """Degrees the diver is turned by, positive to the diver's left; null: not known, as in profile
    ``paper``."""
    views: Annotated[FloatArray, InLists(list[float])] = Nothing
    """G degrees by which the demonstrations were turned to be compared; empty in profile paper."""

    __eq__ = object.__eq__
    __hash__ = object.__hash__

    @model_validator(mode="after")
    def _weigh_equally(self) -> Recognition:
        """Without weights all voters have the same."""
        if not self.weights:
            self.__dict__["weights"] = dict.fromkeys(self.voters, 1.0 / max(len(self.voters), 1))
        return self

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
        return cls.model_validate(content)

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON types; infinite values and NaN become None."""
        return self.model_dump(mode="json")


@dataclass(frozen=True, eq=False, kw_only=True)
class ScoreTable:
    """The distances and contributions of all voters for a query and all gestures.

    Attributes
    ----------
    voters
        V names.
    distances
        ``(V, G)``, each voter in its own unit; infinite where not comparable.
    contributions
        ``(V, G)``: what each voter adds to a gesture's score, smaller = more alike; 0 where it
        cannot compare or has weight 0, infinite for a gesture that no voter can compare.
    turned
        ``(G,)``: penalty for a gesture that is nearest backwards or with exchanged sides.
    traversals
        The nearest traversal of each gesture; None where only its image is compared.
    mirrored
        ``(G,)``: whether the gesture's mirror image is nearest.
    demonstrations
        ``(G,)``: index of each gesture's nearest demonstration.
    views
        ``(G,)``: degrees by which that demonstration was turned before it was compared
        (`list_views`).
    facing
        Degrees by which the query's diver is turned from the camera, positive to the diver's own
        left; None where not known.
    novelty_by_view
        ``(2, G)``: novelty for each gesture by each of `outcome.NOVELTIES` alone; NaN where it
        is not compared, all of profile ``paper``.

    """

    voters: tuple[str, ...]
    distances: FloatArray
    contributions: FloatArray
    turned: FloatArray
    traversals: tuple[Traversal | None, ...]
    mirrored: npt.NDArray[np.bool_]
    novelty_by_view: FloatArray
    demonstrations: npt.NDArray[np.intp]
    views: npt.NDArray[np.intp]
    facing: float | None = None

    def nearest_demonstration(self, gesture: int) -> int:
        """Return the index of the demonstration by which a gesture, given by index, is compared."""
        return int(self.demonstrations[gesture])

    def find_shown_demonstration(self, gestures: Sequence[Gesture], gesture: int) -> Gesture:
        """Return a gesture with only the demonstration that the query was compared with."""
        return gestures[gesture].single_demonstrations()[self.nearest_demonstration(gesture)]

    def find_nearest_demonstration(self, gestures: Sequence[Gesture], gesture: int) -> Gesture:
        """Return the shown demonstration, turned as it was compared."""
        return self.find_shown_demonstration(gestures, gesture).turn(int(self.views[gesture]))

    def with_idle_voters(self, names: Sequence[str]) -> ScoreTable:
        """Return the table with rows of further voters, which compare nothing."""
        nothing = np.full((len(names), self.distances.shape[1]), np.inf)
        return replace(
            self,
            voters=(*self.voters, *names),
            distances=np.concatenate([self.distances, nothing]),
            contributions=np.concatenate([self.contributions, np.zeros(nothing.shape)]),
        )

    @property
    def scores(self) -> FloatArray:
        """``(G,)``: the sums of contributions and `turned`, smaller = more alike.

        Profile ``full``: the fused distance, which decides. Profile ``paper``: the mean relative
        distance, which decides among gestures with equally many votes.
        """
        return np.asarray(self.contributions.sum(axis=0) + self.turned, dtype=np.float64)

    @property
    def novelty(self) -> FloatArray:
        """``(G,)``: the larger of both novelties, above 1: rejected (`outcome`).

        NaN for all gestures in profile ``paper``.
        """
        return np.asarray(np.fmax.reduce(self.novelty_by_view, axis=0))


@dataclass(frozen=True, eq=False, kw_only=True)
class Trace:
    """The query, score table and result of one recognition.

    Attributes
    ----------
    query
        The trajectory that the voters compared.
    score_table
        Its distances to every gesture.
    result
        The recognition.

    """

    query: Trajectory
    score_table: ScoreTable
    result: Recognition
