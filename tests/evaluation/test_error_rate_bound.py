"""Error-rate bound: the rule of three, and the exact bound of Clopper and Pearson."""

import pytest

from app.evaluation.error_rate_bound import bound_error_rate, count_takes_needed


@pytest.mark.parametrize(
    ("errors", "takes", "bound"),
    [(0, 59, 0.0495), (0, 100, 0.0295), (1, 10, 0.3942), (2, 50, 0.1206), (3, 3, 1.0), (0, 0, 1.0)],
)
def test_the_bound_is_that_of_the_published_tables(errors: int, takes: int, bound: float) -> None:
    assert bound_error_rate(errors, takes) == pytest.approx(bound, abs=5e-4)


@pytest.mark.parametrize(("errors", "takes"), [(0, 59), (1, 93), (2, 124)])
def test_takes_needed_for_under_five_per_cent(errors: int, takes: int) -> None:
    assert count_takes_needed(errors) == takes
    assert bound_error_rate(errors, takes - 1) >= 0.05 > bound_error_rate(errors, takes)


def test_thousands_of_takes_are_counted_too() -> None:
    assert 0.5 < bound_error_rate(2500, 5000) < 0.52
    assert count_takes_needed(300) > 6000
