"""Alignments: the corresponding steps of a query and a gesture, and how two gestures differ.

An `Alignment` holds the DTW path and its costs, a `PairDifference` how and when the demonstrations
of two gestures differ.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydantic import BaseModel, ConfigDict

from app.recognition.decision.result import WRITTEN
from app.recognition.explanation.causes import prove_change, tell_change
from app.recognition.explanation.strokes import Piece, transcribe_gesture
from app.recognition.explanation.transcript import compare_transcripts
from app.recognition.explanation.undoing import compare_with
from app.recognition.features.motion import build_movement, find_hands
from app.recognition.features.traversals import Traversal, list_traversals
from app.recognition.gestures.demonstration import condense
from app.recognition.gestures.gesture import Gesture
from app.recognition.matching.dtw import BAND, dtw_pairs
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.recognizer import Recognizer
from app.recognition.text.described import DESCRIBED
from app.recognition.voters.motion_voters import Path

DIGITS = 4
"""Decimals of costs and seconds in JSON: a tenth of a millisecond."""


Places = list[list[tuple[float, float]]]


class Alignment(BaseModel):
    """The best DTW alignment of a query's path with a gesture's; rounded in JSON."""

    model_config = ConfigDict(**DESCRIBED, **WRITTEN)

    label: str
    """The gesture's."""
    voter: str = Path.name
    """``path``, whose distance it is."""
    parts: tuple[str, ...]
    """P landmarks."""
    pairs: list[tuple[int, int]]
    """S corresponding steps of the take and of the gesture."""
    time: list[float]
    """Seconds in the take's clock of each of its steps."""
    gesture_time: list[float]
    """Seconds in the demonstration of each of the gesture's steps."""
    query: Places
    """Step by step and part by part the take's position relative to its mean, x right and y down,
    in sizes of the gesture: the costs are the distances between corresponding positions, divided by
    the number of steps."""
    gesture: Places
    """The same of the gesture."""
    costs: list[list[float]]
    """Per pair and part, >= 0; their sum is `distance`."""
    distance: float
    """The voter's distance, in its unit."""
    backward: bool
    """Whether the gesture is traversed backwards."""
    mirrored: bool
    """Whether it is the gesture's mirror image."""
    demonstration: int = 0
    """Which of the gesture's demonstrations it is, from 0."""


def align(
    query: Trajectory,
    gesture: Gesture,
    landmarks: Sequence[str],
    traversal: Traversal | None,
    *,
    mirrored: bool = False,
    start: float = 0.0,
    demonstration: int = 0,
) -> Alignment | None:
    """Align a query with a gesture.

    Parameters
    ----------
    query
        The query.
    gesture
        With the demonstration that it is aligned with.
    landmarks
        Names of the landmarks.
    traversal
        The one of the gesture; None: the one whose path is nearest to the query's.
    mirrored
        Whether to align with the gesture's mirror image.
    start
        Second of the query's clock at which its movement begins.
    demonstration
        Which of the gesture's demonstrations it is, from 0.

    Returns
    -------
    None where one of the two has no movement.

    """
    trajectory = (gesture.mirror() if mirrored else gesture).trajectory
    if trajectory is None or gesture.is_held or min(len(trajectory), len(query)) < 2:
        return None
    moved, whole = build_movement(query, landmarks), build_movement(trajectory, landmarks)
    read = Path().describe(moved)
    if traversal is None:
        open_to = list_traversals(whole, hands=find_hands(gesture.salient), both_ways=True)
        ways = np.stack([Path().describe(whole.reorder(each.order)) for each in open_to])
        traversal = open_to[int(Path().distances(read, ways).argmin())]
    shown = whole.reorder(traversal.order)
    pairs = dtw_pairs(read, Path().describe(shown), BAND)
    apart = moved.figure[pairs[:, 0]] - shown.figure[pairs[:, 1]]
    # A step's distance is the root of its squares, of which each part has its share.
    squares = (apart**2).sum(axis=2)
    costs = squares / np.sqrt(np.maximum(squares.sum(axis=1, keepdims=True), 1e-12)) / len(read)
    return Alignment(
        label=gesture.label,
        parts=tuple(landmarks),
        pairs=pairs.tolist(),
        time=_round(start + moved.reached),
        gesture_time=_round(whole.reached[traversal.order]),
        query=_round(moved.figure),
        gesture=_round(shown.figure),
        costs=_round(costs),
        distance=_round(costs.sum()),
        backward=traversal.backward,
        mirrored=mirrored,
        demonstration=demonstration,
    )


def _round(values: FloatArray) -> Any:
    """Round for JSON."""
    return np.round(values, DIGITS).tolist()


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
    alignment = align(query, against, landmarks, traversal, mirrored=mirrored)
    if alignment is None:
        return None
    theirs = compared.find_shown_demonstration(recognizer.language.gestures, other)
    expected = transcribe_gesture(theirs)
    strokes = compare_transcripts(transcribe_gesture(shown), expected, traversal)
    words, span = f"it has the strokes of {against.label!r}", (0.0, float(query.time[-1]))
    if strokes.differs is not None:
        mine, yours = (
            row[at] if at is not None and at < len(row) else None
            for row, at in (
                (strokes.shown, strokes.differs),
                (strokes.expected, strokes.differs_in_expected),
            )
        )
        words = f"it {describe_act(mine)} where {against.label!r} {describe_act(yours)}"
        span = (mine.start, mine.end) if mine else (strokes.shown[-1].end, strokes.shown[-1].end)
    if proven := prove_change(comparison):
        told = tell_change(proven, against.label).partition(". ")[0]
        words = (
            told.replace("The take", "it", 1) if "The take" in told else told[0].lower() + told[1:]
        )
    return PairDifference(words, span, alignment)


def describe_act(piece: Piece | None) -> str:
    """Return what a diver does, as a predicate: "goes left", "draws a clockwise loop".

    None: the movement has ended before this piece.
    """
    if piece is None:
        return "has ended"
    match piece.kind:
        case "pause":
            return "pauses"
        case "line":
            return f"goes {piece.words}"
        case "arc" | "loop" if not piece.words[0].isdigit():
            return f"draws {'an' if piece.turn < 0 else 'a'} {piece.words}"
        case _:
            return f"draws {piece.words}"
