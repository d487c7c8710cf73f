"""Moving shapes: the protocol on composed takes of movements and hands made here."""

from __future__ import annotations

import numpy as np
import pytest

from app.evaluation.share import Share
from benchmarks.accuracy.hands.moving_shapes import (
    Answer,
    Composer,
    Draw,
    answer,
    count_same,
    draw,
    report,
)
from benchmarks.sets.held_signs import HeldSigns
from benchmarks.sets.recorded_sets import RecordedSet
from tests.recognition.held_takes import FIST, FLAT, TWO, hold
from tests.recognition.strategies import recording, square, wedge

SIGNS = {"stop": FLAT, "hold": FIST, "two": TWO}
MOVEMENTS = {"square": square, "wedge": wedge}
TOLD = [f"{who} person, {view} view" for who in ("same", "other") for view in ("same", "other")]


@pytest.fixture(scope="module")
def composer() -> Composer:
    """Return a composer of two people's movements, and three signs in two views."""
    movements = [
        (label, person, recording(path, jitter=0.01, seed=seed, landmarks=("right_wrist",)))
        for label, path in MOVEMENTS.items()
        for person in ("one", "other")
        for seed in range(4)
    ]
    names, people, recordings = zip(*movements, strict=True)
    hands = [
        (label, view, hold(shape, roll=10.0 * view, seed=7 * view + take, frames=12))
        for label, shape in SIGNS.items()
        for view in range(2)
        for take in range(3)
    ]
    labels, runs, takes = zip(*hands, strict=True)
    return Composer(
        RecordedSet("drawn", list(recordings), np.array(names), np.array(people)),
        HeldSigns(list(takes), np.array(labels), np.array(runs)),
        np.random.default_rng(1),
    )


@pytest.fixture(scope="module")
def drawn(composer: Composer) -> Draw:
    found = draw(composer, count=2)
    assert found is not None
    return found


@pytest.fixture(scope="module")
def answers(composer: Composer, drawn: Draw) -> list[Answer]:
    return [*answer(composer, drawn, queries=4)]


def test_clear_shapes_are_right_in_every_relation(answers: list[Answer]) -> None:
    for relation in TOLD:
        own = [each for each in answers if each.relation == relation]
        assert len(own) == 4
        assert all(each.asked and each.right for each in own)


def test_without_the_switch_the_movement_does_not_tell(answers: list[Answer]) -> None:
    plain = [each.right for each in answers if each.relation == "switch off"]
    assert not all(plain)


def test_foreign_shapes_are_refused(answers: list[Answer]) -> None:
    foreign = [each for each in answers if each.relation == "foreign"]
    assert len(foreign) == 8
    assert not any(each.accepted for each in foreign)


def test_hands_that_nobody_means_change_no_answer(composer: Composer, drawn: Draw) -> None:
    assert count_same(composer, drawn, queries=3) == Share(3, 3)


def test_the_report_names_every_relation_and_pair(answers: list[Answer]) -> None:
    lines = [*report(answers, {"languages": Share(1, 1)})]
    for name in (*TOLD, "foreign", "no hand", " and ".join(sorted(answers[0].signs))):
        assert any(line.startswith(f"| {name} |") for line in lines)
    assert any(line.startswith("languages: ") for line in lines)
