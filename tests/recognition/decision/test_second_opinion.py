"""The second opinion: another way of comparing, heard where arms and torso are seen."""

from dataclasses import replace

import numpy as np
import pytest

from app.recognition import Gesture, Language, PoseSequence, Recognizer
from app.recognition.decision.fusion import (
    AGREED,
    OPINION_EXPONENT,
    ORDER_RATIO,
    add_second_opinion,
)
from app.recognition.decision.result import ScoreTable
from app.recognition.gestures.profile import Tuning
from tests.recognition.strategies import SHAPES, circle, recording, square, wedge

NAMES = ("circle", "line", "square", "wedge")
ROW = "second_opinion"


def taught(weight: float = 1.0) -> Recognizer:
    gestures = [Gesture.from_demonstration(name, recording(SHAPES[name])) for name in NAMES]
    return Recognizer(Language("pool", gestures), tuning=Tuning(weights={ROW: weight}))


def without(poses: PoseSequence, *parts: str) -> PoseSequence:
    kept = [name for name in poses.landmarks if not any(part in name for part in parts)]
    return poses.select(kept)


def table(scores: list[float], opinion: list[float]) -> ScoreTable:
    """Return a table with these scores, and distances of the second opinion."""
    silent = taught(0.0)
    found = silent.compare(silent.query(recording(circle, jitter=0.02)))
    row = found.voters.index(ROW)
    distances = found.distances.copy()
    distances[row] = opinion
    return replace(
        found,
        distances=distances,
        contributions=found.contributions * (np.array(scores) / found.scores),
        turned=np.zeros(4),
        novelty_by_view=np.array([[0.5] * 4, [np.nan] * 4]),
    )


def test_it_knows_where_arms_go_and_neither_speed_nor_place() -> None:
    recognizer = taught()
    for name, shape in {"circle": circle, "square": square, "wedge": wedge}.items():
        moved = recording(shape, frames=95, rate=25, torso=60, centre=(200, 300), jitter=0.002)
        result = recognizer.recognize(moved)
        assert (result.label, result.votes[ROW]) == (name, name)
        assert 0 < result.weights[ROW] < 0.5
        assert sum(result.weights.values()) == pytest.approx(1)
        assert not result.disagreed


@pytest.mark.parametrize("parts", [("hip", "shoulder"), ("left_elbow",), ("left_wrist",)])
def test_it_abstains_without_a_torso_and_without_both_arms(parts: tuple[str, ...]) -> None:
    query = without(recording(circle, jitter=0.02), *parts)
    result, alone = (recogniser.recognize(query) for recogniser in (taught(), taught(0.0)))
    assert ROW not in result.votes
    np.testing.assert_array_equal(result.scores, alone.scores)
    assert (result.label, result.confidence) == (alone.label, alone.confidence)


def test_it_abstains_where_there_is_no_other_gesture() -> None:
    language = Language("one", [Gesture.from_demonstration("circle", recording(circle))])
    query = recording(circle, jitter=0.02)
    result = Recognizer(language).recognize(query)
    assert (result.label, ROW in result.votes) == ("circle", False)
    alone = Recognizer(language, tuning=Tuning(weights={ROW: 0.0})).recognize(query)
    np.testing.assert_array_equal(result.novelty, alone.novelty)


def test_it_adds_its_ratio_to_the_scores_and_releases_a_clear_take_that_it_names() -> None:
    before = table([0.5, 1.0, 2.0, 3.0], [0.3, 0.98, 0.98, 0.62])
    heard = add_second_opinion(before, 1.0)
    far = (1.0 / 0.32) ** OPINION_EXPONENT
    np.testing.assert_allclose(heard.scores, [0.5, far, 2 * far, 3 * 2**OPINION_EXPONENT])
    np.testing.assert_allclose(heard.novelty, [0.5 / AGREED, 0.5, 0.5, 0.5])
    np.testing.assert_allclose(heard.scores - before.scores, heard.contributions[5])
    outside = np.array([[(1 + AGREED) / 2] * 4, [np.nan] * 4])
    clear = add_second_opinion(replace(before, novelty_by_view=outside), 1.0)
    assert taught().decide(clear).label == "circle"
    close = table([0.5, 0.6, 2.0, 3.0], [0.3, 0.35, 0.98, 0.62])
    refused = add_second_opinion(replace(close, novelty_by_view=outside), 1.0)
    assert taught().decide(refused).outcome == "rejected"
    np.testing.assert_array_equal(refused.novelty, outside[0])


def test_it_chooses_among_gestures_that_are_about_as_near_and_no_other() -> None:
    within = (1 + ORDER_RATIO) / 2
    chosen = add_second_opinion(table([1.0, within, 2.0, 2.0], [0.9, 0.1, 0.9, 0.9]), 1.0)
    assert chosen.scores.argmin() == 1
    kept = add_second_opinion(table([1.0, 1.01 * ORDER_RATIO, 2.0, 2.0], [0.9, 0.1, 0.9, 0.9]), 1.0)
    assert kept.scores.argmin() == 0
    # The other is then about as near, so that the diver is asked.
    assert kept.scores[1] == pytest.approx(ORDER_RATIO * kept.scores[0])


def test_a_pair_of_which_it_names_the_other_is_told() -> None:
    recognizer = taught()
    asked = recognizer.decide(
        add_second_opinion(table([1.0, 1.01 * ORDER_RATIO, 2.0, 2.0], [0.9, 0.1, 0.9, 0.9]), 1.0)
    )
    assert (asked.pair, asked.votes[ROW], asked.disagreed) == (("circle", "line"), "line", True)
    agreed = recognizer.decide(
        add_second_opinion(table([1.0, 1.01, 2.0, 2.0], [0.3, 0.31, 0.9, 0.9]), 1.0)
    )
    assert (agreed.pair, agreed.disagreed) == (("circle", "line"), False)


def test_a_weight_factor_makes_it_louder_or_silent() -> None:
    before = table([0.5, 1.0, 2.0, 3.0], [0.3, 0.9, 0.9, 0.6])
    once, twice = (
        add_second_opinion(before, factor).scores / before.scores for factor in (1.0, 2.0)
    )
    np.testing.assert_allclose(twice, once**2)
    silent = add_second_opinion(before, 0.0)
    assert np.isinf(silent.distances[silent.voters.index(ROW)]).all()
    np.testing.assert_array_equal(silent.scores, before.scores)
    assert [taught(factor).vote.weights[ROW] for factor in (0.0, 1.0)] == pytest.approx(
        [0.0, OPINION_EXPONENT / (1 + OPINION_EXPONENT)]
    )
