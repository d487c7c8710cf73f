"""Two-sample statistics."""

import numpy as np
import pytest

from app.recognition.poses.sequence import FloatArray
from benchmarks.simulation.two_samples import coverage, kolmogorov_smirnov, separability


def normal(seed: int, *shape: int) -> FloatArray:
    return np.random.default_rng(seed).standard_normal(shape)


def test_the_largest_difference_of_distributions_is_that_of_their_steps() -> None:
    assert kolmogorov_smirnov(np.array([1.0, 2.0]), np.array([2.0, 1.0])) == 0
    assert kolmogorov_smirnov(np.array([1.0, 2.0]), np.array([3.0, 4.0])) == 1
    assert kolmogorov_smirnov(np.array([1.0, 3.0]), np.array([2.0, 4.0])) == pytest.approx(0.5)


def test_a_sample_like_the_variants_is_covered_as_promised() -> None:
    assert coverage(normal(1, 2000), normal(2, 2000, 100)) == pytest.approx(0.95, abs=0.03)


def test_samples_alike_are_told_apart_by_chance_alone() -> None:
    assert separability(normal(3, 300, 4), normal(4, 300, 4)) == pytest.approx(0.5, abs=0.1)


@pytest.mark.parametrize(("shift", "spread"), [(2.0, 1.0), (0.0, 4.0)])
def test_another_mean_and_another_spread_are_seen(shift: float, spread: float) -> None:
    other = shift + spread * normal(6, 300, 2)
    assert separability(normal(5, 300, 2), other) > 0.8
