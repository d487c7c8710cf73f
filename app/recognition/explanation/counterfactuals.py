"""Counterfactuals: the interventions that would have corrected a recognition.

An intervention turns one recognition context into another: with another stretch of the take,
another range of a demonstration, or other switches. Each is verified by applying
it and running the recogniser again, on this take, on the demonstrations of the language and on the
known takes at hand.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any, Final, Literal, get_args

import numpy as np
from pydantic import InstanceOf, PlainSerializer

from app.recognition.decision.fused_vote import FusedVote
from app.recognition.decision.fusion import CLEARLY_SLOWER
from app.recognition.decision.outcome import is_rejected
from app.recognition.decision.result import Distance
from app.recognition.errors import OsgError
from app.recognition.explanation.blame import Blame
from app.recognition.explanation.context import KnownTake, KnownTakes, RecognitionContext
from app.recognition.explanation.strokes import transcribe_gesture
from app.recognition.explanation.undoing import compare_with, find_better_range
from app.recognition.features.motion import parse_body_part
from app.recognition.gestures.demonstration import MAX_DEMONSTRATIONS
from app.recognition.gestures.gesture import Gesture
from app.recognition.gestures.profile import describe_repair
from app.recognition.gestures.switches import Switch
from app.recognition.text.wording import humanize

TRIM_STEP = 0.1
"""Step of trimming, as a share of the stroke."""

TRIM_STEPS = 4
"""Most steps at either end; a longer part is hardly a transit."""

LEAST_KEPT = 0.8
"""Share of the stroke that a trim keeps; a shorter part of it is another gesture."""

Reach = Literal["take", "gesture", "language"]
"""Scope of an intervention: this take alone, one gesture, or recognition of the whole language."""


InterventionKind = Literal[
    "demonstration_cut", "keypoint_repair", "trim", "switch", "further_demonstration"
]
"""What is changed, from what undoes a fault to that by which this take is right whatever it shows;
each kind has its most useful one."""

ORDER: Final = get_args(InterventionKind)


class Intervention:
    """A change of the take, of a gesture or of the language that is tried.

    Parameters
    ----------
    kind
        What is changed.
    size
        In [0, 1]: share of its object that it changes: of the stroke's, the demonstration's or the
        repaired moments, of a switch's positions, of a gesture's demonstrations.
    values
        What the kind needs to be applied, in plain JSON types.

    """

    def __init__(self, kind: InterventionKind, size: float, values: Mapping[str, Any]) -> None:
        self.kind, self.size, self.values = kind, size, values

    @property
    def reach(self) -> Reach:
        """The scope of the change."""
        if self.kind == "trim":
            return "take"
        return "language" if self.kind == "keypoint_repair" else "gesture"

    @property
    def words(self) -> str:
        """The intervention as a clause after "it would have been recognised"."""
        values = self.values
        match self.kind:
            case "trim":
                how = "more of the clip," if values["longer"] else "the take trimmed to"
                return "with {how} {start:.2f}-{end:.2f} s".format(**values, how=how)
            case "demonstration_cut":
                cut = "with the demonstration of {label!r} cut to {start:.2f}-{end:.2f} s"
                return cut.format(**values)
            case "switch":
                switch = humanize(values["switch"])
                return "with the switch {0} of {label!r} {position}".format(switch, **values)
            case "keypoint_repair":
                return describe_repair(values["on"])
            case _:
                return f"with this take as another demonstration of {values['label']!r}"

    def apply(self, context: RecognitionContext) -> RecognitionContext:
        """Return a context with this intervention; raises `OsgError` where it cannot be applied."""
        values = self.values
        if self.kind == "trim":
            # The ends are times of frames; a rounding error must not drop these.
            stroke = context.whole.between(values["start"] - 1e-6, values["end"] + 1e-6)
            return context.with_poses(stroke)
        if self.kind == "keypoint_repair":
            tuning = replace(context.recognizer.tuning, keypoints_repaired=values["on"])
            return context.with_tuning(tuning)
        gesture = context.language.gesture(values["label"])
        if self.kind == "demonstration_cut":
            cut = values["demonstration"], values["start"], values["end"]
            return context.with_gesture(gesture.with_cut(*cut))
        if self.kind == "switch":
            switches = replace(gesture.switches, **{values["switch"]: values["position"]})
            return context.with_gesture(replace(gesture, switches=switches))
        return context.with_gesture(gesture.with_demonstration(context.poses))

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON types: the kind, the scope, and the values to apply."""
        told = {"kind": self.kind, "reach": self.reach, "size": self.size, **self.values}
        return {**told, "words": self.words}


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
    def repairs_no_other(self) -> bool:
        """Whether it makes this take a demonstration, and is known to repair no other take."""
        effect, kind = self.effect, self.change.kind
        if kind != "further_demonstration" or effect is None:
            return False
        return effect.repaired <= effect.broken

    @property
    def rank(self) -> tuple[bool, int, int, float, float]:
        """The sort key: what repairs most known takes first, what does harm last.

        This take as a demonstration comes last too.
        """
        kind, gained = self.change.kind, 0
        if self.effect is not None:
            gained = self.effect.repaired - self.effect.broken
        last = kind == "further_demonstration" or gained < 0
        return last, -gained, ORDER.index(kind), self.change.size, -self.margin


