"""Causes: why a take is not read as the gesture that was meant, in one sentence with a remedy.

No cause is guessed. First stands what the keypoints themselves show, then a way from or to a salute
without which the take is read right, then a fault of the demonstration, then that two gestures of
the language are alike, and last a change of the take that is proven:
undoing it (`undoing`) removes most of what is too far, no other change half as much, and the
drawings show it. Without such evidence no cause is named, and the transcript tells what was shown.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from enum import Enum
from typing import Final

import numpy as np
import numpy.typing as npt

from app.recognition.decision.outcome import is_rejected
from app.recognition.decision.result import WRITTEN, ScoreTable
from app.recognition.errors import OsgError, PoseError
from app.recognition.explanation.blame import Blame
from app.recognition.explanation.context import RecognitionContext
from app.recognition.explanation.hand_differences import (
    find_held_difference,
    find_moving_hand_difference,
)
from app.recognition.explanation.undoing import Comparison, Undone, Where, compare_with
from app.recognition.gestures.gesture import Gesture
from app.recognition.poses.trajectory import TURNED_AWAY, Trajectory
from app.recognition.preprocessing.outliers import find_other_body, find_unsteady
from app.recognition.recognizer import Recognizer

EXPLAINED: Final = 0.6
"""Least share of the distance beyond `USUAL` that a change must remove to be named as cause."""

NEXT: Final = 0.5
"""Largest share of the next kind of change, relative to that of the one that is named; both are
chosen by `benchmarks.accuracy.misreadings`, people left out."""

PAIR: Final = 0.1
"""Share that a take that is turned over and lacks an end must remove more than either alone."""

TURNS: Final = ("reversed", "mirrored", "other_arm", "upside_down")
"""Kinds that turn all of a take over, of which several may be the same for a gesture: of those that
bring it as near, within `SAME`, the first one is named."""

SAME: Final = 0.25
"""Step of novelty within which two changes are as good."""

LEAST_JUMPED: Final = 0.06
"""Least share of a take's frames in which keypoints leap away, or another body is read."""

LEAST_MIXED: Final = 0.2
"""Least share of a take's frames in which left and right are mixed, or an arm is not seen."""

ALIKE: Final = 0.75
"""Novelty of one gesture's demonstration for another gesture below which the two are nearly the
same in this language."""

SINKS_WITHIN: Final = 0.4
"""Largest width of the way of an arm that sinks, as a share of its height."""

CONFUSED: Final = 2
"""Least known takes of one of two gestures that are read as the other if the two are alike."""


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


SENTENCES: Final[Mapping[str, str]] = {
    "mirrored": "The take is the mirror image of {label}{also}. Show it the other way round.",
    "reversed": "The take goes through {label} backwards{also}. Begin at its other end.",
    "begun_late": "The beginning of {label} is missing. Start earlier, or set the range.",
    "ended_early": "The end of {label} is missing. Finish it, or set the range.",
    "part_added": "A movement {where} {label} was added. Leave it out.",
    "cut": "A way {where} {label} is included. Set its range: {start:.2f}-{end:.2f} s.",
    "sinks": "The first salute was missed: an arm sinks here. Show both salutes again.",
    "part_missing": "A part of {label} is missing in the middle. Show all of it.",
    "upside_down": "The take shows {label} upside down{also}. Show all of it upright.",
    "other_arm": "The take shows {label} with the other arm{also}. Use the demonstrated one.",
    "turned_away": "The diver is turned {degrees:.0f} degrees away. Face the camera, and repeat.",
    "too_small": "The movement is too small for {label}{also}. Show it larger.",
    "keypoints_jumped": "Keypoints jumped in {frames}. Film nearer, or in better light.",
    "mixed": "Left and right were mixed in {frames}. Film nearer or brighter.",
    "no_hand": "No fingers are seen, but their shape counts. Gloves? Show the hand nearer.",
    "other_person": "Another body was read in at least {frames}. Film one diver alone.",
    "near_gesture": "{label} and {other} are nearly alike. Change one of the two.",
    "not_seen": "The arm is not seen in {frames}. Film all of it.",
    "not_comparable": "A keypoint that {label} needs is not seen moving. Film the whole arm.",
}
"""The cause and what the diver can do, at most fifteen words with labels of one word."""

