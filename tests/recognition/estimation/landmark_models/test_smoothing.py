"""The filters' laws: constants, first values, scale, time."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.estimation.landmark_models.body import ExponentialFilter, OneEuroFilter
from app.recognition.poses.sequence import FloatArray

VALUES = st.floats(-1000, 1000)
SIGNALS = st.lists(st.tuples(VALUES, VALUES), min_size=2, max_size=20).map(np.array)
RATES = st.floats(1, 120)


def filtered(
    signal: FloatArray, rate: float, *, scale: float = 1.0, cutoff: float = 0.05, beta: float = 80.0
) -> FloatArray:
    smoother = OneEuroFilter(cutoff, beta)
    return np.stack([smoother.apply(row, index / rate, scale) for index, row in enumerate(signal)])


@given(st.tuples(VALUES, VALUES), RATES)
def test_a_constant_stays_what_it_is(value: tuple[float, float], rate: float) -> None:
    signal = np.tile(value, (10, 1))
    np.testing.assert_allclose(filtered(signal, rate), signal, rtol=1e-12)


@given(SIGNALS, RATES)
def test_the_first_value_passes(signal: FloatArray, rate: float) -> None:
    np.testing.assert_array_equal(filtered(signal, rate)[0], signal[0])


@given(SIGNALS, RATES)
def test_the_result_never_leaves_the_range_of_the_signal(signal: FloatArray, rate: float) -> None:
    result = filtered(signal, rate)
    assert (result >= signal.min(axis=0) - 1e-9).all()
    assert (result <= signal.max(axis=0) + 1e-9).all()


@given(SIGNALS, RATES, st.floats(0.01, 100))
def test_a_nearer_body_is_treated_like_a_far_one(
    signal: FloatArray, rate: float, factor: float
) -> None:
    near = filtered(signal * factor, rate, scale=0.01 / factor)
    np.testing.assert_allclose(near, filtered(signal, rate, scale=0.01) * factor, atol=1e-6)


@given(SIGNALS, RATES, st.tuples(VALUES, VALUES))
def test_moving_the_signal_moves_the_result(
    signal: FloatArray, rate: float, shift: tuple[float, float]
) -> None:
    np.testing.assert_allclose(
        filtered(signal + shift, rate), filtered(signal, rate) + shift, atol=1e-6
    )


def test_without_beta_it_is_a_first_order_low_pass() -> None:
    step = np.array([[0.0], [1.0], [1.0], [1.0]])
    weight = 1 / (1 + 1 / (2 * math.pi * 2.0 / 30))
    expected = 1 - (1 - weight) ** np.arange(4)
    np.testing.assert_allclose(filtered(step, 30, cutoff=2.0, beta=0.0)[:, 0], expected)


def test_jitter_at_rest_is_taken_out_and_fast_motion_is_followed() -> None:
    time = np.arange(60) / 30
    jitter = np.random.default_rng(0).normal(0, 0.5, (60, 1))
    at_rest = filtered(jitter, 30, scale=1 / 400)
    assert at_rest[20:].std() < 0.5 * jitter[20:].std()
    swing = 150 * np.sin(2 * math.pi * time)[:, None]
    assert np.abs(filtered(swing, 30, scale=1 / 400) - swing)[10:].mean() < 5


@pytest.mark.parametrize("later", [1.0, 0.5, -3.0, math.nan])
def test_a_time_that_does_not_increase_starts_anew(later: float) -> None:
    smoother = OneEuroFilter(0.05, 80.0)
    smoother.apply(np.zeros(3), 0.0)
    smoother.apply(np.ones(3), 1.0)
    np.testing.assert_array_equal(smoother.apply(np.full(3, 9.0), later), np.full(3, 9.0))


def test_what_was_returned_or_given_can_be_changed_by_the_caller() -> None:
    smoother, untouched = OneEuroFilter(0.05, 0.0), OneEuroFilter(0.05, 0.0)
    for index in range(3):
        values = np.full(2, float(index))
        result = smoother.apply(values, index / 30)
        np.testing.assert_array_equal(result, untouched.apply(np.full(2, float(index)), index / 30))
        values[:] = result[:] = 1e6


@given(SIGNALS, st.floats(0.01, 1))
def test_exponential_smoothing_takes_its_weight_of_the_new(
    signal: FloatArray, weight: float
) -> None:
    smoother = ExponentialFilter(weight)
    expected = signal[0]
    for row in signal:
        expected = weight * row + (1 - weight) * expected
        np.testing.assert_allclose(smoother.apply(row), expected, atol=1e-9)
