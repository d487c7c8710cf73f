"""Draws of languages and queries."""

import numpy as np
import numpy.typing as npt

from benchmarks.sets.one_shot_draws import draw_several, draws, find_complete_people
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


def test_nobody_who_demonstrates_is_asked(drawn: dict[str, RecordedSet]) -> None:
    swipes = drawn["swipes"]
    for number, draw in enumerate(draws(swipes, 10, 15, seed=3)):
        several = draw_several(swipes, draw, 5, 15, number)
        assert several.rows(1) == [[take] for take in draw.templates]
        for people, takes in ((1, 1), (1, 2), (3, 1), (5, 1)):
            for row, label in zip(
                several.rows(people, takes), ("left", "right", "up"), strict=True
            ):
                assert set(swipes.labels[row]) == {label}
                assert len(set(row)) == people * takes
                assert len(set(swipes.people[row])) == people
                assert not set(swipes.people[row]) & set(swipes.people[several.queries])
        assert len(several.half) == 2
        assert len(set(several.queries)) == 15


def test_one_person_is_left_to_ask(drawn: dict[str, RecordedSet]) -> None:
    swipes = _those(
        drawn["swipes"], np.isin(drawn["swipes"].people, ["person 0", "person 1", "person 2"])
    )
    for number, draw in enumerate(draws(swipes, 5, 15, seed=3)):
        several = draw_several(swipes, draw, 5, 15, number)
        assert len(several.takes) == 2
        assert len(set(swipes.people[several.queries])) == 1


def test_people_who_lack_a_class_demonstrate_nothing(drawn: dict[str, RecordedSet]) -> None:
    whole = drawn["swipes"]
    swipes = _those(whole, (whole.people != "person 4") | (whole.labels != "up"))
    assert {*find_complete_people(swipes)} == {*whole.people} - {"person 4"}
    for number, draw in enumerate(draws(swipes, 30, 15, seed=3)):
        shown = draw_several(swipes, draw, 5, 15, number).rows(5)
        assert "person 4" not in swipes.people[np.array(shown)]


def test_a_set_without_anybody_complete_has_no_draws(drawn: dict[str, RecordedSet]) -> None:
    whole = drawn["swipes"]
    one_each = {"left": "person 0", "right": "person 1", "up": "person 2"}
    kept = [
        one_each[label] == person for label, person in zip(whole.labels, whole.people, strict=True)
    ]
    assert not list(draws(_those(whole, np.array(kept)), 3, 15, seed=1))


def test_where_people_are_unknown_anybody_is_asked_for_further_takes(
    drawn: dict[str, RecordedSet],
) -> None:
    known = drawn["swipes"]
    swipes = RecordedSet(
        "unknown", known.recordings, known.labels, np.full(len(known.labels), "unknown")
    )
    (draw,) = draws(swipes, 1, 10, seed=1)
    several = draw_several(swipes, draw, 5, len(known.labels), 1)
    shown = {take for row in several.rows(1, 2) for take in row}
    assert {*several.queries} == {*range(len(known.labels))} - shown


def _those(recorded: RecordedSet, kept: npt.NDArray[np.bool_]) -> RecordedSet:
    recordings = [each for each, keep in zip(recorded.recordings, kept, strict=True) if keep]
    return RecordedSet(recorded.name, recordings, recorded.labels[kept], recorded.people[kept])
