"""One person is followed, whoever else is in the picture, and people are told apart."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.estimation.person_tracker import (
    PATIENCE_SECONDS,
    REUNION_SECONDS,
    Exchange,
    PeopleTracks,
    PersonTracker,
    find_boxes,
)
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


def at(x: float, width: float = 100.0) -> FloatArray:
    """Return the keypoints of a person at a place: the corners of a box and its middle."""
    box = people(x, 0, widths=(width, 1))[0]
    return np.vstack([box, box.mean(axis=0)])


def test_people_keep_their_numbers_in_any_order() -> None:
    tracks = PeopleTracks()
    assert tracks.assign([at(100), at(400)], 0.0) == (0, 1)
    assert tracks.assign([at(405), at(102)], 0.1) == (1, 0)
    assert tracks.assign([], 0.2) == ()
    assert tracks.assign([at(100), at(800), at(410)], 0.3) == (0, 2, 1)


def test_who_was_hidden_is_known_again_at_the_same_place_for_a_while() -> None:
    tracks = PeopleTracks()
    tracks.assign([at(100), at(400)], 0.0)
    tracks.assign([at(100)], 1.0)
    assert tracks.assign([at(100), at(400)], REUNION_SECONDS) == (0, 1)
    assert tracks.assign([at(400)], 3 * REUNION_SECONDS) == (2,)
    assert tracks.alive == {2}


def test_who_comes_back_beside_the_place_is_known_unless_of_another_size() -> None:
    tracks = PeopleTracks()
    tracks.assign([at(100)], 0.0)
    assert tracks.assign([at(200)], 1.0) == (0,)
    assert tracks.assign([at(250, width=300)], 2.0) == (1,)


def test_a_track_that_went_with_a_passer_by_returns_to_who_stayed() -> None:
    """A near diver passes in front of another one, and takes the track along."""
    tracks = PeopleTracks()
    for step in range(10):
        assert tracks.assign([at(400)], step / 10) == (0,)
    for step, x in enumerate([380, 300, 220, 140]):
        assert tracks.assign([at(x, width=130)], 1 + step / 10) == (0,)
    assert tracks.assign([at(60, width=130), at(400)], 1.4) == (1, 0)
    assert tracks.exchanged == Exchange(track=0, new=1, since=1 + 1 / 10)
    assert tracks.assign([at(0, width=130), at(400)], 1.5) == (1, 0)
    assert tracks.exchanged is None


def test_who_was_just_seen_keeps_the_number_before_somebody_who_was_hidden_there() -> None:
    tracks = PeopleTracks()
    assert tracks.assign([at(100), at(160, width=90)], 0.0) == (0, 1)
    tracks.assign([at(100)], 1.0)
    assert tracks.assign([at(175)], 1.1) == (0,)
