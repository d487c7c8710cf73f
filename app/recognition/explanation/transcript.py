"""Transcripts: the strokes of a take and of the gesture that was expected, compared and told.

A recording has one transcript, whatever it is compared with. What is told is chosen here; the page
draws it.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from app.recognition.decision.result import WRITTEN
from app.recognition.explanation.strokes import Piece
from app.recognition.features.motion import STEPS, parse_body_part
from app.recognition.features.traversals import AS_SHOWN, Traversal

MOST_TOLD: Final = 7
"""Most pieces that a sentence tells of a movement, unless it first differs later."""


@dataclass(frozen=True, kw_only=True)
class Transcript:
    """A take and the gesture that was expected, stroke by stroke.

    Attributes
    ----------
    shown, expected
        The pieces of both, hand after hand, in seconds of the take's and of the demonstration's
        clock, each from where its hand begins.
    differs, differs_in_expected
        Indices of the first piece that differs, one past the last where one of both ends before;
        None where none does.
    bridged
        Seconds of the take at which a hand jumped, so that its path is a straight line there.

    """

    __pydantic_config__ = WRITTEN

    shown: tuple[Piece, ...]
    expected: tuple[Piece, ...]
    differs: int | None
    differs_in_expected: int | None
    bridged: tuple[float, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Words:
    """Words of a line that tells strokes.

    Attributes
    ----------
    text
        The words, with what separates them from those before.
    start
        Second of the take at which the stroke begins; None for other words.
    differs
        Whether it is the first stroke that differs.
    bridged
        Whether the hand jumped meanwhile, so that a part of the stroke is not seen.
    folded
        Strokes behind a fold, of which `text` tells the number.

    """

    __pydantic_config__ = WRITTEN

    text: str
    start: float | None = None
    differs: bool = False
    bridged: bool = False
    folded: tuple[Words, ...] = ()


Line = tuple[Words, ...]


def describe_strokes(pieces: Sequence[Piece]) -> str:
    """Return strokes in words; of two hands, one after the other."""
    named = len(_group_by_hand(pieces)) > 1
    return say_line(_tell_strokes(pieces, named=named, most=2 * len(pieces)))


def compare_transcripts(
    shown: Sequence[Piece],
    expected: Sequence[Piece],
    traversal: Traversal = AS_SHOWN,
    bridged: Sequence[float] = (),
) -> Transcript:
    """Compare the strokes of a take with those of a gesture.

    Parameters
    ----------
    shown, expected
        Strokes of the take and of the gesture.
    traversal
        The one in which the gesture is nearest to the take: a closed one may begin at any stroke.
    bridged
        See `Transcript`.

    """
    starts = [0]
    if traversal.order[0] not in (0, STEPS - 1) and len(_group_by_hand(expected)) == 1:
        starts = [*range(len(expected))]
    alike, back = max((_count_alike(shown, (*expected[at:], *expected[:at])), -at) for at in starts)
    whole = alike == len(shown) == len(expected)
    meets = len(expected) if alike == len(expected) else (alike - back) % max(1, len(expected))
    return Transcript(
        shown=tuple(shown),
        expected=tuple(expected),
        differs=None if whole else alike,
        differs_in_expected=None if whole else meets,
        bridged=tuple(bridged),
    )


def are_alike(one: Sequence[Piece], other: Sequence[Piece]) -> bool:
    """Return whether two movements have the same strokes, as many and none that differs."""
    return _count_alike(one, other) == len(one) == len(other)


def _count_alike(shown: Sequence[Piece], expected: Sequence[Piece]) -> int:
    """Return how many pieces agree before the first one that differs."""
    pairs = zip(shown, expected, strict=False)
    return len([*itertools.takewhile(lambda pair: not pair[0].differs(pair[1]), pairs)])


def _group_by_hand(pieces: Sequence[Piece]) -> dict[str, list[Piece]]:
    rows: dict[str, list[Piece]] = {}
    for piece in pieces:
        rows.setdefault(piece.hand, []).append(piece)
    return rows


def tell_transcript(transcript: Transcript, label: str) -> tuple[Line, ...]:
    """Return what was shown and what was expected, a line each."""
    shown, expected, differs = transcript.shown, transcript.expected, transcript.differs
    named = len(_group_by_hand((*shown, *expected))) > 1
    told = _tell_strokes(shown, differs, named=named, bridged=transcript.bridged)
    if shown and expected and differs is None:
        return ((Words(text=f"You showed the strokes of {label!r}: "), *told),)
    first = (Words(text="You showed: "), *told)
    second = _tell_strokes(expected, transcript.differs_in_expected, named=named)
    return (
        first if shown else (Words(text="No movement of a hand was seen"),),
        (Words(text=f"{label!r}: "), *second)
        if expected
        else (Words(text=f"{label!r} is a held hand shape"),),
    )


def say_line(line: Line) -> str:
    """Return a line in words."""
    return "".join(each.text for each in line)


def _tell_strokes(
    pieces: Sequence[Piece],
    differs: int | None = None,
    *,
    named: bool,
    bridged: Sequence[float] | None = None,
    most: int = MOST_TOLD,
) -> Line:
    """Tell strokes, hand after hand; at most `most` before the fold, and the first that differs.

    `bridged` is given for a take, see `Transcript`.
    """
    marked = pieces[differs] if differs is not None and differs < len(pieces) else None
    sides = {
        f"{parse_body_part(hand).partition('_')[0]} hand ": row
        for hand, row in _group_by_hand(pieces).items()
    }
    rows = list(sides.items())
    if len(rows) == 2 and not marked:
        one, other = ([piece.words for piece in row] for row in sides.values())
        rows = [("both hands ", rows[0][1])] if one == other else rows
    line: list[Words] = []
    for name, row in rows:
        line += [Words(text="; ")] if line else []
        line += [Words(text=name)] if named else []
        until = most // len(rows)
        if marked in row:
            until = max(until, row.index(marked) + 1)
        told = [
            (
                *([Words(text=", ")] if index else []),
                Words(
                    text=piece.words,
                    start=None if bridged is None else piece.start,
                    differs=piece is marked,
                    bridged=any(piece.start <= each <= piece.end for each in bridged or ()),
                ),
            )
            for index, piece in enumerate(row)
        ]
        line += itertools.chain(*told[:until])
        if folded := told[until:]:
            behind = tuple(itertools.chain(*folded))
            line.append(Words(text=f", then {len(folded)} more", folded=behind))
    return (*line, Words(text=" (ends)", differs=True)) if differs == len(pieces) else tuple(line)