WHERE: Final[Mapping[Where, str]] = {
    "start": "before",
    "middle": "in the middle of",
    "end": "after",
}
"""Where a part was added."""

ALSO: Final[Mapping[str, str]] = {
    "": "",
    "begun_late": " and lacks its beginning",
    "ended_early": " and is unfinished",
}
"""Added to the sentence where a reversed, mirrored or upside-down take also lacks a part."""


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
    also
        What a take that is turned over lacks too; None: nothing.
    start, end
        Seconds in the take's clock of what differs; None: throughout. For what is missing, `start`
        equals `end`.
    label, demonstration
        Gesture and number of the demonstration at fault, or the gesture that is nearly alike; None
        where the take is at fault.

    """

    __pydantic_config__ = WRITTEN

    kind: CauseKind
    share: float = 1.0
    sentence: str
    also: CauseKind | None = None
    start: float | None = None
    end: float | None = None
    label: str | None = None
    demonstration: int | None = None


def find_causes(
    context: RecognitionContext,
    expected: str,
    blame: Sequence[Blame] | None = None,
    *,
    explained: float = EXPLAINED,
    following: float = NEXT,
) -> tuple[Cause, ...]:
    """Find why a take is not read as the gesture that was meant, the surest cause first.

    Parameters
    ----------
    context
        The take and the recogniser.
    expected
        A label of its language.
    blame
        Demonstrations of the gesture that are at fault for the known takes; None: these are not
        read.
    explained, following
        See `EXPLAINED` and `NEXT`.

    Returns
    -------
    The causes that there is evidence for, at most one of a kind; empty for a take that is read
    right, and where nothing is seen or proven.

    """
    if context.result.label == expected:
        return ()
    recognizer = context.full_recognizer
    at = recognizer.language.labels.index(expected)
    table = recognizer.compare(context.trace.query)
    gesture = table.find_nearest_demonstration(recognizer.language.gestures, at)
    if _only_sinks(context) and context.compare_strokes(expected).differs is not None:
        return (Cause(kind=CauseKind.not_seen, sentence=SENTENCES["sinks"]),)
    found = list(_list_seen(context, table, gesture))
    if cut := _find_cut(context, expected, float(table.novelty[at])):
        found.append(cut)
    if bad := _find_bad_demonstration(context, table, at, blame or ()):
        found.append(bad)
    near = _find_near_gesture(context, table, at, with_known=blame is not None)
    if near and not cut:
        found.append(near)
    comparison = compare_with(recognizer, context.trace.query, table, at)
    if (
        comparison is not None
        and not cut
        and (proven := prove_change(comparison, explained, following))
    ):
        rival = float(np.fmin.reduce(np.delete(table.novelty, at), initial=np.inf))
        if proven.novelty <= rival:
            found.append(_name_change(comparison, proven, expected, float(context.poses.time[0])))
    if not found and not np.isfinite(table.scores[at]):
        sentence = SENTENCES["not_comparable"].format(label=repr(expected))
        found.append(Cause(kind=CauseKind.not_seen, sentence=sentence))
    return tuple(found)


def _only_sinks(context: RecognitionContext) -> bool:
    """Return whether an unclosed take is the arm that sinks after its last salute."""
    if context.closed or not context.strokes:
        return False
    names = [*{each.hand for each in context.strokes}]
    x, y = np.moveaxis(context.repair.trajectory.select(names).fill_gaps().xy, 2, 0)
    wide, high = (np.nanmax(each, axis=0) - np.nanmin(each, axis=0) for each in (x, y))
    sunk = y[-1] - np.nanmin(y, axis=0)
    return bool((wide < SINKS_WITHIN * high).all() and (sunk > (1 - SINKS_WITHIN / 4) * high).all())


def _find_cut(context: RecognitionContext, expected: str, novelty: float) -> Cause | None:
    """Return a way from or to a salute that is in the take: without it the gesture is nearest.

    It is the first or the last stroke, without which the others are those of the gesture, so that
    the novelty falls. Of two the one that explains the take better.
    """
    at, best, found = context.language.labels.index(expected), novelty, None
    if context.compare_strokes(expected).differs is None:
        return None
    for cut in context.cuts:
        with suppress(OsgError):
            without = context.with_poses(cut.poses)
            now = float(without.score_table.novelty[at])
            if (
                now < best
                and without.result.nearest == expected
                and without.compare_strokes(expected).differs is None
            ):
                best, found = now, cut
    if found is None:
        return None
    start, end = float(found.poses.time[0]), float(found.poses.time[-1])
    words = {"where": WHERE[found.where], "label": repr(expected)}
    return Cause(
        kind=CauseKind.part_added,
        sentence=SENTENCES["cut"].format(**words, start=start, end=end),
        start=found.stroke.start,
        end=found.stroke.end,
    )


def _find_bad_demonstration(
    context: RecognitionContext, table: ScoreTable, at: int, blame: Sequence[Blame]
) -> Cause | None:
    """Return the fault of a demonstration: by the known takes, or seen in its clip."""
    label, number = context.language.labels[at], table.nearest_demonstration(at)
    faults = context.faults.get(label, ())
    if blame:
        number, sentence = blame[0].demonstration, blame[0].sentence
    elif number < len(faults) and faults[number]:
        sentence = faults[number][0].describe(label)
    else:
        return None
    kind = CauseKind.demonstration
    return Cause(kind=kind, sentence=sentence, label=label, demonstration=number)


def prove_change(
    comparison: Comparison, explained: float = EXPLAINED, following: float = NEXT
) -> Undone | None:
    """Return the one change that explains a take's distance.

    None where none removes `explained` of it, where another kind removes more than `following` of
    that share, or where the drawings do not show it.
    """
    best: dict[tuple[str, str], Undone] = {}
    for undone in comparison.undo_all():
        key = undone.kind, undone.also
        best[key] = min(best.get(key, undone), undone, key=lambda each: each.novelty)

    def rank(each: Undone) -> tuple[float, int, int]:
        order = TURNS.index(each.kind) if each.kind in TURNS else len(TURNS)
        return PAIR * bool(each.also) - each.share, int(each.novelty / SAME), order

    first = min(best.values(), key=rank)
    # A circle that is drawn backwards is its mirror image too: of turns the nearest one counts.
    same = {first.kind, first.also, *(TURNS if first.kind in TURNS else ())}
    others = [each.share for each in best.values() if not each.also and each.kind not in same]
    enough = first.share >= max(explained, max(others, default=0.0) / following)
    return first if enough and comparison.is_drawn(first) else None


def tell_change(undone: Undone, label: str) -> str:
    """Return a proven change of a take, and what the diver can do, as a sentence each."""
    where = WHERE[undone.part.where] if undone.part else ""
    words = {"label": repr(label), "also": ALSO[undone.also], "where": where}
    return SENTENCES[undone.kind].format(**words)


def _name_change(comparison: Comparison, undone: Undone, label: str, begins: float) -> Cause:
    """Return a proven change as a cause."""
    start, end = comparison.locate(undone)
    return Cause(
        kind=CauseKind(undone.kind),
        share=undone.share,
        sentence=tell_change(undone, label),
        also=CauseKind(undone.also) if undone.also else None,
        start=None if start is None else begins + start,
        end=None if end is None else begins + end,
    )


def _list_seen(context: RecognitionContext, table: ScoreTable, gesture: Gesture) -> Iterator[Cause]:
    """Yield what the keypoints and the hand themselves show, what most frames show first."""
    fault = context.result.fault_kind
    if fault == "unseen_hand":
        yield Cause(kind=CauseKind.no_hand, sentence=SENTENCES["no_hand"])
        return
    found = sorted(_list_bad_frames(context, gesture), key=lambda each: -each[1].mean())
    for key, bad in found:
        times = context.poses.time[bad]
        frames = f"{np.count_nonzero(bad)} of {len(bad)} frames"
        yield Cause(
            kind=CauseKind.keypoints_jumped if key == "mixed" else CauseKind(key),
            sentence=SENTENCES[key].format(frames=frames),
            start=float(times[0]),
            end=float(times[-1]),
        )
    if context.result.fault is not None and not found:
        words = context.result.fault
        kind = CauseKind.keypoints_jumped if fault == "leaps" else CauseKind.not_seen
        remedy = " Film nearer, or in better light." if fault else ""
        sentence = f"{words[0].upper()}{words[1:]}.{remedy}"
        yield Cause(kind=kind, sentence=sentence)
    here = context.trace.query.facing
    there = None if gesture.trajectory is None else gesture.trajectory.facing
    # Where left and right are mixed, nobody knows which way the diver faces.
    known = "mixed" not in dict(found)
    if known and here is not None and there is not None and abs(here - there) >= TURNED_AWAY:
        sentence = SENTENCES["turned_away"].format(degrees=abs(here - there))
        yield Cause(kind=CauseKind.turned_away, sentence=sentence)
    if shaped := _compare_hands(context, table, gesture):
        yield shaped


def _list_bad_frames(
    context: RecognitionContext, gesture: Gesture
) -> Iterator[tuple[str, npt.NDArray[np.bool_]]]:
    """Yield what is wrong with the keypoints, and the frames ``(T,)`` where it is, if enough."""
    poses = context.poses
    names = [name for name in gesture.salient if name in poses.landmarks]
    if not names or not poses.seen.any():
        return
    raw, repair = Trajectory.from_poses(poses), context.repair
    unseen = np.asarray(~poses.select(names).seen.all(axis=1))
    masks: dict[str, tuple[npt.NDArray[np.bool_], float]] = {
        "keypoints_jumped": (find_unsteady(raw, names), LEAST_JUMPED),
        "mixed": (repair.exchanged | repair.blended, LEAST_MIXED),
        "other_person": (find_other_body(raw), LEAST_JUMPED),
        # An arm that is never seen is not shown: the take may be with the other one.
        "not_seen": (unseen & (not unseen.all()), LEAST_MIXED),
    }
    yield from ((key, bad) for key, (bad, least) in masks.items() if bad.mean() >= least)


def _compare_hands(
    context: RecognitionContext, table: ScoreTable, gesture: Gesture
) -> Cause | None:
    """Return how the hand differs, where it is the hand that is too far from the gesture's."""
    query, at = context.trace.query, context.language.labels.index(gesture.label)
    movement, hand = (float(row[at]) for row in table.novelty_by_view)
    found = None
    if gesture.is_held:
        found = find_held_difference(gesture.label, query.held_shapes, gesture.held_shapes)
    elif gesture.trajectory is not None and is_rejected(hand) and not is_rejected(movement):
        shown = gesture.mirror().trajectory if table.mirrored[at] else gesture.trajectory
        assert shown is not None
        found = find_moving_hand_difference(gesture.label, query.moving_hands, shown.moving_hands)
    if found is None:
        return None
    return Cause(
        kind=CauseKind.other_hand_shape if found.share else CauseKind.no_hand,
        share=found.share or 1.0,
        sentence=f"{found.words[0].upper()}{found.words[1:]}. Show the hand again.",
    )


