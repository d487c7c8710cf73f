"""Hand shapes: the protocol on drawn hands, and on takes that are composed of them."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from app.recognition import GestureError
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.holds import find_holds
from benchmarks.accuracy.hand_shapes import ask, count
from benchmarks.figures import Figure
from benchmarks.sets.hand_shape_draws import (
    FEW,
    Composer,
    Drawn,
    Twins,
    draw_letters,
    draw_sequences,
    draw_signs,
    draw_twins,
    find_held,
    show_twins,
)
from benchmarks.sets.held_signs import RATE, HeldSigns, make_take
from benchmarks.sets.recorded_sets import RecordedSet
from benchmarks.sets.sign_sequences import compose, mirror, turn_alike
from tests.recognition.held_takes import FIST, FLAT, TWO, fingers, hold
from tests.recognition.parametric_hand import Fingers, View, hand_xy
from tests.recognition.strategies import recording, square, wedge

LETTERS = {"A": (), "B": (0, 1, 2, 3), "D": (0,), "I": (3,), "V": (0, 1), "W": (0, 1, 2)}
SIGNERS = {"one": 0.0, "two": 10.0, "three": -10.0}
SIGNS = {"stop": FLAT, "hold": FIST, "two": TWO}
CLEAR = {"stop": FLAT, "hold": FIST, "horns": fingers(0, 3), "little": fingers(2, 3)}


def figures(drawn: list[Drawn]) -> dict[str, Figure]:
    return {each.name: each for each in count(ask(drawn))}


def letters(moving: str = "") -> RecordedSet:
    """Return letters of three signers in 30 frames; one letter may move by 40 pixels a frame."""
    shown = [*product(LETTERS, SIGNERS)]
    takes = []
    for letter, signer in shown:
        hand = 40 * hand_xy(fingers(*LETTERS[letter]), View(roll=SIGNERS[signer])) + 300
        step = np.array((40, 0)) if letter == moving else np.zeros(2)
        moved = hand + np.arange(30)[:, None, None] * step
        takes.append(make_take(moved, np.arange(30) / RATE, (640, 480)))
    names, people = zip(*shown, strict=True)
    return RecordedSet("letters", takes, np.array(names), np.array(people))


def make_signs(shapes: dict[str, Fingers], views: int, takes: int) -> HeldSigns:
    made = [
        (label, view, hold(shape, roll=12.0 * view - 18, seed=7 * view + take, frames=12))
        for label, shape in shapes.items()
        for view in range(views)
        for take in range(takes)
    ]
    labels, runs, shown = zip(*made, strict=True)
    return HeldSigns(list(shown), np.array(labels), np.array(runs))


def test_every_choice_of_signers_is_asked_about_all_other_takes() -> None:
    recorded = letters()
    drawn = [*draw_letters(recorded, find_held(recorded), 2, draws=2, seed=0)]
    found = figures(drawn)
    assert (found["2/all/nearest"].value, found["2/all/nearest"].n) == (1, 3 * len(LETTERS))
    asked = [take for each in drawn for take in each.takes if take.relation == "2/foreign"]
    assert len(asked) == 3 * 2 * (len(LETTERS) - FEW)
    different = {(take.label, *take.who) for take in asked}
    assert found["2/foreign/accepted"].n == len(different)


def test_a_take_that_holds_no_shape_demonstrates_nothing_and_is_wrong() -> None:
    recorded = letters(moving="A")
    held = find_held(recorded, shapes=1)
    assert {*recorded.labels[~held]} == {"A"}
    found = figures([*draw_letters(recorded, held, 1, draws=0, seed=0)])
    assert found["1/all/nearest"].value == pytest.approx(5 / 6)


def test_clear_signs_are_right_in_every_relation_and_no_foreign_one_is_accepted() -> None:
    found = figures([*draw_signs(make_signs(SIGNS, 4, 2), draws=2, queries=8, seed=1)])
    for relation in ("same-view", "other-view", "three"):
        assert found[f"{relation}/nearest"].value == 1
    assert (found["foreign/accepted"].value, found["foreign/accepted"].n) == (0, 8)


@pytest.fixture(scope="module")
def signs() -> HeldSigns:
    """Return four signs of a hand alone, three takes in each of two views, one mirrored."""
    made = [
        (label, view, mirror(take) if view else take)
        for label, shape in CLEAR.items()
        for view in range(2)
        for number in range(3)
        for held in [hold(shape, roll=15.0 * view, seed=5 * view + number, frames=30)]
        if held.hands is not None
        for take in [replace(held, landmarks=("right_wrist",), xy=held.hands[:, 1, :1])]
    ]
    labels, runs, takes = zip(*made, strict=True)
    return turn_alike(HeldSigns(list(takes), np.array(labels), np.array(runs)))


def test_runs_are_turned_to_show_the_same_hand(signs: HeldSigns) -> None:
    for label in CLEAR:
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


def test_clear_sequences_are_right_and_no_other_one_is_accepted(signs: HeldSigns) -> None:
    drawn = [*draw_sequences(Composer(signs, np.random.default_rng(1)), draws=2)]
    found = figures(drawn)
    for view in ("same-view", "other-view"):
        assert (found[f"{view}/nearest"].value, found[f"{view}/nearest"].n) == (1, 10)
    for relation in ("other-order", "three-signs"):
        assert found[f"{relation}/in-sequence"].value == 0
    assert not any(each.in_sequence for each in ask(drawn) if each.take.relation == "alone")


def test_signs_that_are_one_shape_cannot_be_a_sequence(signs: HeldSigns) -> None:
    with pytest.raises(GestureError, match="no take of hold, hold shows 2 shapes"):
        Composer(signs, np.random.default_rng(1)).define(("hold", "hold"))


@pytest.fixture(scope="module")
def composer() -> Composer:
    """Return a composer of two people's movements, and three signs in two views."""
    movements = [
        (label, person, recording(path, jitter=0.01, seed=seed, landmarks=("right_wrist",)))
        for label, path in {"square": square, "wedge": wedge}.items()
        for person in ("one", "other")
        for seed in range(4)
    ]
    names, people, recordings = zip(*movements, strict=True)
    recorded = RecordedSet("drawn", list(recordings), np.array(names), np.array(people))
    return Composer(make_signs(SIGNS, 2, 3), np.random.default_rng(1), recorded)


@pytest.fixture(scope="module")
def twins(composer: Composer) -> Twins:
    return draw_twins(composer, movements=2)


def test_hands_tell_twins_apart_only_where_the_switch_is_on(
    composer: Composer, twins: Twins
) -> None:
    takes = [*show_twins(composer, twins, queries=4)]
    found = figures([Drawn(twins.teach("on"), takes)])
    for who, view in product(("same", "another"), ("same-view", "other-view")):
        figure = found[f"{who}/{view}/nearest"]
        assert (figure.value, figure.n) == (1, 4)
    assert (found["foreign/accepted"].value, found["foreign/accepted"].n) == (0, 8)
    off = figures([Drawn(twins.teach("off"), takes)])
    assert off["same/same-view/nearest"].value < 1
    assert tuple(twins.labels[:2]) in twins.teach("auto").undecided_twins


def test_hands_that_nobody_means_change_no_answer(composer: Composer, twins: Twins) -> None:
    seen, blind = twins.teach("auto"), twins.teach("auto", see_hands=False)
    for _ in range(3):
        poses = composer.carry_any()
        unseen = blind.recognize(replace(poses, hands=None))
        assert seen.recognize(poses).to_dict() == unseen.to_dict()
