"""Neighbours: a large language is checked in linear time, and its confusions are still found."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from app.recognition import Gesture, Language, Recognizer
from app.recognition.health import check, neighbours
from app.recognition.health.check import check_health
from app.recognition.health.neighbours import (
    MOST_TOGETHER,
    NEIGHBOURS,
    find_neighbours,
    measure_step_distances,
)
from app.recognition.health.simulated_trials import simulate_trials
from app.recognition.poses.sequence import FloatArray
from tests.recognition.demonstrations import pool, shown
from tests.recognition.strategies import Shape, circle


def lissajous(across: int, down: int, phase: float) -> Shape:
    """Return a figure of so many turns across and down."""

    def figure(time: FloatArray) -> FloatArray:
        turn = 2 * np.pi * time
        x, y = np.sin(across * turn + phase), np.cos(down * turn)
        return np.stack([-0.7 + 0.4 * x, 0.4 * y], axis=-1)

    return figure


def figures(count: int) -> Iterator[Gesture]:
    """Make gestures of different figures; the last one repeats the first one."""
    for index in range(count - 1):
        shape = lissajous(1 + index % 5, 1 + index // 5 % 5, 0.4 * (index // 25))
        yield shown(f"figure {index}", shape)
    yield shown("again", lissajous(1, 1, 0.0))


@pytest.fixture(scope="module")
def large() -> Language:
    return Language("large", [*figures(MOST_TOGETHER + 6)])


def test_a_small_language_is_compared_as_a_whole() -> None:
    language = Language("small", [*figures(4)])
    np.testing.assert_array_equal(find_neighbours(Recognizer(language, "full")), [[0, 1, 2, 3]] * 4)


def test_each_gesture_of_a_large_language_has_itself_and_its_nearest(large: Language) -> None:
    found = find_neighbours(Recognizer(large, "full"))
    assert found.shape == (len(large.gestures), NEIGHBOURS + 1)
    for index, rivals in enumerate(found.tolist()):
        assert index in rivals
        assert rivals == sorted(set(rivals))
    assert len(large.gestures) - 1 in found[0]


def test_takes_score_among_neighbours_as_in_the_whole_language(
    large: Language, monkeypatch: pytest.MonkeyPatch
) -> None:
    recognizer = Recognizer(large, "full")
    narrowed = simulate_trials(recognizer, 2, gestures=[0, 7])
    monkeypatch.setattr(neighbours, "MOST_TOGETHER", len(large.gestures))
    whole = simulate_trials(recognizer, 2, gestures=[0, 7])
    for row in range(2):
        np.testing.assert_allclose(
            narrowed.scores[row], whole.scores[row][:, narrowed.rivals[row]], rtol=1e-12
        )
    np.testing.assert_allclose(narrowed.novelty, whole.novelty)


@pytest.mark.slow
def test_what_is_confused_in_the_whole_language_is_found_among_neighbours(
    large: Language, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(check, "MOST_REMEDIED", 0)
    report = check_health(large, takes=2)
    assert report.neighbours == NEIGHBOURS
    assert "neighbours_only" in {finding.code for finding in report.findings}
    assert len(report.pairs) <= len(large.gestures) * NEIGHBOURS
    monkeypatch.setattr(neighbours, "MOST_TOGETHER", len(large.gestures))
    whole = check_health(large, takes=2)
    assert whole.neighbours is None

    def confused(pairs: object) -> set[tuple[str, str]]:
        assert isinstance(pairs, tuple)
        return {each.gestures for each in pairs if each.confusion and each.confusion.rate > 0.05}

    assert ("figure 0", "again") in confused(report.pairs)
    # The nearest are found without alignment: a few pairs that are confused are not among them.
    assert confused(report.pairs) <= confused(whole.pairs)
    assert len(confused(report.pairs)) > 0.7 * len(confused(whole.pairs))


def test_many_gestures_alike_get_findings_for_the_worst_pairs_alone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(check, "MOST_REMEDIED", 0)
    monkeypatch.setattr(check, "MOST_EXPLAINED", 2)
    one = next(figures(2))
    language = Language("alike", [replace(one, label=f"{index}") for index in range(4)])
    report = check_health(language, takes=2)
    codes = [finding.code for finding in report.findings]
    assert codes.count("duplicate") == 2
    assert codes.count("more_confused") == 1
    assert any(finding.message.startswith("4 further pairs") for finding in report.findings)


def test_a_gesture_without_demonstration_is_no_rival_that_counts(large: Language) -> None:
    drawn = replace(large.gestures[3], trajectory=None)
    language = replace(large, gestures=[*large.gestures[:3], drawn, *large.gestures[4:]])
    trials = simulate_trials(Recognizer(language, "full"), 2, gestures=[3, 0])
    assert trials.gestures.tolist() == [0]
    assert trials.performer(3) is None
    assert trials.performer(0) == 0


def test_gestures_of_pictures_alone_are_infinitely_far() -> None:
    (drawn,) = pool(circle=circle).gestures
    pictures = [
        Gesture(label=label, salient=drawn.salient, image=drawn.image) for label in ("one", "two")
    ]
    assert np.isinf(measure_step_distances(Recognizer(Language("pool", pictures), "full"))).all()
