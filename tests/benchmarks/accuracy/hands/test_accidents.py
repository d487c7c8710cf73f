"""Accidents: what counts by itself, counted on drawn takes of several people."""

from __future__ import annotations

import numpy as np

from benchmarks.accuracy.hands.accidents import OUTCOMES, PROPERTIES, measure, report
from benchmarks.sets.recorded_sets import RecordedSet
from tests.recognition.strategies import recording, square, wedge


def test_every_property_is_counted_on_takes_of_other_people() -> None:
    takes = [
        (label, person, recording(path, jitter=0.01, seed=seed))
        for label, path in {"square": square, "wedge": wedge}.items()
        for seed, person in enumerate(("one", "two", "three"))
    ]
    labels, people, recordings = zip(*takes, strict=True)
    drawn = RecordedSet("drawn", list(recordings), np.array(labels), np.array(people))
    found = measure(drawn, 3, 4, seed=1)
    assert set(found) == set(PROPERTIES)
    assert sum(found["as it is"].outcomes.values()) == 12
    assert set(found["as it is"].outcomes) <= set(OUTCOMES)
    assert not any(found["tempo"].by_accident)
    assert len([*report("drawn", found)]) == len(PROPERTIES)
