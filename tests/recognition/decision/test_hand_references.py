"""Hand references: held shapes of a language, and which of them a held hand is nearest to."""

from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from app.recognition.decision.hand_references import HeldReferences, score_hands
from app.recognition.gestures.gesture import Gesture
from app.recognition.gestures.switches import Switches
from app.recognition.poses.frame import HandShape, mirror_hands
from app.recognition.poses.trajectory import Trajectory
from tests.recognition.held_takes import FIST, FLAT, TWO, fingers, hold

GESTURES = [
    Gesture.from_demonstration(label, hold(shape, thumb=20))
    for label, shape in (("stop", FLAT), ("hold", FIST), ("two", TWO), ("one", fingers(0)))
]


def references(gestures: list[Gesture]) -> HeldReferences:
    return HeldReferences.of(gestures, np.arange(len(gestures)))


def held(gesture: Gesture) -> tuple[tuple[HandShape, ...], ...]:
    return gesture.held_shapes


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
    assert len(held(of_two)[0]) == 2
    made = references([GESTURES[2], of_two])
    assert np.allclose(made.distances(held(of_two))[:, 1], 0)
    assert np.isinf(made.distances(held(GESTURES[2]))[:, 1]).all()


def sequence(first: int, second: int) -> Gesture:
    """Return two of `GESTURES` in sequence."""
    shown = replace(held_trajectory(first), then_hands=held(GESTURES[second])[0])
    return replace(GESTURES[first], trajectory=shown)


def held_trajectory(index: int) -> Trajectory:
    trajectory = GESTURES[index].trajectory
    assert trajectory is not None
    return trajectory


def test_sequences_are_compared_with_sequences_alone() -> None:
    made = references([GESTURES[0], sequence(0, 1), sequence(2, 3)])
    assert np.isfinite(made.distances(held(GESTURES[0])).min(axis=0)).tolist() == [1, 0, 0]
    assert np.isfinite(made.distances(held(sequence(0, 1))).min(axis=0)).tolist() == [0, 1, 1]


def test_a_sequence_of_one_shape_twice_is_as_far_as_the_shape() -> None:
    for query in GESTURES:
        once = references(GESTURES).distances(held(query))
        twice = references([sequence(index, index) for index in range(4)])
        assert np.allclose(twice.distances(2 * held(query)), once)


@settings(deadline=None, max_examples=40)
@given(
    first=st.integers(0, 3),
    second=st.integers(0, 3),
    turns=st.tuples(st.floats(-25, 25), st.floats(-25, 25)),
    mirrored=st.booleans(),
)
def test_the_swapped_order_is_never_nearer(
    first: int, second: int, turns: tuple[float, float], mirrored: bool
) -> None:
    made = references([sequence(first, second)])
    shapes = [
        tuple(hand.turn(turn) for hand in hands)
        for hands, turn in zip(held(sequence(first, second)), turns, strict=True)
    ]
    if mirrored:
        shapes = [mirror_hands(hands) for hands in shapes]
    right, swapped = made.distances(shapes).mean(axis=0), made.distances(shapes[::-1]).mean(axis=0)
    assert right <= swapped + 1e-9
    assert first == second or swapped > 0.3
    assert right < 0.2


def test_both_hands_of_a_sequence_are_compared_with_the_same_hand() -> None:
    one, other = held(sequence(0, 1)), held(sequence(2, 3))
    both = [(*mirror_hands(left), *right) for left, right in zip(other, one, strict=True)]
    crossed = [both[0], (*mirror_hands(one[1]), *other[1])]
    made = references([sequence(0, 1)])
    assert np.allclose(made.distances(both), 0)
    assert score_hands(made.distances(crossed)) > 0.5


def test_two_shapes_are_measured_by_their_own_palms() -> None:
    """A hand far from a flat hand, and as far from a fist, is farther from the flat one."""
    made = references([sequence(0, 1)])
    flat, fist = (HandShape("right", made.shapes[0][part][0].xy) for part in (0, 1))
    assert flat.palm < fist.palm
    error = 0.1 * np.sin(np.arange(42)).reshape(21, 2)
    wrong = [HandShape("right", hand.xy + error) for hand in (flat, fist)]
    of_flat, of_fist = (
        made.distances(shapes)[0, 0] for shapes in ([(wrong[0],), (fist,)], [(flat,), (wrong[1],)])
    )
    assert of_flat / of_fist > 0.9 * (fist.palm / flat.palm)
