"""Findings: each fault of a demonstration is found, and none in a good one."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from app.recognition.gestures.gesture import Gesture
from app.recognition.health.finding import (
    check_demonstration,
    find_longest_held_up,
    measure_visible_share,
)
from app.recognition.poses.sequence import FloatArray
from app.recognition.simulation.background_motion import simulate_background_motion
from tests.recognition.demonstrations import shown
from tests.recognition.held_takes import FIST, FLAT, follow, hold
from tests.recognition.parametric_hand import salute
from tests.recognition.strategies import circle, line

GOOD = shown("circle", circle, frames=60)


def tiny(share: FloatArray) -> FloatArray:
    return np.asarray(0.35 * circle(share))


def half_hidden() -> Gesture:
    assert GOOD.trajectory is not None
    xy = GOOD.trajectory.xy.copy()
    xy[: len(xy) // 2, GOOD.trajectory.landmarks.index("right_wrist")] = np.nan
    return replace(GOOD, trajectory=replace(GOOD.trajectory, xy=xy))


def imported() -> Gesture:
    return Gesture(label="circle", salient=("right_wrist",), image=GOOD.image)


def kinds(gesture: Gesture) -> list[str]:
    return [finding.kind for finding in check_demonstration(gesture)]


def test_a_good_demonstration_has_no_findings() -> None:
    assert kinds(GOOD) == []


@pytest.mark.parametrize(
    ("kind", "make"),
    [
        ("too_short", lambda: shown("circle", circle, frames=10)),
        ("too_long", lambda: shown("circle", circle, frames=400)),
        ("too_small", lambda: shown("circle", tiny)),
        ("poorly_seen", half_hidden),
        ("no_demonstration", imported),
    ],
)
def test_a_fault_is_found_and_told_about_that_gesture(
    kind: str, make: Callable[[], Gesture]
) -> None:
    (finding,) = check_demonstration(make())
    assert finding.kind == kind
    assert finding.gestures == ("circle",)
    assert "circle" in finding.message
    assert not finding.error


def test_a_hand_held_up_may_be_taken_for_a_salute() -> None:
    (pointing,) = [
        each.trajectory
        for each in simulate_background_motion(1, seed=3)
        if each.kind == "venting the vest"
    ]
    assert find_longest_held_up(pointing) > 0.3
    assert find_longest_held_up(GOOD.trajectory or pointing) == 0


def test_half_hidden_is_half_seen() -> None:
    hidden = half_hidden().trajectory
    assert hidden is not None
    assert measure_visible_share(hidden, "right_wrist") == pytest.approx(0.5, abs=0.02)
    assert measure_visible_share(hidden, "left_wrist") == 1


def test_a_line_that_is_quick_but_possible_is_no_fault() -> None:
    assert kinds(shown("line", line, frames=20)) == []


def test_a_salute_within_a_sequence_is_found_with_its_place() -> None:
    saluting = salute(gap=40)
    for shapes, place in (((FIST, saluting), "second"), ((saluting, FIST), "first")):
        gesture = Gesture.from_demonstration("go", follow(*map(hold, shapes)))
        (finding,) = check_demonstration(gesture)
        assert finding.kind == "salute_like"
        assert finding.message.startswith(f"the {place} shape of go looks like the salute")
    assert kinds(Gesture.from_demonstration("go", follow(hold(FIST), hold(FLAT)))) == []
