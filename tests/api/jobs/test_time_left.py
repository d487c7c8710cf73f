"""Time left of a job: unknown at the start, then by the rate since the first report."""

from __future__ import annotations

from app.api.jobs.time_left import TimeLeft


def test_nothing_is_estimated_from_the_first_frames() -> None:
    left = TimeLeft()
    assert left.estimate(1, 239, now=100.0) is None
    assert left.estimate(2, 239, now=100.1) is None
    assert left.estimate(11, 239, now=104.0) is None


def test_frames_before_the_first_report_do_not_count_towards_the_rate() -> None:
    left = TimeLeft()
    # Ten frames come at once; then four a second.
    assert left.estimate(10, 110, now=0.0) is None
    assert left.estimate(30, 110, now=5.0) == 20.0
    assert left.estimate(110, 110, now=25.0) == 0.0
