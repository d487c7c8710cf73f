"""Several demonstrations of one gesture: added, removed, mirrored and redrawn."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.recognition import Gesture, GestureError, PoseSequence
from app.recognition.gestures.demonstration import MAX_DEMONSTRATIONS, MAX_DIVER_LENGTH
from app.recognition.gestures.switches import Switches
from tests.recognition.strategies import circle, line, recording, recordings, rest, square, wedge


def circled(**options: Any) -> Gesture:
    return Gesture.from_demonstration("circle", recording(circle), **options)


def assert_same_take(one: Gesture, other: Gesture) -> None:
    assert (one.salient, one.diver) == (other.salient, other.diver)
    np.testing.assert_array_equal(one.image, other.image)
    assert one.trajectory is not None
    assert other.trajectory is not None
    np.testing.assert_array_equal(one.trajectory.xy, other.trajectory.xy)
    for name, values in one.descriptors.items():
        np.testing.assert_array_equal(other.descriptors[name], values)


def test_each_demonstration_is_a_gesture_of_its_own_with_the_same_command() -> None:
    gesture = replace(
        circled(description="a large one", command={"mode": "hold"}, diver="Ana"),
        switches=Switches(direction="on"),
        thresholds={"path": 0.4},
    ).with_demonstration(recording(circle, jitter=0.01, frames=80), "Ben")
    first, second = gesture.single_demonstrations()
    assert_same_take(first, circled(diver="Ana"))
    alone = Gesture.from_demonstration(
        "circle", recording(circle, jitter=0.01, frames=80), diver="Ben"
    )
    assert_same_take(second, alone)
    for each in (first, second):
        assert each.further == ()
        assert (each.label, each.description, each.command) == (
            gesture.label,
            gesture.description,
            gesture.command,
        )
        assert each.switches == gesture.switches
        assert each.thresholds == gesture.thresholds


def test_a_gesture_with_one_demonstration_is_its_only_one() -> None:
    gesture = circled()
    assert gesture.further == ()
    assert gesture.single_demonstrations() == (gesture,)


def test_a_further_demonstration_has_the_salient_landmarks_of_the_first() -> None:
    both = Gesture.from_demonstration(
        "circle", recording(circle), salient=("left_wrist", "right_wrist")
    )
    (further,) = both.with_demonstration(recording(wedge)).further
    assert further.salient == ("left_wrist", "right_wrist")


def test_a_further_demonstration_with_the_other_hand_has_its_own_salient_landmarks() -> None:
    (further,) = circled().with_demonstration(recording(circle, hand="left_wrist")).further
    assert further.salient == ("left_wrist",)
    chosen = circled().with_demonstration(recording(circle), salient=("right_wrist", "nose"))
    assert chosen.further[0].salient == ("nose", "right_wrist")


def test_a_recording_without_the_first_ones_landmarks_is_still_a_demonstration() -> None:
    marker = recording(circle, hand="marker", landmarks=("marker", "base"))
    (further,) = circled().with_demonstration(marker).further
    assert further.salient == ("marker",)


def test_a_take_that_shows_nothing_is_refused() -> None:
    with pytest.raises(GestureError, match="nothing moves in the demonstration of 'circle'"):
        circled().with_demonstration(recording(rest))


def test_more_demonstrations_than_the_limit_are_refused() -> None:
    gesture = circled()
    for _ in range(MAX_DEMONSTRATIONS - 1):
        gesture = gesture.with_demonstration(recording(circle))
    assert len(gesture.single_demonstrations()) == MAX_DEMONSTRATIONS == 8
    with pytest.raises(GestureError, match="would have 9 demonstrations, the limit is 8"):
        gesture.with_demonstration(recording(circle))


@given(st.lists(recordings(), min_size=2, max_size=4), st.integers(0, MAX_DEMONSTRATIONS - 1))
@settings(max_examples=20, deadline=None)
def test_removing_a_demonstration_leaves_the_others_in_order(
    takes: list[PoseSequence], index: int
) -> None:
    gesture = Gesture.from_demonstration("stroke", takes[0], diver="diver 0")
    for number, take in enumerate(takes[1:], start=1):
        gesture = gesture.with_demonstration(take, f"diver {number}")
    if index >= len(takes):
        with pytest.raises(GestureError, match=f"no demonstration {index}, it has {len(takes)}"):
            gesture.without_demonstration(index)
        return
    left = gesture.without_demonstration(index).single_demonstrations()
    expected = [
        each for place, each in enumerate(gesture.single_demonstrations()) if place != index
    ]
    assert [each.diver for each in left] == [each.diver for each in expected]
    for one, other in zip(left, expected, strict=True):
        assert_same_take(one, other)


def test_the_only_demonstration_cannot_be_removed() -> None:
    with pytest.raises(GestureError, match="the only demonstration of 'circle' cannot be removed"):
        circled().without_demonstration(0)


def test_mirroring_twice_gives_the_same_demonstrations() -> None:
    gesture = circled().with_demonstration(recording(wedge, hand="left_wrist"), "Ben")
    mirrored = gesture.mirror()
    assert [each.salient for each in mirrored.single_demonstrations()] == [
        ("left_wrist",),
        ("right_wrist",),
    ]
    again = mirrored.mirror().single_demonstrations()
    for one, other in zip(again, gesture.single_demonstrations(), strict=True):
        assert_same_take(one, other)


def test_other_salient_landmarks_reach_all_demonstrations_in_which_they_move() -> None:
    gesture = (
        circled()
        .with_demonstration(recording(square))
        .with_demonstration(recording(line, hand="left_wrist"))
    )
    changed = gesture.with_salient(("right_wrist", "right_elbow"))
    assert [each.salient for each in changed.single_demonstrations()] == [
        ("right_elbow", "right_wrist"),
        ("right_elbow", "right_wrist"),
        ("left_wrist",),
    ]
    assert (changed.further[0].image != gesture.further[0].image).any()


@given(recordings())
@settings(max_examples=20, deadline=None)
def test_redrawing_changes_no_demonstration(poses: PoseSequence) -> None:
    gesture = circled().with_demonstration(poses, "Ben")
    for one, other in zip(
        gesture.redraw().single_demonstrations(), gesture.single_demonstrations(), strict=True
    ):
        assert_same_take(one, other)


def test_an_imported_image_can_have_a_demonstration_beside_it() -> None:
    drawn = circled()
    imported = Gesture(label="circle", salient=drawn.salient, image=drawn.image).redraw()
    gesture = imported.with_demonstration(recording(circle), "Ben")
    assert [each.trajectory is None for each in gesture.single_demonstrations()] == [True, False]
    assert gesture.without_demonstration(0).diver == "Ben"


def test_a_demonstration_cannot_be_changed_from_outside() -> None:
    (further,) = circled().with_demonstration(recording(circle)).further
    with pytest.raises(ValueError, match="read-only"):
        further.image[0, 0] = 255
    with pytest.raises(ValueError, match="read-only"):
        further.descriptors["hu"][0] = 1.0


@pytest.mark.parametrize("diver", ["a\nb", "x" * (MAX_DIVER_LENGTH + 1), "\udc00", None])
def test_a_divers_name_must_be_readable(diver: str) -> None:
    with pytest.raises(GestureError, match="a diver's name must be"):
        circled().with_demonstration(recording(circle), diver)
    with pytest.raises(GestureError, match="a diver's name must be"):
        circled(diver=diver)
