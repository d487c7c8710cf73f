"""Simulated people hold a demonstrated pose, each in their own way."""

import numpy as np

from app.recognition.simulation.background_motion import HOLD, simulate_held_poses
from tests.posed import head_pose


def test_people_hold_the_pose_about_where_it_was_shown() -> None:
    people = simulate_held_poses(head_pose(), 200)
    places = np.array([np.median(each.places, axis=0) for each in people])
    assert np.abs(np.median(places, axis=0) - head_pose().places).max() < 0.05
    assert 0.05 < places.std(axis=0).max() < 0.2
    assert abs(np.median([each.time[-1] for each in people]) - HOLD) < 0.1


def test_the_same_seed_gives_the_same_people() -> None:
    few, many = (
        simulate_held_poses(head_pose(), 2, seed=3),
        simulate_held_poses(head_pose(), 3, seed=3),
    )
    assert all(
        np.array_equal(one.places, other.places) for one, other in zip(few, many, strict=False)
    )
    assert simulate_held_poses(head_pose(), 0) == ()
