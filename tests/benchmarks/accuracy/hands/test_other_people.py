"""The benchmark of other people's hand shapes, on drawn letters of three signers."""

from __future__ import annotations

from itertools import product

import numpy as np

from app.recognition import PoseSequence
from benchmarks.accuracy.hands.other_people import (
    LANGUAGE,
    TURNS,
    Letters,
    answer,
    report,
    report_choices,
    report_nested,
)
from benchmarks.sets.held_signs import RATE, HandLetters, make_take
from tests.recognition.held_takes import fingers
from tests.recognition.parametric_hand import View, hand_xy

SHAPES = {"A": (), "B": (0, 1, 2, 3), "D": (0,), "I": (3,), "V": (0, 1), "W": (0, 1, 2)}
SIGNERS = {"one": 0.0, "two": 10.0, "three": -10.0}


def show(stretched: tuple[int, ...], roll: float, step: tuple[float, float]) -> PoseSequence:
    """Return a take of 30 frames in which a hand moves by `step` pixels a frame."""
    hand = 40 * hand_xy(fingers(*stretched), View(roll=roll)) + 300
    moved = hand + np.arange(30)[:, None, None] * np.array(step)
    return make_take(moved, np.arange(30) / RATE, (640, 480))


def letters(moving: str = "") -> Letters:
    shown = [*product(SHAPES, SIGNERS)]
    takes = [
        show(SHAPES[letter], SIGNERS[signer], (40, 0) if letter == moving else (0, 0))
        for letter, signer in shown
    ]
    return Letters(
        HandLetters(takes, np.array([a for a, _ in shown]), np.array([s for _, s in shown]))
    )


def test_every_choice_of_signers_is_asked_for_all_other_takes() -> None:
    whole, some = answer(letters(), 2, draws=2, seed=0)
    assert len(whole) == 3 * len(SHAPES)
    assert all(each.right and each.known for each in whole)
    assert sum(not each.known for each in some) == 3 * 2 * (len(SHAPES) - LANGUAGE)
    assert all(not each.right for each in some if not each.known)


def test_a_take_that_holds_no_shape_is_named_and_wrong() -> None:
    made = letters(moving="A")
    assert [line.split(":")[0] for line in made.refused] == [f"A of {name}" for name in SIGNERS]
    whole, _ = answer(made, 1, draws=0, seed=0)
    assert not any(each.right for each in whole if each.letter == "A")
    assert all(each.right for each in whole if each.letter != "A")


def test_the_report_has_a_row_and_the_nested_limit() -> None:
    (row,) = report(letters(), 1, draws=2, seed=0)
    assert row.startswith("| 1 | 36 | 100.0% (90%-100%) | ")
    (line,) = report_nested(letters(), draws=2, seed=0)
    assert "out-of-vocabulary accepted" in line


def test_every_choice_of_voters_and_turn_is_measured() -> None:
    *rows, nested = report_choices(letters())
    assert len(rows) == 2 + 7 * len(TURNS)
    assert nested == "nearest right with the nested choices: 100.0% (90%-100%)"