def find_counterfactuals(
    context: RecognitionContext, expected: str, blame: Sequence[Blame] = (), *, faulty: bool = False
) -> tuple[tuple[Counterfactual, ...], int]:
    """Find the interventions with which `expected` is recognised and no gesture is lost.

    Of each series of increasing interventions the first that succeeds is kept.

    Parameters
    ----------
    context
        The context, in which another label was recognised, or none.
    expected
        A label of the language.
    blame
        Demonstrations of the gesture that are at fault for the known takes.
    faulty
        Whether the nearest demonstration is at fault for this take.

    Returns
    -------
    The best of each kind, in the order in which to try them, and how many were tried.

    """
    shown = [
        KnownTake(gesture.label, each)
        for gesture in context.language.gestures
        for each in gesture.trajectories
    ]
    demonstrations = KnownTakes(context.recognizer, shown)
    best: dict[str, Counterfactual] = {}
    tried = 0
    for series in list_interventions(context, expected, blame, faulty=faulty):
        for change in sorted(series, key=lambda each: each.size):
            tried += 1
            if found := _verify(context, change, expected, demonstrations):
                first = best.get(change.kind, found)
                best[change.kind] = min(first, found, key=lambda each: each.rank)
                break
    kept = [each for each in best.values() if each.effect is None or not each.effect.lost]
    ranked = sorted(kept, key=lambda each: each.rank)
    # A take that becomes a demonstration is right by itself: alone that is no remedy.
    if context.known and ranked and ranked[0].repairs_no_other:
        ranked = []
    return tuple(ranked), tried


