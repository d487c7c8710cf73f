"""Accidental movements: reproducible, humanly possible, and large enough to be followed."""

import numpy as np
import pytest

from app.recognition.preprocessing.salience import measure_displacements
from app.recognition.simulation.background_motion import (
    MANNERS,
    TREMOR,
    UPPER_ARM,
    BackgroundMovement,
    simulate_background_motion,
)

MOVEMENTS = simulate_background_motion(4, seed=3)
BY_KIND = {movement.kind: movement for movement in MOVEMENTS}


def length(movement: BackgroundMovement, inner: str, outer: str) -> float:
    """Return the greatest distance between two landmarks."""
    ends = movement.trajectory.select([inner, outer]).xy
    return float(np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1).max())


def test_every_kind_is_there_as_often_as_asked() -> None:
    assert [movement.kind for movement in MOVEMENTS] == [
        manner.kind for manner in MANNERS for _ in range(4)
    ]


def test_the_same_seed_gives_the_same_movements_and_another_others() -> None:
    again, others = simulate_background_motion(4, seed=3), simulate_background_motion(4, seed=4)
    for movement, same, other in zip(MOVEMENTS, again, others, strict=True):
        np.testing.assert_array_equal(movement.trajectory.xy, same.trajectory.xy)
        assert movement.trajectory.xy.shape != other.trajectory.xy.shape or not np.array_equal(
            movement.trajectory.xy, other.trajectory.xy
        )


def test_more_examples_begin_with_the_same_ones() -> None:
    few = simulate_background_motion(2, seed=3)
    np.testing.assert_array_equal(few[2].trajectory.xy, MOVEMENTS[4].trajectory.xy)


@pytest.mark.parametrize("side", ["left", "right"])
def test_no_bone_is_longer_than_a_diver_has_it(side: str) -> None:
    longest = UPPER_ARM + 8 * TREMOR
    for movement in MOVEMENTS:
        assert length(movement, f"{side}_shoulder", f"{side}_elbow") < longest
        assert length(movement, f"{side}_elbow", f"{side}_wrist") < longest


def test_either_hand_does_it() -> None:
    moved = [measure_displacements(movement.trajectory) for movement in MOVEMENTS]
    right = sum(each["right_wrist"] > 2 * each["left_wrist"] for each in moved)
    left = sum(each["left_wrist"] > 2 * each["right_wrist"] for each in moved)
    assert right >= 5
    assert left >= 5


def test_a_swimmer_moves_both_hands_and_a_mask_is_adjusted_with_one() -> None:
    swimming = measure_displacements(BY_KIND["swimming breaststroke"].trajectory)
    assert min(swimming["left_wrist"], swimming["right_wrist"]) > 0.5
    adjusting = measure_displacements(BY_KIND["adjusting the mask"].trajectory)
    assert min(adjusting["left_wrist"], adjusting["right_wrist"]) < 0.1


def test_hands_move_no_faster_than_swimmers_hands() -> None:
    """A sprinter's reach about 10 torso lengths (5 m) a second."""
    for movement in MOVEMENTS:
        wrists = movement.trajectory.select(["left_wrist", "right_wrist"])
        smooth = wrists.xy[2:] - wrists.xy[:-2]
        span = (wrists.time[2:] - wrists.time[:-2])[:, None, None]
        assert np.linalg.norm(smooth / span, axis=2).max() < 10, movement.kind
