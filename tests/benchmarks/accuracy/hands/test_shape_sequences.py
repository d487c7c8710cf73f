"""Shape sequences: the protocol on takes of held hands made here, and the report's lines."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.recognition import GestureError, PoseSequence
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.holds import find_holds
from benchmarks.accuracy.hands.shape_sequences import (
    ALONE,
    FOREIGN,
    FOUND_OF,
    MEANT,
    Answer,
    Composer,
    answer,
    count_shapes,
    report,
)
from benchmarks.sets.held_signs import HeldSigns
from benchmarks.sets.sign_sequences import compose, mirror, turn_alike
from tests.recognition.held_takes import FIST, FLAT, fingers, hold

SHAPES = {"stop": FLAT, "hold": FIST, "horns": fingers(0, 3), "little": fingers(2, 3)}


def keep_hand(take: PoseSequence) -> PoseSequence:
    """Return a take of a hand alone, as the recorded ones are."""
    assert take.hands is not None
    return replace(take, landmarks=("right_wrist",), xy=take.hands[:, 1, :1])


@pytest.fixture(scope="module")
def signs() -> HeldSigns:
    """Return four signs, three takes in each of two views, of which one is mirrored."""
    made = [
        (label, view, mirror(take) if view else take)
        for label, shape in SHAPES.items()
        for view in range(2)
        for number in range(3)
        for take in [keep_hand(hold(shape, roll=15.0 * view, seed=5 * view + number, frames=30))]
    ]
    labels, runs, takes = zip(*made, strict=True)
    return turn_alike(HeldSigns(list(takes), np.array(labels), np.array(runs)))


@pytest.fixture(scope="module")
def answers(signs: HeldSigns) -> list[Answer]:
    return [*answer(Composer(signs, np.random.default_rng(1)), draws=2)]


def test_runs_are_turned_to_show_the_same_hand(signs: HeldSigns) -> None:
    for label in SHAPES:
        shown = []
        for take in np.flatnonzero(signs.labels == label):
            poses = signs.takes[take]
            (only,) = find_holds(poses, Trajectory.from_poses(poses))
            shown.append(only.hands[0].xy)
        assert np.abs(shown[0] - shown[-1]).max() < np.abs(shown[0] * (-1, 1) - shown[-1]).max()


def test_a_composed_take_stays_at_one_place_and_shows_its_signs(signs: HeldSigns) -> None:
    for seed in range(6):
        poses = compose([signs.takes[0], signs.takes[6]], np.random.default_rng(seed))
        assert poses.hands is not None
        wrist = poses.hands[:, 1, 0]
        assert np.ptp(wrist[np.isfinite(wrist).all(axis=1)], axis=0).max() < 20
        assert len(find_holds(poses, Trajectory.from_poses(poses))) == 2


def test_clear_sequences_are_right_and_no_other_one_is_accepted(answers: list[Answer]) -> None:
    for relation in MEANT:
        own = [each for each in answers if each.relation == relation]
        assert len(own) == 10
        assert all(each.right for each in own)
    for relation in (FOREIGN[0], FOREIGN[3], ALONE):
        assert not any(each.sequence for each in answers if each.relation == relation)


def test_signs_that_are_one_shape_cannot_be_a_sequence(signs: HeldSigns) -> None:
    with pytest.raises(GestureError, match="no take of hold, hold shows 2 shapes"):
        Composer(signs, np.random.default_rng(1)).define(("hold", "hold"))


def test_the_report_names_every_relation(signs: HeldSigns, answers: list[Answer]) -> None:
    counts = [*count_shapes(Composer(signs, np.random.default_rng(1)))]
    assert len(counts) == len(SHAPES) * (len(SHAPES) - 1) * FOUND_OF
    lines = [*report(answers, counts)]
    for name in (*MEANT, *FOREIGN, ALONE):
        assert any(line.startswith(f"| {name} |") for line in lines)
