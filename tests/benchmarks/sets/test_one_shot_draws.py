"""Draws of languages and queries."""

import numpy as np

from benchmarks.sets.one_shot_draws import draws
from benchmarks.sets.recorded_sets import RecordedSet


def test_templates_are_one_of_each_class_by_one_person_and_never_asked_for(
    drawn: dict[str, RecordedSet],
) -> None:
    swipes = drawn["swipes"]
    for draw in draws(swipes, 20, 15, seed=3):
        assert sorted(swipes.labels[draw.templates]) == ["left", "right", "up"]
        (person,) = set(swipes.people[draw.templates])
        assert set(swipes.people[draw.own]) == {person}
        assert person not in swipes.people[draw.others]
        assert not set(draw.templates) & set(draw.own)
        assert len(set(draw.own)) == len(set(draw.others)) == 15


def test_a_seed_gives_the_same_draws_and_another_one_others(drawn: dict[str, RecordedSet]) -> None:
    once, again, other = (
        [draw.templates for draw in draws(drawn["swipes"], 5, 5, seed)] for seed in (1, 1, 2)
    )
    assert once == again
    assert once != other


def test_where_people_are_unknown_there_is_nobody_else(drawn: dict[str, RecordedSet]) -> None:
    swipes = drawn["swipes"]
    unknown = RecordedSet(
        "unknown", swipes.recordings, swipes.labels, np.full(len(swipes.labels), "unknown")
    )
    (draw,) = draws(unknown, 1, 10, seed=1)
    assert len(draw.own) == 10
    assert len(draw.others) == 0
