"""Hand shapes: the protocol on takes of held hands made here, and the report's lines."""

import numpy as np
import pytest

from benchmarks.accuracy.hands.held_shapes import RELATIONS, Answer, answer, report
from benchmarks.sets.held_signs import HeldSigns
from tests.recognition.held_takes import FIST, FLAT, TWO, hold

SHAPES = {"stop": FLAT, "hold": FIST, "two": TWO}


@pytest.fixture(scope="module")
def answers() -> list[Answer]:
    """Return answers on three signs, two takes in each of four views."""
    made = [
        (label, view, hold(shape, roll=12.0 * view - 18, seed=7 * view + take, frames=12))
        for label, shape in SHAPES.items()
        for view in range(4)
        for take in range(2)
    ]
    labels, runs, takes = zip(*made, strict=True)
    signs = HeldSigns(list(takes), np.array(labels), np.array(runs))
    return [*answer(signs, draws=2, queries=8, seed=1)]


def test_clear_shapes_are_right_in_every_relation(answers: list[Answer]) -> None:
    for relation in RELATIONS:
        own = [each for each in answers if each.relation == relation]
        assert own
        assert all(each.right for each in own)


def test_foreign_shapes_are_never_right_and_farther(answers: list[Answer]) -> None:
    foreign = [each.novelty for each in answers if each.relation == "foreign"]
    assert len(foreign) == 8
    assert min(foreign) > max(each.novelty for each in answers if each.relation == "same view")


def test_the_report_names_every_relation_and_sign(answers: list[Answer]) -> None:
    lines = [*report(answers, takes=24, found=24)]
    for name in (*RELATIONS, *SHAPES):
        assert any(line.startswith(f"| {name} |") for line in lines)
