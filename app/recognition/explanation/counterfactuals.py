"""Counterfactuals: the interventions that would have corrected a recognition.

An intervention turns one recognition context into another: with another stretch of the take,
another range of a demonstration, or other switches. Each is verified by applying
it and running the recogniser again, on this take, on the demonstrations of the language and on the
known takes at hand.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Annotated, Any, ClassVar, Final, Literal

import numpy as np
from pydantic import InstanceOf, PlainSerializer

from app.recognition.decision.distinctions import CLEARLY_SLOWER
from app.recognition.decision.result import Distance
from app.recognition.errors import OsgError
from app.recognition.explanation.context import (
    KnownTake,
    RecognitionContext,
    count_effect,
    read_all,
)
from app.recognition.gestures.demonstration import MAX_DEMONSTRATIONS
from app.recognition.gestures.profile import PROFILES
from app.recognition.gestures.switches import Switch
from app.recognition.gestures.tuning import describe_repair
from app.recognition.preprocessing.repair import repair_poses
from app.recognition.text.wording import humanize

MOST = 6
"""Most counterfactuals returned, few enough to read."""

ORDER: Final = (
    "demonstration_cut",
    "keypoint_repair",
    "trim",
    "switch",
    "further_demonstration",
)
"""Kinds of interventions, from those that undo a fault to that by which this take is right whatever
it shows; each kind has its most useful one."""

TRIM_STEP = 0.1
"""Step of trimming, as a share of the stroke."""

TRIM_STEPS = 4
"""Most steps at either end; a longer part is hardly a transit."""

LEAST_KEPT = 0.8
"""Share of the stroke that a trim keeps; a shorter part of it is another gesture."""

KeptRange = tuple[int, float, float]
"""A demonstration, counted from 0, and the seconds of its own clock between which it is kept."""

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
class DemonstrationCut(Intervention):
    """Another range of a demonstration; its size is the share of its time that is cut off."""

    kind = "demonstration_cut"
    reach = "gesture"
    label: str
    demonstration: int
    start: float
    end: float

    @property
    def words(self) -> str:
        """See `Intervention`."""
        return f"with the demonstration of {self.label!r} cut to {self.start:.2f}-{self.end:.2f} s"

    def apply(self, context: RecognitionContext) -> RecognitionContext:
        """See `Intervention`."""
        gesture = context.language.gesture(self.label)
        return context.with_gesture(gesture.with_cut(self.demonstration, self.start, self.end))


@dataclass(frozen=True, kw_only=True)
class Trim(Intervention):
    """Another stretch of the clip; its size is the share of the stroke added or removed.

    Attributes
    ----------
    longer
        Whether it holds more than the stroke.

    """

    kind = "trim"
    reach = "take"
    start: float
    end: float
    longer: bool = False

    @property
    def words(self) -> str:
        """See `Intervention`."""
        span = f"{self.start:.2f}-{self.end:.2f} s"
        return (
            f"with more of the clip, {span}" if self.longer else f"with the take trimmed to {span}"
        )

    def apply(self, context: RecognitionContext) -> RecognitionContext:
        """See `Intervention`."""
        # The ends are times of frames; a rounding error must not drop these.
        return context.with_poses(context.whole.between(self.start - 1e-6, self.end + 1e-6))


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
    """The take as one more demonstration of a gesture; its size is its share of them."""

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
class LanguageEffect:
    """The effect of an intervention on the rest of the language.

    Attributes
    ----------
    lost
        Labels of gestures of which a demonstration is no longer recognised.
    takes
        Number of other known takes, see `KnownTake`; 0 without a test set.
    repaired, broken
        How many of these are read right with the intervention only, and without it only.

    """

    lost: tuple[str, ...]
    takes: int
    repaired: int
    broken: int


@dataclass(frozen=True, kw_only=True)
class Counterfactual:
    """An intervention with which the expected gesture is recognised.

    Attributes
    ----------
    change
        The intervention.
    label, confidence
        The recognition after the intervention.
    margin
        The score of the nearest other gesture minus that of the expected one, after it.
    effect
        Its effect on the rest of the language; None for an intervention on this take alone.

    """

    change: Annotated[
        InstanceOf[Intervention], PlainSerializer(Intervention.to_dict, dict[str, Any])
    ]
    label: str
    confidence: float
    margin: Distance
    effect: LanguageEffect | None

    @property
    def rank(self) -> tuple[bool, int, int, float, float]:
        """The sort key: what repairs most known takes first, what does harm last.

        This take as a demonstration comes last too.
        """
        kind, gained = self.change.kind, 0
        if self.effect is not None:
            gained = self.effect.repaired - self.effect.broken
        last = kind == FurtherDemonstration.kind or gained < 0
        return last, -gained, ORDER.index(kind), self.change.size, -self.margin


@dataclass(frozen=True, kw_only=True)
class Counterfactuals:
    """The interventions that correct a recognition, in the order in which to try them.

    Attributes
    ----------
    found
        At most `MOST`, the best of each kind; by none does a gesture lose a demonstration.
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


