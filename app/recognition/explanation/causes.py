"""Causes: why a take is not read as the gesture that was meant, in one sentence with a remedy.

Each kind is tested directly: the change that would undo it is applied, and the take is compared
again (`undoing`). The one that brings take and gesture nearest with the smallest change is the
cause, if that is near enough; without such evidence no cause is named.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import Enum
from typing import Final

import numpy as np

from app.recognition.decision.fused_vote import FusedVote
from app.recognition.decision.rejection import is_rejected
from app.recognition.decision.result import WRITTEN, Recognition
from app.recognition.decision.score_table import ScoreTable
from app.recognition.errors import PoseError
from app.recognition.explanation.context import RecognitionContext
from app.recognition.explanation.demonstration_faults import DemonstrationFault
from app.recognition.explanation.hand_differences import (
    find_held_differences,
    find_moving_hand_differences,
)
from app.recognition.explanation.undoing import Comparison, Undone, find_better_range
from app.recognition.gestures.gesture import Gesture
from app.recognition.poses.trajectory import Trajectory
from app.recognition.recognizer import Recognizer

EXPLAINED: Final = 0.2
"""Least share of the distance beyond `USUAL` that a change must remove to be named as cause; chosen
by `benchmarks.accuracy.known_faults` on people left out."""

USUAL: Final = 0.45
"""Novelty of a right take by another person: what no change is expected to remove."""

COST_OF_SIZE: Final = 0.2
"""Share of the distance that a change must remove in addition for each whole that it cuts away, so
that of two changes that explain as much the smaller one is named."""

SEEN: Final = frozenset({"keypoints_jumped", "other_person"})
"""Kinds that the keypoints themselves show, whether or not the take is read without the moments."""

LEAST_SEEN: Final = 0.06
"""Least share of a take's moments at which they are seen."""

CLOSE: Final = 0.15
"""Novelty by which another gesture may be nearer than the gesture meant after a change: a swipe to
the left that is shown backwards is one to the right."""

AS_NEAR: Final = 1.1
"""Largest novelty after a change that turns nothing, over that of the gesture that the take is
answered as, which explains it well; chosen by `benchmarks.accuracy.known_faults`."""

TURNED: Final = frozenset({"mirrored", "reversed", "upside_down", "other_arm", "turned_away"})
"""Kinds that change all of the take, of which there are few to choose from."""

MOST_LEFT: Final = 1.2
"""Largest novelty after a change: slightly beyond the limit, since a take may have two faults."""

ALIKE: Final = 0.75
"""Novelty of one gesture's demonstration for another gesture below which the two are nearly the
same in this language."""


class CauseKind(str, Enum):
    """Why a take is not read as the gesture that was meant."""

    mirrored = "mirrored"
    reversed = "reversed"
    begun_late = "begun_late"
    ended_early = "ended_early"
    part_missing = "part_missing"
    part_added = "part_added"
    upside_down = "upside_down"
    other_arm = "other_arm"
    turned_away = "turned_away"
    too_small = "too_small"
    keypoints_jumped = "keypoints_jumped"
    no_hand = "no_hand"
    other_hand_shape = "other_hand_shape"
    other_person = "other_person"
    near_gesture = "near_gesture"
    demonstration = "demonstration"
    not_seen = "not_seen"


CAUTION: Final[Mapping[str, float]] = {
    "reversed": 0.0,
    "mirrored": 0.04,
    "upside_down": 0.06,
    "other_arm": 0.0,
    "turned_away": 0.0,
    "too_small": 0.15,
    "keypoints_jumped": -0.1,
    "other_person": -0.2,
    "begun_late": 0.05,
    "ended_early": 0.05,
    "part_added": 0.05,
    "part_missing": 0.1,
    "demonstration": 0.35,
}
"""Share of the distance that a kind must remove in addition: more where there are more changes to
choose from, less where the keypoints themselves show the fault."""

