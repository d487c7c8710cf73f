"""Held hand shapes as demonstrations: authored from rendered divers' clips, read from others'."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.recognition import (
    Gesture,
    GestureError,
    Language,
    PoseSequence,
    Recognizer,
    Recording,
    takes_in,
)
from tests.recognition.held_takes import FIST, FLAT, TWO, hold
from tests.recognition.strategies import circle, recording

SIGNS = Path(__file__).parents[2] / "sign_recordings"
"""What the models find in rendered clips of held signs between salutes, by two divers each."""


def take(name: str) -> PoseSequence:
    (only,) = takes_in(Recording.load(SIGNS / f"{name}.npz"))
    return only.poses


@pytest.fixture(scope="module")
def signs() -> Language:
    return Language(
        name="signs",
        gestures=[
            Gesture.from_demonstration(label, take(f"{label}-1"))
            for label in ("ok", "stop", "two", "hold")
        ],
    )


@pytest.mark.parametrize("label", ["ok", "stop", "two"])
def test_a_sign_is_recognised_from_another_divers_demonstration(
    signs: Language, label: str
) -> None:
    assert Recognizer(signs).recognize(take(f"{label}-2")).label == label


def test_a_held_shape_has_no_salient_landmarks_and_a_picture_of_the_hand(signs: Language) -> None:
    for gesture in signs.gestures:
        assert gesture.is_held
        assert gesture.salient == ()
        assert gesture.image.any()
        assert gesture.descriptors == {}


def test_a_held_shape_takes_little_room(signs: Language) -> None:
    assert len(signs.to_json()) / len(signs.gestures) < 12000


def test_a_mirror_image_is_shown_with_the_other_hand() -> None:
    gesture = Gesture.from_demonstration("two", hold(TWO))
    assert gesture.trajectory is not None
    (hand,) = gesture.trajectory.hands
    mirrored = gesture.mirror().trajectory
    assert mirrored is not None
    (other,) = mirrored.hands
    assert (hand.side, other.side) == ("right", "left")
    assert np.array_equal(gesture.mirror().mirror().image, gesture.image)
    assert np.array_equal(gesture.redraw().image, gesture.image)


def test_a_shape_has_further_demonstrations_but_no_movement() -> None:
    gesture = Gesture.from_demonstration("two", hold(TWO)).with_demonstration(
        hold(TWO, roll=40, left=True)
    )
    assert [each.is_held for each in gesture.single_demonstrations()] == [True, True]
    with pytest.raises(GestureError, match="is a held hand shape and this demonstration is a move"):
        gesture.with_demonstration(recording(circle))
    with pytest.raises(GestureError, match="is a movement and this demonstration is a held hand"):
        Gesture.from_demonstration("circle", recording(circle)).with_demonstration(hold(FIST))


def test_a_hand_brought_to_its_place_and_away_is_held() -> None:
    coming = np.zeros((60, 2))
    coming[:9, 1], coming[-9:, 1] = np.linspace(0.7, 0, 9), np.linspace(0, 0.7, 9)
    assert Gesture.from_demonstration("stop", hold(FLAT, frames=60, moving=coming)).is_held


def test_named_landmarks_make_it_a_movement() -> None:
    sway = 0.12 * np.column_stack([np.sin(np.arange(40) / 6), np.cos(np.arange(40) / 6)])
    chosen = Gesture.from_demonstration("sway", hold(FLAT, moving=sway), salient=["right_wrist"])
    assert not chosen.is_held
    held = Gesture.from_demonstration("stop", hold(FLAT))
    assert not held.with_salient(["right_wrist"]).is_held


def test_a_still_take_without_hands_is_refused_with_what_is_missing() -> None:
    with pytest.raises(GestureError, match="nor is a hand seen that holds a shape"):
        Gesture.from_demonstration("nothing", replace(hold(FLAT), hands=None))
