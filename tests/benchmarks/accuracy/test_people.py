"""Several people's demonstrations: what they foretell, reach, and choose."""

from dataclasses import replace

import numpy as np
import pytest

from app.recognition.health.forecast import OUTCOMES
from benchmarks.accuracy.people import (
    CONFIDENCES,
    define,
    measure_choice,
    measure_halves,
    measure_people,
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


def test_a_gesture_has_a_demonstration_and_a_diver_for_each_take(recorded: RecordedSet) -> None:
    shown = define(recorded, [0, 1, 12]).single_demonstrations()
    assert [each.diver for each in shown] == ["a", "a", "b"]


def test_forecasts_are_of_the_people_who_show_and_what_is_reached_of_the_others(
    recorded: RecordedSet,
) -> None:
    figures = {each.name: each for each in measure_people(recorded, quick=True)}
    assert "foretold/1/right" not in figures
    assert figures["foretold/3/right"].n == 2 * 3 * len(CLASSES)
    assert figures["foretold/3/right"].value > 0.5
    foretold, reached = figures["foretold/3/right"], figures["reached/3/right"]
    above = 100 * (foretold.value - reached.value)
    assert figures["above/3"].value == pytest.approx(above)
    assert abs(figures["above/3"].value) <= figures["single/3"].value + 1e-9
    for people in ("1", "3"):
        asked = [figures[f"reached/{people}/{each}"] for each in OUTCOMES]
        assert sum(each.value for each in asked) == pytest.approx(1)
        # Four people: of a language by three the fourth one's twelve takes are asked about.
        assert {each.n for each in asked} == {2 * 12}


def test_fewer_takes_go_live_with_more_confidence(recorded: RecordedSet) -> None:
    figures = {each.name: each.value for each in measure_people(recorded, quick=True)}
    live = [figures[f"live/1/right-from-{least}"] for least in CONFIDENCES]
    assert live == sorted(live, reverse=True)
    assert live[0] == figures["reached/1/right"]


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
    assert means["three-people"] > 0.9 > means["random"]


def test_a_choice_gains_the_mean_over_its_draws(recorded: RecordedSet) -> None:
    figures = {each.name: each for each in measure_choice(recorded, quick=True)}
    gain = figures["three-people"].value - figures["random"].value
    assert figures["gain"].value == pytest.approx(100 * gain)
    assert figures["gain"].n == 6
