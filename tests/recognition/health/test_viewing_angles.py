"""Viewing angles: from where a gesture is another one, or lost, is known before the dive."""

from dataclasses import replace

import numpy as np
import pytest

from app.recognition import Gesture, Language, Recognizer, check_health
from app.recognition.health.check import ANGLES, find_blind_angles, list_turns
from app.recognition.poses.sequence import FloatArray, PoseSequence
from tests.recognition.strategies import SHAPES, circle, in_space, known, recording

NAMES = ("circle", "line", "wedge")


def pool(*, depth: bool = True, **poses: PoseSequence) -> Language:
    taken = poses or {name: in_space(recording(SHAPES[name])) for name in NAMES}
    return Language(
        "pool",
        [
            Gesture.from_demonstration(name, each if depth else replace(each, world=None))
            for name, each in taken.items()
        ],
    )


def bob(share: FloatArray) -> FloatArray:
    """Return the circle's movement up and down alone."""
    return np.asarray(circle(share) * (0.0, 1.0) - (0.7, 0.0))


def tilted(degrees: float) -> PoseSequence:
    """Return a circle in depth too, so that a diver turned by some degrees shows `bob`."""
    poses = in_space(recording(circle))
    world = known(poses.world).copy()
    wrist = poses.landmarks.index("right_wrist")
    across = world[:, wrist, 0] - world[:, wrist, 0].mean()
    world[:, wrist, 2] += across / np.tan(np.radians(degrees))
    return replace(poses, world=world)


def test_different_figures_are_different_from_every_side() -> None:
    advanced: list[None] = []
    found = list(find_blind_angles(Recognizer(pool()), lambda: advanced.append(None)))
    assert found == []
    assert len(advanced) == len(NAMES) * len(ANGLES)


def test_two_gestures_that_are_the_same_from_one_side_are_named_with_that_side() -> None:
    language = pool(tilted=tilted(60), bob=in_space(recording(bob)))
    assert not [each for each in check_health(language).findings if each.kind == "duplicate"]
    found = [each for each in check_health(language).findings if each.kind == "blind_angle"]
    assert {frozenset(each.gestures) for each in found} == {frozenset(("tilted", "bob"))}
    for finding in found:
        assert "when the diver is turned by 60 degrees to the" in finding.message
        assert not finding.error


def test_without_depth_no_angle_is_known() -> None:
    advanced: list[None] = []
    assert not list(find_blind_angles(Recognizer(pool(depth=False)), lambda: advanced.append(None)))
    assert advanced == []


@pytest.mark.parametrize(
    ("turns", "words"),
    [
        ([30], "30 degrees to the left"),
        ([-60, -30, 60], "60 degrees to the left and 30 or 60 degrees to the right"),
        ([-60, 60], "60 degrees to either side"),
    ],
)
def test_turns_are_told_by_their_side(turns: list[int], words: str) -> None:
    assert list_turns(turns) == words
