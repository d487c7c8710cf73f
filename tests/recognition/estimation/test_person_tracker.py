"""One person is followed, whoever else is in the picture."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.estimation.person_tracker import PATIENCE_SECONDS, PersonTracker, find_boxes
from app.recognition.poses.sequence import FloatArray

BOTH = np.array([0.9, 0.9])


def people(*centres: float, widths: tuple[float, ...] = (100.0, 60.0)) -> FloatArray:
    return np.array(
        [
            [[x - width / 2, 0.0], [x + width / 2, 2 * width]]
            for x, width in zip(centres, widths, strict=True)
        ]
    )


def test_the_larger_of_two_is_followed() -> None:
    assert PersonTracker().choose(people(100, 400), BOTH, 0.0) == 0
    assert PersonTracker().choose(people(100, 400, widths=(60, 100)), BOTH, 0.0) == 1


def test_of_two_as_large_the_surer_one_is_followed() -> None:
    same = people(100, 400, widths=(80, 80))
    assert PersonTracker().choose(same, np.array([0.4, 0.8]), 0.0) == 1


@pytest.mark.withstands(row="H11")
def test_whoever_was_followed_stays_it_when_another_comes_nearer() -> None:
    choice = PersonTracker()
    choice.choose(people(100, 400), BOTH, 0.0)
    assert choice.choose(people(400, 105, widths=(300, 100)), BOTH, 0.1) == 1


def test_nobody_is_taken_for_the_one_who_is_out_of_sight_for_a_moment() -> None:
    choice = PersonTracker()
    choice.choose(people(100, 400), BOTH, 0.0)
    assert choice.choose(people(400, widths=(100,)), BOTH[:1], PATIENCE_SECONDS / 2) is None
    assert choice.choose(people(400, widths=(100,)), BOTH[:1], 2 * PATIENCE_SECONDS) == 0


def test_after_a_reset_the_larger_one_is_followed_again() -> None:
    choice = PersonTracker()
    choice.choose(people(100, 400), BOTH, 0.0)
    choice.reset()
    assert choice.choose(people(400, 100, widths=(300, 100)), BOTH, 0.1) == 0


def test_in_an_empty_picture_there_is_nobody() -> None:
    assert PersonTracker().choose(np.empty((0, 2, 2)), np.empty(0), 0.0) is None


@given(st.lists(st.booleans(), min_size=2, max_size=20))
def test_two_people_who_stand_still_never_take_turns(exchanged: list[bool]) -> None:
    choice = PersonTracker()
    boxes = people(100, 400, widths=(80, 80))
    followed = []
    for index, turned in enumerate(exchanged):
        order = [1, 0] if turned else [0, 1]
        chosen = choice.choose(boxes[order], BOTH, index / 30)
        assert chosen is not None
        followed.append(order[chosen])
    assert len(set(followed)) == 1


def test_a_box_holds_what_is_seen_of_a_person() -> None:
    xy = np.array([[[1.0, 5.0], [np.nan, np.nan], [3.0, 2.0]]])
    np.testing.assert_array_equal(find_boxes(xy), [[[1.0, 2.0], [3.0, 5.0]]])