def find_counterfactuals(
    context: RecognitionContext, expected: str, cuts: Sequence[KeptRange] = ()
) -> Counterfactuals:
    """Find the interventions with which `expected` is recognised and no gesture is lost.

    Of each series of increasing interventions the first that succeeds is kept.

    Parameters
    ----------
    context
        The context, in which another label was recognised, or none.
    expected
        A label of the language.
    cuts
        Better ranges of demonstrations at fault.

    """
    shown = [
        KnownTake(gesture.label, each.trajectory)
        for gesture in context.language.gestures
        for each in gesture.single_demonstrations()
        if each.trajectory is not None
    ]
    known = [*shown, *context.known]
    before = [*read_all(context.recognizer, shown), *context.readings]
    best: dict[str, Counterfactual] = {}
    tried = 0
    for series in list_interventions(context, expected, cuts):
        for change in sorted(series, key=lambda each: each.size):
            tried += 1
            found = _verify(context, change, expected, known, before)
            if found is None:
                continue
            if change.kind not in best or found.rank < best[change.kind].rank:
                best[change.kind] = found
            break
    kept = [each for each in best.values() if each.effect is None or not each.effect.lost]
    ordered = sorted(kept, key=lambda each: each.rank)
    return Counterfactuals(found=tuple(ordered[:MOST]), tried=tried)


def _verify(
    context: RecognitionContext,
    change: Intervention,
    expected: str,
    known: Sequence[KnownTake],
    before: Sequence[str | None],
) -> Counterfactual | None:
    """Run the recogniser with an intervention; None if it fails or cannot be applied."""
    try:
        after = change.apply(context)
        if after.result.label != expected:
            return None
    except OsgError:
        return None
    effect = None
    if change.reach != "take":
        shown = len(known) - len(context.known)
        now_read = read_all(after.recognizer, known)
        pairs = zip(known[:shown], before[:shown], now_read[:shown], strict=True)
        # The demonstration that is cut is no take of its gesture any more.
        own = change.label if isinstance(change, DemonstrationCut) else None
        lost = {take.label for take, was, now in pairs if was == take.label != now} - {own}
        repaired, broken = count_effect(known[shown:], before[shown:], now_read[shown:])
        effect = LanguageEffect(
            lost=tuple(sorted(lost)), takes=len(context.known), repaired=repaired, broken=broken
        )
    at = after.result.gestures.index(expected)
    return Counterfactual(
        change=change,
        label=expected,
        confidence=after.result.confidence,
        margin=measure_margin(after.score_table.scores.tolist(), at),
        effect=effect,
    )


Series = list[Intervention]


def list_interventions(
    context: RecognitionContext, expected: str, cuts: Sequence[KeptRange] = ()
) -> Iterator[Series]:
    """Yield all interventions to try, in series of one kind and increasing size.

    Parameters
    ----------
    context
        A context in which `expected` was not recognised.
    expected
        A label of its language.
    cuts
        See `find_counterfactuals`.

    """
    yield _cuts(context, expected, cuts)
    yield from _trims(context)
    yield from _repairs(context)
    yield from _gestures(context, expected)


