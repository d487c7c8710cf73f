"""Shares: Wilson's interval against its known values and its laws."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.evaluation.share import Share

counts = st.integers(1, 5000).flatmap(lambda n: st.builds(Share, st.integers(0, n), st.just(n)))


@pytest.mark.parametrize(
    ("share", "low", "high"),
    # Newcombe 1998, table I, method 3.
    [
        (Share(81, 263), 0.2553, 0.3662),
        (Share(15, 148), 0.0624, 0.1605),
        (Share(0, 20), 0.0, 0.1611),
        (Share(1, 29), 0.0061, 0.1718),
    ],
)
def test_the_interval_is_the_published_one(share: Share, low: float, high: float) -> None:
    assert share.interval() == pytest.approx((low, high), abs=6e-5)


@given(counts)
def test_the_share_lies_in_its_interval(share: Share) -> None:
    interval = share.interval()
    assert interval is not None
    low, high = interval
    assert share.value is not None
    assert 0 <= low <= share.value + 1e-12
    assert share.value - 1e-12 <= high <= 1


@given(counts)
def test_ten_times_the_queries_narrow_the_interval(share: Share) -> None:
    few, many = share.interval(), Share(10 * share.correct, 10 * share.asked).interval()
    assert few is not None
    assert many is not None
    assert many[1] - many[0] < few[1] - few[0]


def test_of_nothing_there_is_no_share() -> None:
    nothing = Share(0, 0)
    assert nothing.value is None
    assert nothing.interval() is None
    assert str(nothing) == "-"
    assert (nothing + Share(1, 2)).value == 0.5
