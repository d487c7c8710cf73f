"""Drawn movements for the methods that recognition is compared with."""

import pytest

from benchmarks.sets.drawn_sets import drawn_sets
from benchmarks.sets.recorded_sets import RecordedSet


@pytest.fixture(scope="session")
def drawn() -> dict[str, RecordedSet]:
    """Return the drawn sets by name."""
    return {each.name: each for each in drawn_sets()}