def _cuts(context: RecognitionContext, expected: str, cuts: Sequence[KeptRange]) -> Series:
    """Cut the demonstrations that are at fault."""
    shown = context.language.gesture(expected).trajectories
    return [
        DemonstrationCut(
            size=min(1.0, max(0.0, 1.0 - (end - start) / float(shown[number].time[-1]))),
            label=expected,
            demonstration=number,
            start=start,
            end=end,
        )
        for number, start, end in cuts
    ]


def _trims(context: RecognitionContext) -> Iterator[Series]:
    """Move the start, the end, or both, within the take, and keep most of the stroke."""
    time, whole = context.poses.time, context.whole.time
    start, end = float(time[0]), float(time[-1])
    duration = end - start
    shifts = np.arange(1, TRIM_STEPS + 1) * TRIM_STEP * duration
    spans: list[list[tuple[float, float]]] = [
        [(start + shift, end) for shift in shifts],
        [(start, end - shift) for shift in shifts],
        [(start + shift, end - shift) for shift in shifts],
        [(start - shift, end) for shift in shifts],
        [(start, end + shift) for shift in shifts],
        [(float(whole[0]), float(whole[-1]))],
    ]
    for series in spans:
        inside = {(max(a, float(whole[0])), min(b, float(whole[-1]))) for a, b in series}
        inside -= {(start, end)}
        yield [
            Trim(
                size=min(1.0, (abs(a - start) + abs(b - end)) / duration),
                start=a,
                end=b,
                longer=bool(a < start or b > end),
            )
            for a, b in inside
            if duration > 0 and min(b, end) - max(a, start) >= LEAST_KEPT * duration - 1e-9
        ]


def _repairs(context: RecognitionContext) -> Iterator[Series]:
    """Switch the repair of keypoints on or off, if it changes any."""
    share = float(repair_poses(context.poses).touched.mean())
    if share > 0:
        yield [KeypointRepair(size=share, on=not context.recognizer.repairs)]


def _gestures(context: RecognitionContext, expected: str) -> Iterator[Series]:
    """Change the expected gesture, or the one that was recognised."""
    for label in dict.fromkeys((expected, context.result.nearest)):
        gesture = context.language.gesture(label)
        if gesture.trajectory is not None and PROFILES[context.profile].compares_motion:
            yield from _switches(context, label, expected=label == expected)
    shown = context.language.gesture(expected).single_demonstrations()
    if len(shown) < MAX_DEMONSTRATIONS:
        yield [FurtherDemonstration(size=1 / (len(shown) + 1), label=expected)]


def _switches(context: RecognitionContext, label: str, *, expected: bool) -> Iterator[Series]:
    """Relax the switches of the expected gesture, and tighten those of the recognised one.

    Only switches that affect this recognition: direction, tempo, mirror image or hand shape.
    """
    table, at = context.score_table, context.language.labels.index(label)
    gesture, counting = context.language.gesture(label), context.recognizer.sensitivity(label)
    shaped = any(each.moving_hands for each in gesture.trajectories)
    shape_counts = counting is not None and counting.hand_shape
    traversal = table.traversals[at]
    slower = table.distances[table.voters.index("tempo"), at] > CLEARLY_SLOWER
    strict: Switch = "off" if expected else "on"
    positions: dict[SwitchName, tuple[Switch, bool]] = {
        "direction": (strict, traversal is not None and traversal.backward != expected),
        "tempo": (strict, bool(slower)),
        "mirror": ("on" if expected else "off", bool(table.mirrored[at]) != expected),
        "hand_shape": (strict, shaped and shape_counts == expected),
    }
    for switch, (position, matters) in positions.items():
        if matters and getattr(gesture.switches, switch) != position:
            yield [SwitchPosition(size=1 / 3, label=label, switch=switch, position=position)]