SENTENCES: Final[Mapping[str, str]] = {
    "mirrored": "The take is the mirror image of {label}. Show it the other way round.",
    "reversed": "The take goes through {label} backwards. Begin at its other end.",
    "begun_late": "The beginning of {label} is missing. Start earlier, or set the range.",
    "ended_early": "The end of {label} is missing. Finish it, or set the range.",
    "part_missing": "A part of {label} is missing in the middle. Show all of it.",
    "upside_down": "The take shows {label} upside down. Show it upright.",
    "other_arm": "The take shows {label} with the other arm. Use the demonstrated one.",
    "turned_away": "The diver is turned away from the camera. Face it and repeat.",
    "too_small": "The movement is too small for {label}. Show it larger.",
    "keypoints_jumped": "The keypoints of the arm jumped. Film nearer, or in better light.",
    "no_hand": "No hand is seen, but its shape counts. Show the hand nearer.",
    "other_person": "Another person's body was read for a while. Film one diver alone.",
    "near_gesture": "{label} and {other} are nearly alike. Change one of the two.",
    "demonstration": "{words}",
    "not_seen": "A keypoint that {label} needs is not seen moving. Film the whole arm.",
}
"""The cause and what the diver can do, at most fifteen words with labels of one word."""

ADDED: Final[Mapping[str, str]] = {
    "start": "A movement before {label} was added. Begin later, or set the range.",
    "middle": "A movement in the middle of {label} was added. Leave it out.",
    "end": "A movement after {label} was added. Stop earlier, or set the range.",
}


@dataclass(frozen=True, kw_only=True)
class Cause:
    """Why a take is not read as the gesture that was meant.

    Attributes
    ----------
    kind
        See `CauseKind`.
    share
        In [0, 1]: part of the distance beyond that of usual takes that undoing the cause removes;
        1 for what is seen directly, such as an unseen hand.
    sentence
        The cause and what the diver can do, at most fifteen words.
    start, end
        Seconds in the take's clock of what differs; None: throughout. For what is missing, `start`
        equals `end`.
    label, demonstration
        Gesture and number of the demonstration at fault; None where the take is.
    keep
        Seconds of a demonstration's own clock between which it should be kept; None: not known.

    """

    __pydantic_config__ = WRITTEN

    kind: CauseKind
    share: float
    sentence: str
    start: float | None = None
    end: float | None = None
    label: str | None = None
    demonstration: int | None = None
    keep: tuple[float, float] | None = None


def find_causes(
    context: RecognitionContext, expected: str, as_near: float = AS_NEAR
) -> tuple[Cause, ...]:
    """Find why a take is not read as the gesture that was meant, the first cause first.

    Parameters
    ----------
    context
        The take and the recogniser.
    expected
        A label of its language.
    as_near
        See `AS_NEAR`; smaller: fewer causes of takes that are answered as another gesture.

    Returns
    -------
    The causes that there is evidence for, at most one of a kind; empty for a take that is read
    right, and where nothing that was undone explains the distance.

    """
    if context.result.label == expected:
        return ()
    recognizer = full_recognizer(context.recognizer)
    at = recognizer.language.labels.index(expected)
    trace = context.trace
    if unseen := _find_unseen(context.result):
        return (_name(unseen, 1.0, expected),)
    table = recognizer.compare(trace.query)
    gesture = table.find_nearest_demonstration(recognizer.language.gestures, at)
    if shaped := _compare_hands(context, recognizer, table, gesture):
        return (shaped,)
    found = []
    comparison = compare_with(recognizer, trace.query, table, at)
    if comparison is not None:
        start = float(context.poses.time[0])
        rival = float(np.fmin.reduce(np.delete(table.novelty, at), initial=np.inf))
        raw = Trajectory.from_poses(context.poses)
        answered = as_near if context.result.label is not None else None
        found = weigh_changes(comparison, raw, expected, start, rival, answered)
    number = table.nearest_demonstration(at)
    found = [
        replace(each, demonstration=number) if each.kind is CauseKind.demonstration else each
        for each in found
    ]
    of_gesture = context.faults.get(expected, ())
    faults = of_gesture[number] if number < len(of_gesture) else ()
    if faults:
        keep = None if comparison is None else find_better_range([comparison])
        blamed = _blame(faults[0], expected, number, keep)
        first = not found or found[0].kind.value in {*CUTS, "too_small"}
        found = [each for each in found if each.kind is not CauseKind.demonstration]
        found.insert(0 if first else 1, blamed)
    if not found and not np.isfinite(table.scores[at]):
        found.append(_name("not_seen", 1.0, expected))
    if near := _find_near_gesture(recognizer, table, context.result, at):
        found.append(near)
    return tuple(found)


