"""Rates: counted shares with Wilson's interval."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.evaluation.share import Share
from app.recognition.health.finding import Rate, to_plain


@given(st.integers(1, 500).flatmap(lambda n: st.tuples(st.integers(0, n), st.just(n))))
def test_the_interval_holds_the_rate_and_is_that_of_the_evaluation(count: tuple[int, int]) -> None:
    rate = Rate(*count)
    low, high = rate.interval
    assert 0 <= low <= rate.rate <= high <= 1
    assert rate.interval == pytest.approx(Share(*count).interval())


def test_a_rate_is_told_with_its_interval_and_number() -> None:
    assert str(Rate(11, 12)) == "92% (65%-99%, n 12)"
    content = to_plain(Rate(11, 12))
    assert json.loads(json.dumps(content)) == content
    assert content == {"rate": 0.9167, "low": 0.6461, "high": 0.9851, "n": 12}
