"""Languages of several demonstrations are drawn so that queries come from other people."""

import numpy as np
import pytest

from benchmarks.accuracy.several_demonstrations import SHOWN, define, draw_languages, score
from benchmarks.sets.recorded_sets import RecordedSet
from tests.recognition.strategies import SHAPES, recording

CLASSES = ("circle", "line", "wedge")
TAKES = [(label, person, take) for person in "abcde" for label in CLASSES for take in range(3)]


@pytest.fixture(scope="module")
def recorded() -> RecordedSet:
    return RecordedSet(
        "drawn",
        [
            recording(SHAPES[label], jitter=0.01, seed=17 * index, torso=80 + 10 * take)
            for index, (label, _, take) in enumerate(TAKES)
        ],
        np.array([label for label, _, _ in TAKES]),
        np.array([person for _, person, _ in TAKES]),
    )


def test_nobody_who_shows_a_gesture_is_asked(recorded: RecordedSet) -> None:
    for drawn in draw_languages(recorded, 3, 10, seed=4):
        for shown, people, takes in (
            ("1 take", 1, 1),
            ("2 takes", 1, 2),
            ("2 people", 2, 2),
            ("3 people", 3, 3),
        ):
            rows = drawn.templates[shown]
            assert [recorded.labels[row[0]] for row in rows] == [*CLASSES]
            for row in rows:
                assert len(set(row)) == takes
                assert len(set(recorded.people[row])) == people
                assert len(set(recorded.labels[row])) == 1
                assert not set(recorded.people[row]) & set(recorded.people[drawn.queries])


def test_a_set_of_three_people_leaves_nobody_to_ask(recorded: RecordedSet) -> None:
    few = np.isin(recorded.people, list("abc"))
    rest = RecordedSet(
        "three",
        [each for each, kept in zip(recorded.recordings, few, strict=True) if kept],
        recorded.labels[few],
        recorded.people[few],
    )
    assert list(draw_languages(rest, 3, 10, seed=4)) == []


def test_a_gesture_has_a_demonstration_for_each_take(recorded: RecordedSet) -> None:
    assert len(define(recorded, [0, 1, 9]).single_demonstrations()) == 3


def test_every_method_answers_every_query_for_each_way_to_show(recorded: RecordedSet) -> None:
    (drawn,) = draw_languages(recorded, 1, 4, seed=1)
    shares = list(score(recorded, drawn))
    assert {(method, shown) for method, shown, _ in shares} == {
        (method, shown)
        for method in ("paper", "full", "DTW positions", "DTW velocities")
        for shown in SHOWN
    }
    assert {share.asked for _, _, share in shares} == {4}