def _verify(
    context: RecognitionContext, change: Intervention, expected: str, demonstrations: KnownTakes
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
        _, lost = demonstrations.try_change(after.recognizer)
        # The demonstration that is cut is no take of its gesture any more.
        own = change.values["label"] if change.kind == "demonstration_cut" else None
        repaired, broken = context.known_takes.try_change(after.recognizer)
        effect = LanguageEffect(
            lost=tuple(sorted({demonstrations.takes[index].label for index in lost} - {own})),
            takes=len(context.known),
            repaired=len(repaired),
            broken=len(broken),
        )
    return Counterfactual(
        change=change,
        label=expected,
        confidence=after.result.confidence,
        margin=after.result.margin,
        effect=effect,
    )


def list_interventions(
    context: RecognitionContext, expected: str, blame: Sequence[Blame] = (), *, faulty: bool = False
) -> Iterator[list[Intervention]]:
    """Yield all interventions to try, in series of one kind and increasing size.

    Parameters
    ----------
    context
        A context in which `expected` was not recognised.
    expected
        A label of its language.
    blame, faulty
        See `find_counterfactuals`.

    """
    yield list(_cuts(context, expected, blame, faulty=faulty))
    yield from _trims(context)
    repaired = float(context.repair.touched.mean())
    if repaired > 0:
        yield [Intervention("keypoint_repair", repaired, {"on": not context.recognizer.repairs})]
    yield from _gestures(context, expected)


def _cuts(
    context: RecognitionContext, expected: str, blame: Sequence[Blame], *, faulty: bool
) -> Iterator[Intervention]:
    """Cut the demonstrations that are at fault, for the known takes and for this one."""
    cuts = [(each.demonstration, each.start, each.end) for each in blame]
    table, at = context.score_table, context.language.labels.index(expected)
    comparison = (
        compare_with(context.recognizer, context.trace.query, table, at) if faulty else None
    )
    if comparison and (better := find_better_range([comparison])):
        cuts.append((table.nearest_demonstration(at), *better))
    for number, start, end in cuts:
        if start is not None and end is not None:
            whole = float(context.language.gesture(expected).trajectories[number].time[-1])
            size = min(1.0, max(0.0, 1.0 - (end - start) / whole))
            values = {"label": expected, "demonstration": number, "start": start, "end": end}
            yield Intervention("demonstration_cut", size, values)


def _trims(context: RecognitionContext) -> Iterator[list[Intervention]]:
    """Move the start, the end, or both, within the take, and keep most of the stroke."""
    (start, end), (first, last) = (
        (float(poses.time[0]), float(poses.time[-1])) for poses in (context.poses, context.whole)
    )
    steps = np.arange(1, TRIM_STEPS + 1) * TRIM_STEP * (end - start)
    ways = ((1, 0), (0, -1), (1, -1), (-1, 0), (0, 1))
    cuts = [(each.poses.time[0], each.poses.time[-1]) for each in context.cuts]
    for spans in (
        cuts,
        *([(start + a * by, end + b * by) for by in steps] for a, b in ways),
        [(first, last)],
    ):
        inside = {(max(a, first), min(b, last)) for a, b in spans} - {(start, end)}
        yield [
            Intervention(
                "trim",
                min(1.0, (abs(a - start) + abs(b - end)) / (end - start)),
                {"start": a, "end": b, "longer": bool(a < start or b > end)},
            )
            for a, b in inside
            if spans is cuts or min(b, end) - max(a, start) >= LEAST_KEPT * (end - start) - 1e-9 > 0
        ]


def _gestures(context: RecognitionContext, expected: str) -> Iterator[list[Intervention]]:
    """Change the expected gesture, or the one that was recognised."""
    for label in dict.fromkeys((expected, context.result.nearest)):
        gesture = context.language.gesture(label)
        if gesture.trajectory is not None and isinstance(context.recognizer.vote, FusedVote):
            yield from _switches(context, label, expected=label == expected)
    shown = context.language.gesture(expected).single_demonstrations()
    novelty = context.result.novelty
    is_far = novelty.size and is_rejected(novelty[context.language.labels.index(expected)])
    is_typical = context.closed and not is_far
    if is_typical and len(shown) < MAX_DEMONSTRATIONS:
        values = {"label": expected}
        yield [Intervention("further_demonstration", 1 / (len(shown) + 1), values)]


def _with_other_arm(context: RecognitionContext, gesture: Gesture) -> bool:
    """Return whether no arm that draws a gesture draws in the take."""
    here, there = (
        {parse_body_part(each.hand).partition("_")[0] for each in strokes}
        for strokes in (context.strokes, transcribe_gesture(gesture))
    )
    return here.isdisjoint(there)


def _switches(
    context: RecognitionContext, label: str, *, expected: bool
) -> Iterator[list[Intervention]]:
    """Relax the switches of the expected gesture, and tighten those of the recognised one.

    Only switches of what is in the take: its direction, tempo, other arm or hand shape.
    """
    table, at = context.score_table, context.language.labels.index(label)
    gesture, counting = context.language.gesture(label), context.recognizer.sensitivity(label)
    shaped = any(each.moving_hands for each in gesture.trajectories)
    shape_counts = counting is not None and counting.hand_shape
    traversal = table.traversals[at]
    slower = table.distances[table.voters.index("tempo"), at] > CLEARLY_SLOWER
    strict: Switch = "off" if expected else "on"
    positions: dict[str, tuple[Switch, bool]] = {
        "direction": (strict, traversal is not None and traversal.backward != expected),
        "tempo": (strict, bool(slower)),
        "mirror": (
            "on" if expected else "off",
            _with_other_arm(context, gesture) if expected else bool(table.mirrored[at]),
        ),
        "hand_shape": (strict, shaped and shape_counts == expected),
    }
    for switch, (position, matters) in positions.items():
        if matters and getattr(gesture.switches, switch) != position:
            values = {"label": label, "switch": switch, "position": position}
            yield [Intervention("switch", 1 / 3, values)]
