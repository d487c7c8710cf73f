"""Rate estimates: calibrated if real takes vary as simulated, and wider with fewer trials."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.simulation.rate_estimate import RateEstimate
from app.recognition.simulation.variant_bias import VariantBias

MARGINS = st.lists(st.floats(-5, 5), min_size=2, max_size=40).map(np.array)
SPREADS = st.floats(0.1, 2)
SHARES = st.floats(0, 1)


@given(MARGINS, SPREADS, SHARES)
def test_a_rate_lies_in_its_interval_and_that_in_zero_to_one(
    margins: np.ndarray, scatter: float, otherwise: float
) -> None:
    forecast = RateEstimate.of_margins(margins, VariantBias(scatter, otherwise))
    assert otherwise <= forecast.low <= forecast.rate <= forecast.high <= 1


@given(st.integers(1, 60).flatmap(lambda n: st.tuples(st.integers(0, n), st.just(n))))
def test_a_count_lies_in_its_interval(counted: tuple[int, int]) -> None:
    forecast = RateEstimate.of_count(*counted)
    assert 0 <= forecast.low <= forecast.rate <= forecast.high <= 1


@given(MARGINS, SPREADS, st.floats(0.01, 3))
def test_greater_margins_are_never_more_often_below_zero(
    margins: np.ndarray, scatter: float, more: float
) -> None:
    narrow = RateEstimate.of_margins(margins, VariantBias(scatter, 0))
    assert (
        RateEstimate.of_margins(margins + more, VariantBias(scatter, 0)).rate <= narrow.rate + 1e-12
    )


def test_no_margin_at_all_is_a_guess() -> None:
    assert RateEstimate.of_margins(np.zeros(8), VariantBias(0.5, 0)).rate == 0.5


@pytest.mark.parametrize("mean", [0.0, 0.3, 0.6])
@pytest.mark.parametrize("tail", [3.0, 30.0])
def test_real_takes_that_scatter_as_foreseen_are_forecast_right(mean: float, tail: float) -> None:
    """Checked with tails of any weight in the simulated margins."""
    generator = np.random.default_rng(1)
    rehearsed = mean + 0.4 * generator.standard_t(tail, (400, 64)) / np.sqrt(tail / (tail - 2))
    true = float((mean + generator.logistic(0, 0.25, 100_000) < 0).mean())
    forecasts = [RateEstimate.of_margins(margins, VariantBias(0.25, 0)) for margins in rehearsed]
    assert np.mean([each.rate for each in forecasts]) == pytest.approx(true, abs=0.01)
    assert np.mean([each.low <= true <= each.high for each in forecasts]) > 0.85


def test_takes_that_are_not_what_was_shown_are_missed_however_far_from_it() -> None:
    assert RateEstimate.of_margins(np.full(8, 4.0), VariantBias(0.25, 0.04)).rate == pytest.approx(
        0.04, abs=1e-6
    )


def test_more_rehearsals_make_the_interval_narrower() -> None:
    margins = np.random.default_rng(2).normal(1, 1, 200)
    few, many = (
        RateEstimate.of_margins(margins[:10], VariantBias(0.5, 0)),
        RateEstimate.of_margins(margins, VariantBias(0.5, 0)),
    )
    assert many.high - many.low < few.high - few.low


def test_a_wider_scatter_makes_rare_things_likelier() -> None:
    margins = np.random.default_rng(3).normal(2, 0.5, 20)
    assert (
        RateEstimate.of_margins(margins, VariantBias(0.6, 0)).rate
        > RateEstimate.of_margins(margins, VariantBias(0.3, 0)).rate
    )