CUTS: Final = frozenset(
    {"begun_late", "ended_early", "part_missing", "part_added", "demonstration"}
)
"""Kinds that cut something away; a demonstration at fault looks like them in a good take."""


def full_recognizer(recognizer: Recognizer) -> Recognizer:
    """Return the recogniser of profile ``full`` for a language; causes are sought by its vote."""
    if isinstance(recognizer.vote, FusedVote):
        return recognizer
    return Recognizer(recognizer.language, "full")


def compare_with(
    recognizer: Recognizer, query: Trajectory, table: ScoreTable, at: int
) -> Comparison | None:
    """Return the comparison of a take with a gesture's nearest demonstration; None without one."""
    shown = table.find_nearest_demonstration(recognizer.language.gestures, at)
    vote = recognizer.vote
    if (
        not isinstance(vote, FusedVote)
        or shown.trajectory is None
        or shown.is_held
        or len(shown.trajectory) < 2
        or len(query) < 2
        or not shown.salient
    ):
        return None
    return Comparison(vote, query, shown, table.traversals[at], mirrored=bool(table.mirrored[at]))


def weigh_changes(
    comparison: Comparison,
    raw: Trajectory,
    label: str,
    start: float = 0.0,
    rival: float = math.inf,
    as_near: float | None = None,
) -> list[Cause]:
    """Return the kinds of changes that explain the distance of a take, the best first.

    Parameters
    ----------
    comparison
        The take and the demonstration.
    raw
        The take at the moments of its frames, before repair, which hides jumps.
    label
        The gesture's.
    start
        Second of the take's clock at which it begins.
    rival
        Novelty of the take for another gesture, which explains it better than a change by which it
        is farther.
    as_near
        See `AS_NEAR`; None for a take that is not answered as another gesture.

    """
    base = comparison.base
    best: dict[str, tuple[float, float, Undone]] = {}
    for undone in comparison.undo_all(raw):
        share = measure_share(base, undone.novelty)
        cost = COST_OF_SIZE * undone.size if undone.kind in CUTS else 0.0
        worth = share - cost - CAUTION[undone.kind]
        if undone.kind not in best or worth > best[undone.kind][0]:
            best[undone.kind] = (worth, share, undone)
    ordered = sorted(best.values(), key=lambda each: -each[0])
    named = []
    for worth, share, undone in ordered:
        most = rival + CLOSE
        if as_near is not None and undone.kind not in TURNED:
            most = as_near * rival
        near = undone.novelty <= min(MOST_LEFT, most)
        seen = undone.kind in SEEN and undone.size >= LEAST_SEEN and (near or as_near is None)
        if (worth >= EXPLAINED and near) or seen:
            keep = comparison.locate_cut(undone.cut) if any(undone.cut) else None
            named.append(replace(_name(undone.kind, share, label, undone, start), keep=keep))
    return named


def measure_share(before: float, after: float) -> float:
    """Return the share of a distance beyond `USUAL` that a change removes, in [0, 1]."""
    if not math.isfinite(before):
        return 1.0 if math.isfinite(after) else 0.0
    beyond = before - USUAL
    return min(1.0, max(0.0, 1.0 - max(0.0, after - USUAL) / beyond)) if beyond > 0 else 0.0


