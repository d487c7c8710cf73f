"""Pair differences: the differences of two demonstrations, in words and in seconds."""

import numpy as np
import pytest

from app.recognition import Gesture, Language, Recognizer
from app.recognition.explanation.alignment import compare_pair, describe_act
from app.recognition.explanation.strokes import Piece, PieceKind
from app.recognition.poses.sequence import FloatArray
from tests.recognition.demonstrations import pool, shown
from tests.recognition.strategies import circle, line


def ell(share: FloatArray) -> FloatArray:
    """Go right like a line, then down."""
    corners = np.array([[-1.2, 0.0], [-0.2, 0.0], [-0.2, 0.8]])
    at = np.array([0.0, 0.5, 1.0])
    return np.stack([np.interp(share, at, corners[:, axis]) for axis in range(2)], axis=1)


def test_what_only_one_of_them_does_is_told_with_its_time() -> None:
    recognizer = Recognizer(pool(line=line, ell=ell, circle=circle), "full")
    found = compare_pair(recognizer, 1, 0)
    assert found is not None
    assert "'line'" in found.words
    start, end = found.stroke
    assert start >= 0.4
    assert end > start


def test_without_a_demonstration_there_is_nothing_to_compare() -> None:
    imported = Gesture(label="old", salient=("right_wrist",), image=shown("line", line).image)
    recognizer = Recognizer(Language("mixed", [shown("circle", circle), imported]), "full")
    assert compare_pair(recognizer, 1, 0) is None
    assert compare_pair(recognizer, 0, 1) is None


@pytest.mark.parametrize(
    ("kind", "turn", "direction", "act"),
    [
        ("line", 0.0, 180.0, "goes left"),
        ("pause", 0.0, None, "pauses"),
        ("arc", 120.0, 90.0, "draws a clockwise arc down"),
        ("arc", -120.0, 0.0, "draws an anticlockwise arc right"),
        ("loop", 350.0, None, "draws a clockwise loop"),
        ("loop", -720.0, None, "draws 2 anticlockwise loops"),
        ("curve", 0.0, None, "draws a curve"),
        ("curve", 90.0, 0.0, "draws a curve right"),
    ],
)
def test_what_a_piece_does_is_a_predicate(
    kind: PieceKind, turn: float, direction: float | None, act: str
) -> None:
    piece = Piece(kind=kind, hand="right_wrist", direction=direction, turn=turn, start=0.0, end=1.0)
    assert describe_act(piece) == act
    assert describe_act(None) == "has ended"
