"""Hand shapes: what a held hand looks like, wherever and however large it is."""

import numpy as np
import pytest

from app.recognition.errors import PoseError
from app.recognition.poses.frame import MOST_FRAMES, HandShape, choose_frames
from app.recognition.poses.sequence import FloatArray
from tests.recognition.held_takes import FIST, FLAT, TWO
from tests.recognition.parametric_hand import hand_xy

HAND = hand_xy(TWO)


def test_place_and_size_do_not_matter() -> None:
    near = HandShape.of_frames("right", HAND[None])
    far = HandShape.of_frames("right", 0.2 * HAND[None] + (300, 90))
    assert np.array_equal(near.xy, far.xy)
    assert np.allclose(near.xy.mean(axis=0), 0, atol=1e-3)
    assert np.isclose((near.xy**2).sum(axis=1).mean(), 1, atol=1e-2)


def test_frames_in_which_the_hand_is_open_for_a_moment_do_not_matter() -> None:
    frames = np.repeat(HAND[None], 20, axis=0)
    frames[:5] = np.random.default_rng(0).normal(size=(5, 21, 2))
    held = HandShape.of_frames("left", HAND[None])
    assert np.allclose(HandShape.of_frames("left", frames).xy, held.xy, atol=0.01)


def test_a_mirror_image_is_of_the_other_hand_and_mirrors_back() -> None:
    hand = HandShape.of_frames("right", HAND[None])
    assert hand.mirror().side == "left"
    assert np.array_equal(hand.mirror().mirror().xy, hand.xy)


def test_four_quarter_turns_are_none() -> None:
    hand = HandShape.of_frames("right", HAND[None])
    quarter = hand.turn(90)
    assert np.allclose(quarter.xy, np.column_stack([-hand.xy[:, 1], hand.xy[:, 0]]))
    assert np.allclose(quarter.turn(270).xy, hand.xy)


def test_the_palm_of_a_fist_is_large_beside_that_of_an_open_hand() -> None:
    fist, flat = (HandShape.of_frames("right", hand_xy(each)[None]) for each in (FIST, FLAT))
    assert fist.palm > 1.3 * flat.palm
    assert flat.mirror().palm == flat.palm


@pytest.mark.parametrize("xy", [np.zeros((21, 2)), np.full((21, 2), np.nan), np.ones((20, 2))])
def test_what_is_no_hand_is_refused(xy: FloatArray) -> None:
    with pytest.raises(PoseError, match="hand shape"):
        HandShape("right", xy)


@pytest.mark.parametrize("count", [1, 2, MOST_FRAMES, MOST_FRAMES + 1, 1000])
def test_few_frames_are_chosen_evenly_from_the_first_to_the_last(count: int) -> None:
    chosen = choose_frames(count)
    assert len(chosen) == min(count, MOST_FRAMES)
    assert (chosen[0], chosen[-1]) == (0, count - 1)
    steps = np.diff(chosen)
    assert steps.size == 0 or 1 <= steps.min() <= steps.max() <= steps.min() + 1