def _name(
    kind: str, share: float, label: str, undone: Undone | None = None, start: float = 0.0
) -> Cause:
    """Return a cause with its sentence."""
    template = ADDED[undone.where] if kind == "part_added" and undone else SENTENCES[kind]
    words = f"The demonstration of {label!r} has more at both ends than the take. Set its range."
    sentence = template.format(label=repr(label), words=words)
    if undone is None:
        return Cause(kind=CauseKind(kind), share=share, sentence=sentence)
    return Cause(
        kind=CauseKind(kind),
        share=share,
        sentence=sentence,
        start=None if undone.start is None else start + undone.start,
        end=None if undone.end is None else start + undone.end,
        label=label if kind == "demonstration" else None,
    )


def _blame(
    fault: DemonstrationFault, label: str, demonstration: int, keep: tuple[float, float] | None
) -> Cause:
    """Return a fault of a demonstration as a cause; `keep` is a better range if one is known."""
    return Cause(
        kind=CauseKind.demonstration,
        share=1.0,
        sentence=fault.describe(label),
        label=label,
        demonstration=demonstration,
        keep=keep if fault.remedy == "set_range" else None,
    )


def _find_unseen(result: Recognition) -> str | None:
    """Return the kind of what is not seen: the hand whose shape counts, or a keypoint."""
    if result.fault_kind == "unseen_hand":
        return "no_hand"
    if result.fault_kind is not None:
        return "keypoints_jumped" if result.fault_kind == "leaps" else "not_seen"
    return None


def _compare_hands(
    context: RecognitionContext, recognizer: Recognizer, table: ScoreTable, gesture: Gesture
) -> Cause | None:
    """Return how the hand differs, where it is the hand that is too far from the gesture's."""
    query = context.trace.query
    at = recognizer.language.labels.index(gesture.label)
    if gesture.is_held:
        found = find_held_differences(gesture.label, query.held_shapes, gesture.held_shapes)
    elif gesture.trajectory is not None and _is_by_hand(table, at):
        mirrored = bool(table.mirrored[at])
        shown = gesture.trajectory.mirror() if mirrored else gesture.trajectory
        found = find_moving_hand_differences(gesture.label, query.moving_hands, shown.moving_hands)
    else:
        return None
    if not found:
        return None
    words = found[0].words
    return Cause(
        kind=CauseKind.no_hand if not found[0].share else CauseKind.other_hand_shape,
        share=found[0].share or 1.0,
        sentence=f"{words[0].upper()}{words[1:]}. Show the hand again.",
    )


def _is_by_hand(table: ScoreTable, at: int) -> bool:
    """Return whether the hand alone is too far from a gesture's, and the movement is not."""
    movement, hand = (float(row[at]) for row in table.novelty_by_view)
    return is_rejected(hand) and not is_rejected(movement)


def _find_near_gesture(
    recognizer: Recognizer, table: ScoreTable, result: Recognition, at: int
) -> Cause | None:
    """Return the other gesture that the take is nearer to, where the two are nearly alike."""
    labels = recognizer.language.labels
    other = labels.index(result.nearest)
    if other == at:
        between = [label for label in result.between if label != labels[at]]
        if not between:
            return None
        other = labels.index(between[0])
    shown = recognizer.language.gestures[at].trajectory
    if shown is None or recognizer.language.gestures[other].trajectory is None:
        return None
    try:
        novelty = float(recognizer.compare(shown).novelty[other])
    except PoseError:
        return None
    if not novelty < ALIKE or is_rejected(float(table.novelty[at])):
        return None
    sentence = SENTENCES["near_gesture"].format(label=repr(labels[at]), other=repr(labels[other]))
    return Cause(kind=CauseKind.near_gesture, share=1.0, sentence=sentence, label=labels[other])
