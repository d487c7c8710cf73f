"""The soak's statistics: a leak is told from noise, and a fitted line has the right slope."""

import numpy as np
import pytest

from benchmarks.soak import fit_slope


def test_a_line_has_its_slope_and_no_interval() -> None:
    seconds = np.arange(0.0, 600.0, 2.0)
    slope, half = fit_slope(seconds, 100 + seconds / 3600 * 12)
    assert slope == pytest.approx(12)
    assert half == pytest.approx(0, abs=1e-6)


def test_noise_is_flat_and_a_leak_in_it_is_not() -> None:
    seconds = np.arange(0.0, 900.0, 2.0)
    noise = np.random.default_rng(1).normal(size=len(seconds))
    slope, half = fit_slope(seconds, 200 + noise)
    assert slope - half < 0 < slope + half
    slope, half = fit_slope(seconds, 200 + noise + seconds / 3600 * 60)
    assert slope - half > 6


def test_samples_that_depend_on_each_other_widen_the_interval() -> None:
    seconds = np.arange(0.0, 900.0, 2.0)
    steps = np.random.default_rng(1).normal(size=len(seconds))
    walk = np.convolve(steps, np.ones(20) / 20, mode="same")
    _, independent = fit_slope(seconds, np.random.default_rng(2).permutation(walk))
    _, dependent = fit_slope(seconds, walk)
    assert dependent > 2 * independent
