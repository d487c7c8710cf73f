"""Pair difference: how and when the demonstrations of two gestures differ."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from app.recognition.explanation.alignment import Alignment, Example, align
from app.recognition.explanation.causes import CauseKind, compare_with, weigh_changes
from app.recognition.explanation.divergence import measure_divergence
from app.recognition.features.motion import build_movement
from app.recognition.gestures.demonstration import condense
from app.recognition.recognizer import Recognizer
from app.recognition.text.wording import humanize


@dataclass(frozen=True, eq=False)
class PairDifference:
    """The difference of one demonstration from another.

    Attributes
    ----------
    words
        The difference as a clause, in which "it" is the first demonstration.
    stroke
        Seconds in the first demonstration's clock between which the two differ most.
    alignment
        DTW alignment of the two demonstrations' paths.

    """

    words: str
    stroke: tuple[float, float]
    alignment: Alignment


def compare_pair(recognizer: Recognizer, one: int, other: int) -> PairDifference | None:
    """Compare the demonstrations of two gestures.

    Parameters
    ----------
    recognizer
        Of the language, profile ``full``.
    one, other
        Indices of two gestures.

    Returns
    -------
    None where the two cannot be compared.

    """
    shown = recognizer.language.gestures[one]
    if shown.trajectory is None:
        return None
    query = condense(shown.trajectory)
    compared = recognizer.compare(query)
    comparison = compare_with(recognizer, query, compared, other)
    traversal = compared.traversals[other]
    if comparison is None or traversal is None:
        return None
    against = compared.find_nearest_demonstration(recognizer.language.gestures, other)
    landmarks = tuple(sorted({*shown.salient, *against.salient} & {*recognizer.landmarks}))
    mirrored = bool(compared.mirrored[other])
    example = Example.of(against, landmarks, traversal, mirrored=mirrored)
    movement = build_movement(query, landmarks)
    alignment = None if example is None else align(movement, example, landmarks)
    if example is None or alignment is None:
        return None
    parted = measure_divergence(alignment, movement.paths, example.movement.paths)
    named = weigh_changes(comparison, query, against.label)
    if named:
        words = CLAUSES[named[0].kind].format(other=repr(against.label))
        if named[0].start is not None:
            words += f" at {named[0].start:.1f} s"
    else:
        words = (
            f"it is almost the same movement as {against.label!r} and differs most from "
            f"{parted.start:.1f} to {parted.end:.1f} s, when the {humanize(parted.landmark)} "
            f"{parted.shown}"
        )
    return PairDifference(words, (parted.start, parted.end), alignment)


CLAUSES: Final = {
    CauseKind.mirrored: "it is the mirror image of {other}",
    CauseKind.reversed: "it goes through {other} backwards",
    CauseKind.upside_down: "it is {other} upside down",
    CauseKind.other_arm: "it is {other} with the other arm",
    CauseKind.turned_away: "it is {other} by a diver who is turned away",
    CauseKind.too_small: "it is a smaller {other}",
    CauseKind.begun_late: "it lacks the beginning of {other}",
    CauseKind.ended_early: "it lacks the end of {other}",
    CauseKind.part_missing: "it lacks a part in the middle of {other}",
    CauseKind.part_added: "it has a part that {other} has not",
    CauseKind.demonstration: "it lacks both ends of {other}",
    CauseKind.keypoints_jumped: "its keypoints jump, otherwise it is {other}",
    CauseKind.other_person: "another body is in it, otherwise it is {other}",
}
"""What undoing one change shows of two demonstrations, as a clause."""
