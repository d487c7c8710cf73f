"""Choice: gestures that are mixed up are left out or replaced, and others stay."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from app.recognition import Gesture, Language, Recognizer
from app.recognition.explanation.context import KnownTake
from app.recognition.health import choice
from app.recognition.health.choice import (
    describe_people,
    find_replacements,
    join_candidates,
    measure_confusions,
)
from app.recognition.poses.sequence import FloatArray
from app.resources import samples_dir
from tests.recognition.explanation.test_causes import stairs
from tests.recognition.strategies import Shape, circle, line, recording, wedge

SHAPES: dict[str, Shape] = {"circle": circle, "line": line, "wedge": wedge}


def stretched(share: FloatArray) -> FloatArray:
    """Draw nearly a circle."""
    return np.asarray(circle(share) * (1.1, 1.0))


def shown(label: str, shape: Shape, seed: int = 0) -> Gesture:
    return Gesture.from_demonstration(label, recording(shape, jitter=0.01, seed=seed))


def language() -> Language:
    return Language("pool", [shown("ring", stretched), *(shown(*each) for each in SHAPES.items())])


def shown_by(people: int) -> Language:
    """Return a language in which `people` have shown every gesture, each in their own size."""
    gestures = []
    for label, shape in {"ring": stretched, **SHAPES}.items():
        gesture = replace(shown(label, shape), diver="0")
        for person in range(1, people):
            larger = partial(_resize, shape, 1 + 0.1 * person)
            poses = recording(larger, jitter=0.01, seed=person)
            gesture = gesture.with_demonstration(poses, str(person))
        gestures.append(gesture)
    return Language("pool", gestures)


def _resize(shape: Shape, size: float, share: FloatArray) -> FloatArray:
    return np.asarray(shape(share) * size)


@pytest.mark.parametrize("people", [1, 3])
def test_of_two_gestures_that_are_alike_one_is_left_out(people: int) -> None:
    confusions = measure_confusions(shown_by(people))
    kept = [confusions.labels[index] for index in confusions.choose(3)]
    assert {"line", "wedge"} < {*kept}
    worst, *others = confusions.list_pairs()
    assert {*worst.gestures} == {"ring", "circle"}
    assert worst.is_alike
    assert not any(each.is_alike for each in others)
    assert worst.rate > 2 * others[0].rate
    assert confusions.people == people
    assert worst.compared == (6 if people > 1 else 0)
    assert ("takes" if people > 1 else "distance") in worst.words


def test_exchange_finds_what_trying_all_finds(monkeypatch: pytest.MonkeyPatch) -> None:
    random = np.random.default_rng(0)
    rates = random.uniform(size=(9, 9)) ** 3
    labels = tuple(map(str, range(9)))
    confusions = choice.Confusions(labels, rates, rates, rates, rates[0], 1)

    def measure_cost(chosen: list[int]) -> float:
        return float(rates[np.ix_(chosen, chosen)].sum() / 4)

    best = measure_cost(confusions.choose(4))
    monkeypatch.setattr(choice, "MOST_TRIED", 0)
    exchanged = confusions.choose(4)
    assert len({*exchanged}) == 4
    assert measure_cost(exchanged) <= 1.1 * best
    assert confusions.choose(9) == list(range(9))


def test_gestures_that_stay_push_out_what_is_like_them() -> None:
    confusions = measure_confusions(language())
    ring, circle_at, line_at, wedge_at = range(4)
    assert confusions.labels[ring] == "ring"
    assert confusions.choose(2, fixed=[ring]) == [line_at, wedge_at]
    assert confusions.choose(9, fixed=[ring]) == [circle_at, line_at, wedge_at]


def test_people_are_counted_whose_demonstrations_others_repeat() -> None:
    alone = [replace(gesture, diver="Ann") for gesture in language().gestures]
    candidates = [shown("another", stairs)]
    joined = join_candidates(replace(language(), gestures=alone), candidates)
    assert measure_confusions(joined).people == 1


def test_a_candidate_never_takes_a_label_of_the_language() -> None:
    named = replace(shown("x", circle), label="candidate 0")
    joined = join_candidates(Language("pool", [named]), [shown("a", line), shown("b", wedge)])
    assert joined.labels[0] == "candidate 0"
    assert len({*joined.labels}) == 3


def test_known_takes_count_as_people_do() -> None:
    recognizer = Recognizer(language(), "full")
    takes = [
        KnownTake("line", recognizer.query(recording(wedge, jitter=0.01, seed=seed)))
        for seed in range(3)
    ]
    before, after = (measure_confusions(language(), known) for known in ((), takes))
    line_at, wedge_at = (language().labels.index(label) for label in ("line", "wedge"))
    assert after.rates[line_at, wedge_at] > 0.2 > 2 * before.rates[line_at, wedge_at]


def test_a_gesture_is_replaced_by_what_is_told_apart_best() -> None:
    candidates = [shown("a", stretched, seed=3), shown("b", stairs), shown("c", line, seed=4)]
    first, *others = find_replacements(language(), "ring", candidates)
    assert first.candidate == 1
    assert first.after < first.before
    assert first.alike == ()
    assert first.nearest is not None
    assert first.nearest.gestures[0] == "ring"
    assert not first.nearest.is_alike
    assert all(each.after >= first.after for each in others)
    # Another line is nearly alike to the line, by the name of the gesture that it would replace.
    again = [each for each in others if each.candidate == 2]
    assert all({*pair.gestures} == {"ring", "line"} for each in again for pair in each.alike)


def test_a_movement_far_from_all_others_is_proposed_first() -> None:
    # Among far gestures a language's own distances shrink, which is no fault of the far one.
    figures = Language.load(samples_dir() / "osg-table-2.json")
    own = [figures.gesture(label) for label in ("circle", "triangle", "three", "square")]
    candidates = [figures.gesture(label) for label in ("infinity", "sweep", "wedge")]
    first, *_ = find_replacements(Language("pool", own), "square", candidates)
    assert candidates[first.candidate].label == "sweep"


def test_gestures_without_a_demonstration_get_no_replacement() -> None:
    imported = [replace(each, trajectory=None) for each in language().gestures]
    candidates = [shown("a", stairs)]
    assert find_replacements(Language("images", imported), "ring", candidates) == ()


def test_a_language_without_confusions_needs_no_replacement() -> None:
    apart = Language("pool", [shown(*each) for each in SHAPES.items()])
    assert find_replacements(apart, "line", [shown("a", circle, seed=1)]) == ()


def test_twenty_gestures_by_three_people_cost_at_most_a_hundred_comparisons() -> None:
    gestures = [
        replace(gesture, label=f"{gesture.label} {copy}")
        for copy in range(5)
        for gesture in shown_by(3).gestures
    ]
    steps: list[int] = []
    measure_confusions(Language("large", gestures), advance=lambda: steps.append(1))
    assert len(gestures) == 20
    assert len(steps) <= 100
    candidates = [shown(f"candidate {seed}", wedge, seed) for seed in range(44)]
    steps.clear()
    large = Language("large", gestures)
    find_replacements(large, "line 0", candidates, advance=lambda: steps.append(1))
    assert 0 < len(steps) <= 100


def test_it_is_said_by_whose_demonstrations_confusions_are_known() -> None:
    assert "one person" in describe_people(1)
    assert "3 people" in describe_people(3)
