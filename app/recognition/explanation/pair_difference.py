"""Pair difference: how and when the demonstrations of two gestures differ."""

from __future__ import annotations

from dataclasses import dataclass

from app.recognition.explanation.alignment import Alignment, align
from app.recognition.explanation.causes import prove_change, tell_change
from app.recognition.explanation.strokes import Piece, transcribe_gesture
from app.recognition.explanation.transcript import compare_transcripts
from app.recognition.explanation.undoing import compare_with
from app.recognition.gestures.demonstration import condense
from app.recognition.recognizer import Recognizer


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
