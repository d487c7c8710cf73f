"""Interventions: changes of a take or language for counterfactuals, which users can apply.

An intervention turns one recognition context into another: with another language, profile, tuning
or stretch of the take.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import asdict, dataclass, replace
from typing import Any, ClassVar, Literal

from app.recognition.explanation.context import RecognitionContext
from app.recognition.gestures.gesture import Gesture
from app.recognition.gestures.switches import Switch
from app.recognition.gestures.tuning import (
    describe_repair,
    describe_simplification,
    describe_weight,
)
from app.recognition.text.wording import humanize, humanize_all, join_words

SwitchName = Literal["direction", "tempo", "mirror", "hand_shape"]

Reach = Literal["take", "gesture", "language"]
"""Scope of an intervention: this take alone, one gesture, or recognition of the whole language."""


@dataclass(frozen=True, kw_only=True)
class Intervention(ABC):
    """Base of interventions.

    Attributes
    ----------
    size
        In [0, 1]: share of its object that it changes; see each kind.

    """

    kind: ClassVar[str]
    reach: ClassVar[Reach]
    size: float

    @property
    @abstractmethod
    def words(self) -> str:
        """The intervention as a clause after "it would have been recognised"."""

    @abstractmethod
    def apply(self, context: RecognitionContext) -> RecognitionContext:
        """Return the context with this intervention.

        Raises
        ------
        OsgError
            When it cannot be applied.

        """

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON types: the kind, the scope, and the values to apply."""
        values = {name: list(v) if isinstance(v, tuple) else v for name, v in asdict(self).items()}
        return {"kind": self.kind, "reach": self.reach, **values, "words": self.words}


@dataclass(frozen=True, kw_only=True)
class Trim(Intervention):
    """Another stretch of the clip; its size is the share of the stroke added or removed."""

    kind = "trim"
    reach = "take"
    start: float
    end: float

    @property
    def words(self) -> str:
        """See `Intervention`."""
        return f"with the take trimmed to {self.start:.2f}-{self.end:.2f} s"

    def apply(self, context: RecognitionContext) -> RecognitionContext:
        """See `Intervention`."""
        # The ends are times of frames; a rounding error must not drop these.
        poses = context.whole.between(self.start - 1e-6, self.end + 1e-6)
        return replace(context, poses=poses)


@dataclass(frozen=True, kw_only=True)
class VoterWeight(Intervention):
    """Another weight factor of a voter, 0: off; its size is the weight that moves."""

    kind = "voter_weight"
    reach = "language"
    voter: str
    factor: float

    @property
    def words(self) -> str:
        """See `Intervention`."""
        return describe_weight(self.voter, self.factor)

    def apply(self, context: RecognitionContext) -> RecognitionContext:
        """See `Intervention`."""
        weights = {**context.tuning.weights}
        weights[self.voter] = weights.get(self.voter, 1.0) * self.factor
        return context.with_tuning(replace(context.tuning, weights=weights))


@dataclass(frozen=True, kw_only=True)
class Simplification(Intervention):
    """Another tolerance for the drawings; its size is 1 - the smaller over the larger."""

    kind = "simplification"
    reach = "language"
    tolerance: float

    @property
    def words(self) -> str:
        """See `Intervention`."""
        return describe_simplification(self.tolerance)

    def apply(self, context: RecognitionContext) -> RecognitionContext:
        """See `Intervention`."""
        return context.with_tuning(replace(context.tuning, simplification=self.tolerance))


@dataclass(frozen=True, kw_only=True)
class KeypointRepair(Intervention):
    """Keypoints repaired or not; its size is the share of moments that a repair changes."""

    kind = "keypoint_repair"
    reach = "language"
    on: bool

    @property
    def words(self) -> str:
        """See `Intervention`."""
        return describe_repair(self.on)

    def apply(self, context: RecognitionContext) -> RecognitionContext:
        """See `Intervention`."""
        return context.with_tuning(replace(context.tuning, keypoints_repaired=self.on))


@dataclass(frozen=True, kw_only=True)
class OtherProfile(Intervention):
    """Another profile; its size is 1."""

    kind = "profile"
    reach = "language"
    profile: str

    @property
    def words(self) -> str:
        """See `Intervention`."""
        return f"with the profile {self.profile}"

    def apply(self, context: RecognitionContext) -> RecognitionContext:
        """See `Intervention`."""
        return context.with_profile(self.profile)


@dataclass(frozen=True, kw_only=True)
class SalientKeypoints(Intervention):
    """Other salient keypoints of a gesture; its size is the share not common to both choices."""

    kind = "salient"
    reach = "gesture"
    label: str
    salient: tuple[str, ...]

    @property
    def words(self) -> str:
        """See `Intervention`."""
        followed = join_words(humanize_all(self.salient))
        return f"with {followed} as the salient keypoints of {self.label!r}"

    def apply(self, context: RecognitionContext) -> RecognitionContext:
        """See `Intervention`."""
        gesture = context.language.gesture(self.label)
        return context.with_gesture(gesture.with_salient(self.salient))


@dataclass(frozen=True, kw_only=True)
class SwitchPosition(Intervention):
    """Another position of one of a gesture's switches; its size is a third."""

    kind = "switch"
    reach = "gesture"
    label: str
    switch: SwitchName
    position: Switch

    @property
    def words(self) -> str:
        """See `Intervention`."""
        return f"with the switch {humanize(self.switch)} of {self.label!r} {self.position}"

    def apply(self, context: RecognitionContext) -> RecognitionContext:
        """See `Intervention`."""
        gesture = context.language.gesture(self.label)
        switches = replace(gesture.switches, **{self.switch: self.position})
        return context.with_gesture(replace(gesture, switches=switches))


@dataclass(frozen=True, kw_only=True)
class FurtherDemonstration(Intervention):
    """The take as one more demonstration of a gesture; its size is its share of them.

    The only intervention that adds evidence and takes none away.
    """

    kind = "further_demonstration"
    reach = "gesture"
    label: str

    @property
    def words(self) -> str:
        """See `Intervention`."""
        return f"with this take as another demonstration of {self.label!r}"

    def apply(self, context: RecognitionContext) -> RecognitionContext:
        """See `Intervention`."""
        gesture = context.language.gesture(self.label)
        return context.with_gesture(gesture.with_demonstration(context.poses))


@dataclass(frozen=True, kw_only=True)
class NewDemonstration(Intervention):
    """The take in place of the gesture's first demonstration; its size is 1. The last resort."""

    kind = "demonstration"
    reach = "gesture"
    label: str

    @property
    def words(self) -> str:
        """See `Intervention`."""
        return f"with this take in place of the demonstration of {self.label!r}"

    def apply(self, context: RecognitionContext) -> RecognitionContext:
        """See `Intervention`."""
        before = context.language.gesture(self.label)
        made = Gesture.from_demonstration(
            self.label,
            context.poses,
            description=before.description,
            command=before.command,
        )
        return context.with_gesture(replace(made, switches=before.switches, further=before.further))
