"""Edits: each changes the demonstration as its words say, and nothing else."""

import numpy as np
import pytest

from app.recognition.gestures.gesture import Gesture
from app.recognition.health.edits import (
    LARGER,
    heighten,
    lengthen_stroke,
    list_edits,
    list_switch_edits,
    reverse,
    set_switch,
    slow_down,
    swap_hands,
    use_both_hands,
    widen,
)
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from tests.recognition.demonstrations import shown
from tests.recognition.strategies import circle, line, wedge

WEDGE = shown("wedge", wedge)


def demonstration(gesture: Gesture | None) -> Trajectory:
    assert gesture is not None
    assert gesture.trajectory is not None
    return gesture.trajectory


def box(gesture: Gesture | None, landmark: str = "right_wrist") -> FloatArray:
    return np.asarray(np.ptp(demonstration(gesture).select([landmark]).xy[:, 0], axis=0))


def test_the_other_hand_shows_the_mirror_image() -> None:
    mirrored = swap_hands(WEDGE)
    assert mirrored is not None
    assert mirrored.salient == ("left_wrist",)
    np.testing.assert_allclose(box(mirrored, "left_wrist"), box(WEDGE))


def test_both_hands_show_mirror_images_at_the_same_time() -> None:
    both = use_both_hands(WEDGE)
    assert both is not None
    assert both.salient == ("left_wrist", "right_wrist")
    wrists = demonstration(both).select(both.salient).xy
    np.testing.assert_allclose(wrists[:, 0], wrists[:, 1] * (-1, 1), atol=1e-9)
    assert swap_hands(both) is None
    assert use_both_hands(both) is None


def test_sizes_change_as_told() -> None:
    width, height = box(WEDGE)
    np.testing.assert_allclose(box(widen(WEDGE)), [LARGER * width, height])
    np.testing.assert_allclose(box(heighten(WEDGE)), [width, LARGER * height])


def test_the_trunk_stays_where_it_is() -> None:
    trunk = ["left_shoulder", "right_shoulder", "left_hip", "right_hip"]
    before = demonstration(WEDGE).select(trunk).xy
    np.testing.assert_array_equal(demonstration(widen(WEDGE)).select(trunk).xy, before)


def test_time_is_stretched_and_turned_round() -> None:
    before = demonstration(WEDGE)
    np.testing.assert_allclose(demonstration(slow_down(WEDGE)).time, 2 * before.time)
    turned = demonstration(reverse(WEDGE))
    np.testing.assert_array_equal(turned.xy, before.xy[::-1])
    assert (np.diff(turned.time) > 0).all()
    np.testing.assert_allclose(demonstration(reverse(reverse(WEDGE) or WEDGE)).xy, before.xy)


def test_only_the_named_stroke_grows() -> None:
    before, middle = demonstration(WEDGE), demonstration(WEDGE).time[-1] / 2
    after = demonstration(lengthen_stroke(WEDGE, middle, 99.0)).select(["right_wrist"])
    early = after.time < middle - 0.1
    wrist = before.select(["right_wrist"]).xy
    np.testing.assert_allclose(after.xy[early], wrist[early])
    assert np.ptp(after.xy[~early, 0, 1]) == pytest.approx(
        LARGER * np.ptp(wrist[~early, 0, 1]), rel=0.1
    )


def test_a_changed_gesture_is_drawn_anew() -> None:
    changed = widen(shown("circle", circle))
    assert changed is not None
    assert changed.descriptors["aspect_ratio"] != pytest.approx(
        shown("circle", circle).descriptors["aspect_ratio"], abs=0.05
    )


def test_switches_are_turned_on() -> None:
    changed = set_switch(WEDGE, direction=True)
    assert changed is not None
    assert (changed.switches.direction, changed.switches.tempo) == ("on", "auto")
    assert set_switch(None, tempo=True) is None


def test_every_change_names_what_to_do_to_which_gesture() -> None:
    line_shown = shown("line", line)
    listed = [*list_edits(WEDGE, stroke=(0.2, 0.6)), *list_switch_edits(WEDGE, line_shown)]
    assert all("wedge" in change.text for change in listed)
    assert len({change.kind for change in listed}) == len(listed)
    assert all(change.apply(WEDGE) is not None for change in listed)


def test_without_a_demonstration_nothing_can_be_changed() -> None:
    imported = Gesture(label="old", salient=("right_wrist",), image=WEDGE.image)
    assert widen(imported) is None
    assert use_both_hands(imported) is None
