"""Figures carried by simulated bodies."""

import numpy as np

from benchmarks.sets.simulated_bodies import FIGURES, PEOPLE, TAKES, simulate_figures


def test_every_person_draws_every_figure_with_arms_of_one_length() -> None:
    simulated = simulate_figures(np.random.default_rng(0))
    assert len(simulated.recordings) == PEOPLE * TAKES * len(FIGURES)
    for poses in simulated.recordings[:: TAKES * 3]:
        upper = np.linalg.norm(poses.column("right_elbow") - poses.column("right_shoulder"), axis=1)
        whole = upper + np.linalg.norm(
            poses.column("right_wrist") - poses.column("right_elbow"), axis=1
        )
        torso = poses.torso_length()
        assert torso is not None
        # Seen from the front, an arm never appears longer than it is, up to noise and perspective.
        assert whole.max() < 1.35 * torso
        # The arm hangs at both ends: the wrist is at about the hip's height or lower.
        wrist, hip = poses.column("right_wrist")[:, 1], poses.column("right_hip")[:, 1]
        assert min(wrist[0] - hip[0], wrist[-1] - hip[-1]) > -0.2 * torso


def test_a_seed_gives_the_same_recordings() -> None:
    once, again = (simulate_figures(np.random.default_rng(3)).recordings[7].xy for _ in range(2))
    np.testing.assert_array_equal(once, again)
