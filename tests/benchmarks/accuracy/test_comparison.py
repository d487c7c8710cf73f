"""Comparison of methods: what counts, and methods that others write."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from app.recognition import PoseError, PoseSequence
from benchmarks.accuracy.comparison import (
    Language,
    MethodError,
    draw_languages,
    judge,
    measure,
)
from benchmarks.methods import find_method
from benchmarks.methods.base import Demonstration, Method, Prediction
from benchmarks.sets.recorded_sets import RecordedSet
from tests.conftest import ROOT


@pytest.fixture(scope="module")
def swipes(drawn: dict[str, RecordedSet]) -> list[Language]:
    recorded = drawn["swipes"]
    return [*draw_languages(recorded, recorded, 2, 8, seed=1)]


class Fixed(Method):
    """Says the same of every take."""

    said: Prediction | Exception = Prediction()

    def fit(self, demonstrations: Sequence[Demonstration]) -> None:
        """Learn nothing."""

    def predict(self, take: PoseSequence) -> Prediction:
        """Say it."""
        if isinstance(self.said, Exception):
            raise self.said
        return self.said


def saying(said: Prediction | Exception) -> type[Fixed]:
    return type("Saying", (Fixed,), {"said": said})


@pytest.mark.parametrize(
    ("said", "label", "known", "outcome"),
    [
        (Prediction("left"), "left", True, "right"),
        (Prediction("left"), "right", True, "wrong"),
        (Prediction(pair=("left", "right")), "right", True, "asked"),
        (Prediction(distances={"left": 1.0}), "left", True, "refused"),
        (Prediction("left"), "up", False, "answered"),
        (Prediction(pair=("left", "right")), "up", False, "asked"),
        (Prediction(), "", False, "refused"),
    ],
)
def test_what_a_prediction_counts_as(
    said: Prediction, label: str, known: bool, outcome: str
) -> None:
    assert judge(said, label, known) == outcome


@pytest.mark.parametrize(
    ("said", "nearest"),
    [
        (Prediction("a", distances={"a": 2.0, "b": 1.0}), "a"),
        (Prediction(pair=("b", "a")), "b"),
        (Prediction(distances={"a": 2.0, "b": 1.0}), "b"),
        (Prediction(), None),
    ],
)
def test_the_nearest_is_the_answer_or_at_the_smallest_distance(
    said: Prediction, nearest: str | None
) -> None:
    assert said.nearest == nearest


def test_people_who_demonstrate_are_asked_only_as_the_same_person(
    drawn: dict[str, RecordedSet],
) -> None:
    recorded = drawn["swipes"]
    owner = {
        id(poses): str(who) for poses, who in zip(recorded.recordings, recorded.people, strict=True)
    }
    for language in draw_languages(recorded, recorded, 3, 8, seed=2):
        shown = {each.person for each in language.demonstrations}
        for relation in language.takes.keys() - {"far"}:
            asked = {owner[id(take.poses)] for take in language.takes[relation]}
            assert asked <= shown if relation == "same" else asked.isdisjoint(shown)


def test_a_language_of_three_people_has_each_gesture_three_times(swipes: list[Language]) -> None:
    (three,) = (each for each in swipes[:3] if "another-3" in each.takes)
    shown = Counter(each.label for each in three.demonstrations)
    assert {*shown.values()} == {3}
    assert len({each.person for each in three.demonstrations}) == 3


def test_a_take_that_cannot_be_compared_counts_as_refused(swipes: list[Language]) -> None:
    outcomes = measure(saying(PoseError("no hand")), swipes)
    assert set(outcomes.counts["same"]) == {"refused"}
    assert outcomes.nearest["same"][True] == 0


@pytest.mark.parametrize(
    ("said", "words"),
    [
        (Prediction("circle"), "'circle' is not in the language: left, right, up"),
        (Prediction(pair=("left", "circle")), "'circle'"),
        (Prediction(distances={"left": float("nan")}), "a distance is NaN"),
        (Prediction("left", confidence=95), "the confidence 95 is not in [0, 1]"),
        (ZeroDivisionError("of a size"), "ZeroDivisionError of `predict` (test_comparison.py"),
    ],
)
def test_a_method_that_fails_is_named_with_its_reason(
    swipes: list[Language], said: Prediction | Exception, words: str
) -> None:
    with pytest.raises(MethodError, match=re.escape(words)):
        measure(saying(said), swipes)


def test_the_documented_method_has_its_row(
    swipes: list[Language], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    page = (ROOT / "docs" / "bench.md").read_text("utf-8")
    (code,) = re.findall(r"```python\n# nearest_path\.py\n(.*?)```", page, re.DOTALL)
    (tmp_path / "nearest_path.py").write_text(code, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    outcomes = measure(find_method("nearest_path:NearestPath"), swipes)
    assert sum(outcomes.counts["another-1"].values()) == 16
    assert np.isfinite(outcomes.predicting).all()


@pytest.mark.parametrize(
    ("name", "error"),
    [("nowhere:Method", ModuleNotFoundError), ("benchmarks.methods.ours:Nothing", AttributeError)],
)
def test_a_method_that_is_not_there_is_not_found(name: str, error: type[Exception]) -> None:
    with pytest.raises(error):
        find_method(name)
