"""Salute ranges: which salutes a range of a clip contains."""

from __future__ import annotations

import pytest

from app.api.services.salute_ranges import count_salutes, find_salutes
from app.recognition.recording.segmentation import takes_in
from tests.api.recordings import recording_of


@pytest.mark.parametrize(
    ("start", "end", "count"), [(0.0, 10.0, 2), (0.0, 1.0, 1), (0.7, 2.5, 0), (2.55, 3.0, 1)]
)
def test_salutes_that_a_range_contains_are_counted(start: float, end: float, count: int) -> None:
    assert count_salutes(find_salutes(recording_of("circle")), start, end) == count


def test_a_take_contains_none_of_its_salutes() -> None:
    recording = recording_of("circle", "line")
    salutes = find_salutes(recording)
    assert len(salutes) == 4
    assert [count_salutes(salutes, take.start, take.end) for take in takes_in(recording)] == [0, 0]