def _find_near_gesture(
    context: RecognitionContext, table: ScoreTable, at: int, *, with_known: bool
) -> Cause | None:
    """Return the gesture that the take is read as, or asked back with, if the two are alike.

    They are if one's demonstration is as near as a take to the other, or if known takes of one are
    read as the other.
    """
    labels, result = context.language.labels, context.result
    others = [label for label in (result.nearest, *result.between) if label != labels[at]]
    if not others or is_rejected(float(table.novelty[at])):
        return None
    pair = {labels[at], others[0]}
    known = zip(context.known, context.known_takes.readings, strict=True) if with_known else ()
    confused = sum(take.label != read and {take.label, read} == pair for take, read in known)
    other = labels.index(others[0])
    if confused < CONFUSED and not _are_alike(context.full_recognizer, at, other):
        return None
    sentence = SENTENCES["near_gesture"].format(label=repr(labels[at]), other=repr(others[0]))
    return Cause(kind=CauseKind.near_gesture, sentence=sentence, label=others[0])


def _are_alike(recognizer: Recognizer, one: int, other: int) -> bool:
    """Return whether the demonstration of one of two gestures is nearly one of the other."""
    shown = [recognizer.language.gestures[each].trajectory for each in (one, other)]
    for trajectory, compared in zip(shown, (other, one), strict=True):
        with suppress(PoseError):
            if trajectory is not None and recognizer.compare(trajectory).novelty[compared] < ALIKE:
                return True
    return False
