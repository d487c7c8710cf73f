"""Traversals: the orders in which a figure may be drawn."""

import numpy as np

from app.recognition.features.motion import STEPS, Movement, build_movement
from app.recognition.features.traversals import (
    AS_SHOWN,
    BACKWARD_PENALTY,
    SIDES_EXCHANGED,
    STARTS,
    is_closed,
    list_traversals,
)
from app.recognition.poses.trajectory import Trajectory
from tests.recognition.strategies import Shape, circle, line, recording, square, wedge


def moved(shape: Shape) -> Movement:
    return build_movement(Trajectory.from_poses(recording(shape)), ("right_wrist",))


def to_and_fro(share: np.ndarray) -> np.ndarray:
    return line(1 - np.abs(2 * share - 1))


def test_only_what_encloses_something_is_closed() -> None:
    assert is_closed(moved(circle))
    assert is_closed(moved(square))
    assert not is_closed(moved(wedge))
    assert not is_closed(moved(to_and_fro))


def test_a_closed_figure_begins_anywhere_and_an_open_one_at_its_ends() -> None:
    assert len(list_traversals(moved(circle), hands=1, both_ways=True)) == 2 * STARTS
    assert len(list_traversals(moved(circle), hands=1, both_ways=False)) == STARTS
    assert len(list_traversals(moved(line), hands=1, both_ways=True)) == 2
    assert list_traversals(moved(line), hands=1, both_ways=False) == (AS_SHOWN,)


def test_figures_of_two_hands_are_read_as_shown() -> None:
    assert list_traversals(moved(circle), hands=2, both_ways=True) == (AS_SHOWN,)


def test_sides_may_have_been_exchanged_where_both_take_part() -> None:
    asked = list_traversals(moved(circle), hands=2, both_ways=True, either_side=True)
    assert asked == (AS_SHOWN, SIDES_EXCHANGED)
    assert SIDES_EXCHANGED.penalty > AS_SHOWN.penalty


def test_every_reading_takes_every_step_once_and_only_turning_round_costs() -> None:
    for traversal in list_traversals(moved(circle), hands=1, both_ways=True):
        assert sorted(traversal.order) == list(range(STEPS))
        step = (traversal.order[1] - traversal.order[0]) % STEPS
        assert traversal.backward == (step == STEPS - 1)
        assert traversal.penalty == (BACKWARD_PENALTY if traversal.backward else 1.0)
