"""Transcripts: strokes that are compared and told."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.recognition.explanation.strokes import transcribe, transcribe_gesture
from app.recognition.explanation.transcript import (
    Transcript,
    compare_transcripts,
    describe_strokes,
    say_line,
    tell_transcript,
)
from app.recognition.features.traversals import AS_SHOWN, Traversal
from tests.recognition.explanation.test_strokes import SQUARE, TABLE, draw, hand


def tell(transcript: Transcript, label: str) -> str:
    """Return a transcript as a sentence tells it."""
    return " ".join(f"{say_line(line)}." for line in tell_transcript(transcript, label))


def test_a_long_movement_is_told_up_to_where_it_differs() -> None:
    zigzag = [(0.5 * (step % 2), 0.2 * step) for step in range(14)]
    shown = transcribe(hand(draw(*zigzag)))
    told = tell(compare_transcripts(shown, shown[:3]), "zigzag")
    assert ", then 6 more. 'zigzag': " in told
    late = compare_transcripts(shown, (*shown[:9], replace(shown[9], direction=90.0)))
    assert late.differs == 9
    assert ", then 3 more. 'zigzag': " in tell(late, "zigzag")


def test_the_hand_is_named_where_the_gesture_uses_both() -> None:
    shown = transcribe(hand(draw((0, 0), (1, 0))))
    both = (*transcribe(hand(draw((0, 0), (0, 1)), "left_wrist")), *shown)
    told = tell(compare_transcripts(shown, both), "both")
    assert told == "You showed: right hand right. 'both': left hand down; right hand right."


def test_two_hands_are_told_together_where_they_do_the_same() -> None:
    path = draw((0, 0), (0, 1), (0, 0))
    both = hand(path)
    both = replace(
        both,
        landmarks=("left_wrist", "right_wrist"),
        xy=np.concatenate([both.xy, both.xy + 1.0], axis=1),
    )
    assert describe_strokes(transcribe(both)) == "both hands down, up"


def test_the_first_stroke_that_differs_is_found() -> None:
    shown = transcribe(hand(draw((0, 0), (0.5, 1), (1, 0))))
    expected = transcribe_gesture(TABLE.gesture("triangle"))
    found = compare_transcripts(shown, expected)
    assert found.differs == 0
    assert tell(found, "triangle") == (
        "You showed: down right, up right. 'triangle': down left, right, up left."
    )


def test_a_closed_figure_may_begin_at_any_of_its_strokes() -> None:
    shown = transcribe(hand(draw(*SQUARE[1:], SQUARE[1])))
    expected = transcribe(hand(draw(*SQUARE)))
    assert compare_transcripts(shown, expected).differs == 0
    assert (
        compare_transcripts(shown, expected, Traversal(np.roll(AS_SHOWN.order, 8))).differs is None
    )


def test_an_unfinished_figure_differs_where_it_ends() -> None:
    shown = transcribe(hand(draw(*SQUARE[:4])))
    found = compare_transcripts(shown, transcribe(hand(draw(*SQUARE))))
    assert found.differs == 3
