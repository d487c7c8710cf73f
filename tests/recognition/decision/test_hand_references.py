"""Hand references: held shapes of a language, and which of them a held hand is nearest to."""

from dataclasses import replace

import numpy as np

from app.recognition.decision.hand_references import HandReferences
from app.recognition.gestures.gesture import Gesture
from app.recognition.gestures.switches import Switches
from app.recognition.poses.hand_shape import HandShape
from tests.recognition.held_takes import FIST, FLAT, TWO, fingers, hold

GESTURES = [
    Gesture.from_demonstration(label, hold(shape, thumb=20))
    for label, shape in (("stop", FLAT), ("hold", FIST), ("two", TWO), ("one", fingers(0)))
]


def references(gestures: list[Gesture]) -> HandReferences:
    return HandReferences.of(gestures, np.arange(len(gestures)))


def held(gesture: Gesture) -> tuple[HandShape, ...]:
    assert gesture.trajectory is not None
    return gesture.trajectory.hands


def test_every_shape_is_nearest_to_itself() -> None:
    apart = np.array([references(GESTURES).distances(held(each)) for each in GESTURES])
    assert np.allclose(apart[np.arange(4), :, np.arange(4)], 0)
    assert (apart.mean(axis=1).argsort(axis=1)[:, 1] != np.arange(4)).all()


def test_the_other_hand_shows_the_same_sign() -> None:
    other = Gesture.from_demonstration("two", hold(TWO, thumb=20, left=True, seed=5))
    assert references(GESTURES).distances(held(other)).mean(axis=0).argmin() == 2
    assert references(GESTURES).distances(held(other))[:, 2].max() < 0.15


def test_a_mirror_image_that_is_another_gesture_is_not_the_same() -> None:
    aside = [
        Gesture.from_demonstration("left", hold(fingers(0), roll=-70)),
        Gesture.from_demonstration("right", hold(fingers(0), roll=-70, left=True)),
    ]
    assert not references(aside).mirrored.any()
    assert references(aside[:1]).mirrored.all()
    off = replace(aside[0], switches=Switches(mirror="off"))
    assert not references([off]).mirrored.any()


def test_two_hands_are_compared_with_two() -> None:
    poses = hold(TWO)
    assert poses.hands is not None
    both = poses.hands.copy()
    both[:, 0] = both[:, 1] * (-1, 1) + (640, 0)
    of_two = Gesture.from_demonstration("both", replace(poses, hands=both))
    assert len(held(of_two)) == 2
    made = references([GESTURES[2], of_two])
    assert np.allclose(made.distances(held(of_two))[:, 1], 0)
    assert np.isinf(made.distances(held(GESTURES[2]))[:, 1]).all()


def test_some_of_the_references_are_as_far_as_among_all() -> None:
    everything = references(GESTURES)
    some = everything.take(np.array([1, 3]))
    query = held(GESTURES[0])
    assert np.allclose(some.distances(query), everything.distances(query)[:, [1, 3]])
