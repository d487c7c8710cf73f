"""Counterfactual search: lists interventions to try, in series of increasing size."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from app.recognition.decision.motion_references import CLEARLY_SLOWER
from app.recognition.explanation.context import RecognitionContext
from app.recognition.explanation.counterfactual_kinds import (
    FurtherDemonstration,
    Intervention,
    KeypointRepair,
    NewDemonstration,
    OtherProfile,
    SalientKeypoints,
    Simplification,
    SwitchName,
    SwitchPosition,
    Trim,
    VoterWeight,
)
from app.recognition.gestures.demonstration import MAX_DEMONSTRATIONS
from app.recognition.gestures.gesture import Gesture
from app.recognition.gestures.profile import PROFILES
from app.recognition.gestures.switches import Switch
from app.recognition.preprocessing.repair import repair_poses
from app.recognition.preprocessing.salience import find_salient_landmarks

TRIM_STEP = 0.1
"""Step of trimming, as a share of the stroke."""

TRIM_STEPS = 4
"""Most steps at either end; a longer part is hardly a transit."""

LEAST_KEPT = 0.8
"""Share of the stroke that a trim keeps; a shorter part of it is another gesture."""

WEIGHTS = (0.5, 0.0, 2.0, 4.0)
"""Weight factors that are tried."""

TOLERANCES = (0.5, 2.0, 4.0)
"""Factors on the drawings' simplification tolerance that are tried."""

Series = list[Intervention]


def list_interventions(context: RecognitionContext, expected: str) -> Iterator[Series]:
    """Yield all interventions to try.

    Parameters
    ----------
    context
        A context in which `expected` was not recognised.
    expected
        A label of its language.

    Returns
    -------
    Series of interventions of one kind, in the order in which to try them.

    """
    yield from _trims(context)
    yield from _weights(context, expected)
    yield from _drawings(context)
    yield from _repairs(context)
    yield from _gestures(context, expected)
    yield [OtherProfile(size=1.0, profile=other) for other in PROFILES if other != context.profile]


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
            Trim(size=min(1.0, (abs(a - start) + abs(b - end)) / duration), start=a, end=b)
            for a, b in inside
            if duration > 0 and min(b, end) - max(a, start) >= LEAST_KEPT * duration - 1e-9
        ]


def _weights(context: RecognitionContext, expected: str) -> Iterator[Series]:
    """Decrease and increase the weight of each voter if that may make the expected gesture win."""
    gesture = context.language.labels.index(expected)
    vote = context.recognizer.vote
    for voter, share in context.result.weights.items():
        if 0 < share < 1:
            for factors in (WEIGHTS[:2], WEIGHTS[2:]):
                yield [
                    VoterWeight(
                        size=_measure_moved_weight(share, factor), voter=voter, factor=factor
                    )
                    for factor in factors
                    if vote.may_win(context.score_table, context.result, gesture, voter, factor)
                ]


def _measure_moved_weight(share: float, factor: float) -> float:
    """Return the total weight that moves when one voter's weight is multiplied."""
    return abs(share * factor / (1 - share + share * factor) - share)


def _drawings(context: RecognitionContext) -> Iterator[Series]:
    now = context.tuning.simplification
    if now > 0:
        for factors in (TOLERANCES[:1], TOLERANCES[1:]):
            yield [
                Simplification(size=1 - min(factor, 1 / factor), tolerance=now * factor)
                for factor in factors
            ]


def _repairs(context: RecognitionContext) -> Iterator[Series]:
    """Switch the repair of keypoints on or off, if it changes any."""
    share = float(repair_poses(context.poses).touched.mean())
    if share > 0:
        yield [KeypointRepair(size=share, on=not context.recognizer.repairs)]


def _gestures(context: RecognitionContext, expected: str) -> Iterator[Series]:
    """Change the expected gesture, or the one that was recognised."""
    moved = find_salient_landmarks(context.trajectory)
    for label in dict.fromkeys((expected, context.result.nearest)):
        gesture = context.language.gesture(label)
        if gesture.trajectory is None:
            continue
        yield _other_salient(gesture, {*moved} & {*gesture.trajectory.landmarks})
        if PROFILES[context.profile].compares_motion:
            yield from _switches(context, label, expected=label == expected)
    shown = context.language.gesture(expected).single_demonstrations()
    if len(shown) < MAX_DEMONSTRATIONS:
        yield [FurtherDemonstration(size=1 / (len(shown) + 1), label=expected)]
    yield [NewDemonstration(size=1.0, label=expected)]


def _other_salient(gesture: Gesture, moved: set[str]) -> Series:
    """Drop one salient landmark, add one that the query moves, or use just those that it moves."""
    now = {*gesture.salient}
    others = [now - {name} for name in now] + [now | {name} for name in moved] + [moved]
    return [
        SalientKeypoints(
            size=len(now ^ other) / len(now | other),
            label=gesture.label,
            salient=tuple(sorted(other)),
        )
        for other in others
        if other and other != now
    ]


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
