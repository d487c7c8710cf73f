"""Measures of a draw: nearest and rejected takes, answers of several gestures, and sums."""

from argparse import Namespace
from dataclasses import replace

import numpy as np
import pytest

from app.recognition import Language, Recognition, Recognizer
from benchmarks.accuracy.people import (
    COLUMNS,
    MEASURES,
    SIZE,
    compare_choices,
    compare_forecasts,
    count_outcomes,
    define,
    format_gain,
    judge,
    judge_half,
    measure,
    measure_halves,
    summarize,
)
from benchmarks.sets.one_shot_draws import draw_several, draws
from benchmarks.sets.recorded_sets import RecordedSet
from tests.recognition.strategies import SHAPES, recording

CLASSES = ("circle", "line", "square", "wedge")
TAKES = [(label, person, take) for person in "abcd" for label in CLASSES for take in range(3)]


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


@pytest.fixture(scope="module")
def result(recorded: RecordedSet) -> Recognition:
    language = Language("drawn", [define(recorded, [index]) for index in (0, 3, 6)])
    return Recognizer(language, "full").recognize(recorded.recordings[1])


def test_a_gesture_has_a_demonstration_and_a_diver_for_each_take(recorded: RecordedSet) -> None:
    shown = define(recorded, [0, 1, 12]).single_demonstrations()
    assert [each.diver for each in shown] == ["a", "a", "b"]


@pytest.mark.parametrize(
    ("scores", "label", "alone", "size"),
    [
        ([1.0, 1.15, 3.0], "circle", None, 1),
        ([1.0, 1.05, 3.0], "circle", None, 2),
        ([1.0, 1.15, 3.0], "line", True, 1),
        ([1.0, 1.05, 1.08], "line", False, 3),
        ([1.0, 1.05, 3.0], "square", False, 2),
    ],
)
def test_an_answer_has_all_gestures_near_the_best(
    result: Recognition, scores: list[float], label: str, alone: bool | None, size: int
) -> None:
    near = result.model_copy(
        update={"nearest": "circle", "label": "circle", "scores": np.array(scores)}
    )
    found = dict(judge(near, label, ratio=1.1))
    assert found["nearest"] == (label == "circle")
    assert found.get("wrong alone") == alone
    assert found[SIZE] == size
    assert found["right in answer"] == (label in CLASSES[:size])
    assert found.get("right rejected") == (False if label == "circle" else None)


def test_what_cannot_be_compared_is_an_error_and_not_accepted(recorded: RecordedSet) -> None:
    language = Language("drawn", [define(recorded, [0])])
    assert dict(judge(None, "circle", ratio=1.1)) == {"nearest": False}
    assert dict(judge_half(None, "line", language)) == {"half: near accepted": False}
    assert dict(judge_half(None, "circle", language)) == {}


def test_half_a_language_accepts_or_rejects(recorded: RecordedSet, result: Recognition) -> None:
    language = Language("drawn", [define(recorded, [0])])
    accepted = result.model_copy(update={"nearest": "circle", "label": "circle"})
    rejected = result.model_copy(update={"nearest": "circle", "label": None})
    assert dict(judge_half(accepted, "circle", language)) == {"half: right rejected": False}
    assert dict(judge_half(rejected, "circle", language)) == {"half: right rejected": True}
    assert dict(judge_half(accepted, "line", language)) == {"half: near accepted": True}
    assert dict(judge_half(rejected, "line", language)) == {"half: near accepted": False}


def test_every_column_is_measured_as_far_as_there_are_people(recorded: RecordedSet) -> None:
    (chosen,) = draws(recorded, 1, 4, seed=1)
    several = draw_several(recorded, chosen, 5, 4, seed=1)
    found = list(measure(recorded, chosen, several, recorded, ratio=1.14))
    assert {column for column, _, _ in found} == {*COLUMNS} - {"5 people"}
    assert {name for _, name, _ in found} <= {*MEASURES}
    for column in {*COLUMNS} - {"5 people"}:
        asked = [name for of_column, name, _ in found if of_column == column]
        assert asked.count("nearest") == asked.count("DTW of both") == 4
        halves = 0 if column in ("same person", "another") else 4
        assert asked.count("half: far accepted") == halves
    right = [value for column, name, value in found if (column, name) == ("3 people", "nearest")]
    assert np.mean(right) > 0.5


def test_counts_of_all_draws_are_summed_up_and_kept() -> None:
    share = summarize("nearest", [[1, 1, 0], [], [1]])
    assert (share["share"], share["asked"], share["draws"]) == (0.75, 4, [[2, 3], [0, 0], [1, 1]])
    assert summarize(SIZE, [[1, 2, 3], [2]])["mean"] == 2.0


def test_forecasts_are_of_the_people_who_show_and_what_is_reached_of_the_others(
    recorded: RecordedSet,
) -> None:
    (chosen,) = draws(recorded, 1, 4, seed=1)
    several = draw_several(recorded, chosen, 3, 4, seed=1)
    alone, three = (count_outcomes(recorded, several, people) for people in (1, 3))
    assert not alone["foretold"]
    assert three["foretold"].total() == 3 * len(CLASSES)
    assert alone["reached"].total() == three["reached"].total() == 4
    assert three["foretold"]["right"] > 6


def test_a_table_says_by_how_much_forecasts_are_above_what_is_reached(
    recorded: RecordedSet, capsys: pytest.CaptureFixture[str]
) -> None:
    compare_forecasts(iter([recorded]), Namespace(draws=1, queries=4, seed=1))
    rows = capsys.readouterr().out.splitlines()
    (three,) = [row.split(" | ") for row in rows if row.startswith("| drawn | 3 people")]
    assert three[2] == "12 / 4"
    foretold, reached = (float(share.split("%")[0]) for share in three[3].split(" / "))
    assert float(three[-2]) == pytest.approx(foretold - reached, abs=0.1)
    (mean,) = [row for row in rows if row.startswith("3 people: foretold minus reached")]
    assert f"{foretold - reached:+.1f} points on average" in mean


def test_half_of_the_classes_that_is_chosen_leaves_out_what_is_alike(
    recorded: RecordedSet,
) -> None:
    # Three names for one figure, which are mixed up in every half that has two of them.
    alike = replace(
        recorded,
        recordings=[
            recording(SHAPES["circle" if label == "circle" else "line"], jitter=0.02, seed=seed)
            for seed, label in enumerate(recorded.labels)
        ],
    )
    shares = []
    for number, chosen in enumerate(draws(alike, 6, 1, seed=1)):
        several = draw_several(alike, chosen, 3, len(TAKES), seed=number)
        shares.append(measure_halves(alike, several, 12, seed=number))
    means = {name: np.mean([each[name] for each in shares]) for name in shares[0]}
    assert means["three people"] > 90 > means["random"]


def test_a_table_says_what_a_choice_gains_with_its_interval(
    recorded: RecordedSet, capsys: pytest.CaptureFixture[str]
) -> None:
    assert format_gain([1.0, 3.0]) == "+2.0 (+0.0 to +4.0)"
    compare_choices(iter([recorded]), Namespace(draws=2, queries=4, seed=1))
    head, _, row = capsys.readouterr().out.splitlines()
    assert len(row.split(" | ")) == len(head.split(" | "))
    assert row.startswith("| drawn | 2 |")
