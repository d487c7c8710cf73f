"""Asking back: a take between two gestures is answered with both, one between more with none."""

import random
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition import Gesture, Language, Recognition, Recognizer
from app.recognition.decision.outcome import ASK_RATIO, SURE, find_answer
from app.recognition.gestures.profile import Tuning
from tests.recognition.strategies import circle, line, recording, square, wedge

WITHIN, BEYOND = (1 + ASK_RATIO) / 2, 2 * ASK_RATIO - 1

shares = st.lists(
    st.tuples(st.floats(0.01, 10), st.one_of(st.floats(0, 2), st.just(np.nan))),
    min_size=1,
    max_size=8,
    unique_by=lambda each: each[0],
)


def split(measured: list[tuple[float, float]]) -> tuple[np.ndarray, np.ndarray]:
    scores, novelty = zip(*measured, strict=True)
    return np.array(scores), np.array(novelty)


@given(shares)
def test_the_answer_is_the_nearest_gestures_unless_the_nearest_is_rejected(
    measured: list[tuple[float, float]],
) -> None:
    scores, novelty = split(measured)
    answer = find_answer(scores, novelty)
    nearest = int(scores.argmin())
    assert bool(answer) == bool(not novelty[nearest] > 1)
    assert sorted(answer, key=lambda index: scores[index]) == list(answer)
    if answer:
        assert set(answer) == set(np.flatnonzero(scores <= ASK_RATIO * scores[nearest]))


@given(shares, st.randoms(use_true_random=False))
def test_a_second_opinion_makes_no_pair_an_answer_and_no_refusal_a_command(
    measured: list[tuple[float, float]], draw: random.Random
) -> None:
    scores, novelty = split(measured)
    opinion = draw.randrange(len(scores))
    alone, heard = find_answer(scores, novelty), find_answer(scores, novelty, opinion)
    assert heard[:1] == alone[:1]
    assert len(heard) != 1 or len(alone) == 1
    if len(heard) == 2 and opinion in alone[1:]:
        assert heard[1] == opinion


def test_a_far_take_must_be_clearer_where_both_opinions_are_heard() -> None:
    scores = np.array([1.0, 1.2 * ASK_RATIO])
    near, far = np.array([0.3, 0.4]), np.array([1.0, 1.3])
    assert find_answer(scores, near, 0) == find_answer(scores, far) == (0,)
    assert find_answer(scores, far, 0) == (0, 1)


def test_where_the_opinions_differ_the_diver_is_asked_for_these_two() -> None:
    scores = np.array([1.0, ASK_RATIO - 0.02, ASK_RATIO - 0.01])
    assert find_answer(scores, np.full(3, 0.3), 2) == (0, 2)
    assert find_answer(scores, np.full(3, 0.3), 0) == (0, 1, 2)


@given(shares, st.integers(-20, 20))
def test_the_unit_of_the_scores_does_not_matter(
    measured: list[tuple[float, float]], exponent: int
) -> None:
    scores, novelty = split(measured)
    assert find_answer(2.0**exponent * scores, novelty) == find_answer(scores, novelty)


@given(shares, st.randoms(use_true_random=False))
def test_the_order_of_the_gestures_does_not_matter(
    measured: list[tuple[float, float]], draw: random.Random
) -> None:
    order = draw.sample(range(len(measured)), len(measured))
    scores, novelty = split(measured)
    moved = find_answer(scores[order], novelty[order])
    assert tuple(order[index] for index in moved) == find_answer(scores, novelty)


@pytest.fixture(scope="module")
def recognizer() -> Recognizer:
    shapes = {"circle": circle, "line": line, "square": square, "wedge": wedge}
    gestures = [Gesture.from_demonstration(name, recording(shapes[name])) for name in shapes]
    alone = Tuning(weights={"second_opinion": 0.0})
    return Recognizer(Language("pool", gestures), tuning=alone)


def decide(recognizer: Recognizer, *scores: float, far: tuple[int, ...] = ()) -> Recognition:
    """Decide on a take with these scores, as far as it may be from no gesture but `far`."""
    table = recognizer.compare(recognizer.query(recording(circle, jitter=0.02)))
    share = np.array(scores) / table.scores
    novelty = np.full(table.novelty_by_view.shape, 0.5)
    novelty[:, list(far)] = 1.5
    changed = replace(
        table,
        contributions=table.contributions * share,
        turned=table.turned * share,
        novelty_by_view=novelty,
    )
    return recognizer.decide(changed)


def test_one_gesture_is_the_label_two_are_a_pair_and_three_a_rejection(
    recognizer: Recognizer,
) -> None:
    one = decide(recognizer, BEYOND, 1.0, BEYOND, 9.0)
    assert (one.label, one.pair, one.outcome) == ("line", None, "recognized")
    two = decide(recognizer, BEYOND, 1.0, WITHIN, 9.0)
    assert (two.label, two.pair, two.outcome) == (None, ("line", "square"), "pair")
    three = decide(recognizer, WITHIN, 1.0, WITHIN + 0.01, 9.0)
    assert (three.label, three.pair, three.outcome) == (None, None, "rejected")
    assert three.between == ("line", "circle", "square")
    assert {each.nearest for each in (one, two, three)} == {"line"}


def test_a_take_beyond_the_limit_is_rejected_and_not_asked_about(recognizer: Recognizer) -> None:
    assert decide(recognizer, 9.0, 1.0, WITHIN, 9.0, far=(2,)).pair == ("line", "square")
    rejected = decide(recognizer, 9.0, 1.0, WITHIN, 9.0, far=(1,))
    assert (rejected.label, rejected.pair, rejected.between) == (None, None, ())


def test_no_take_is_accepted_at_a_lower_confidence_than_one_that_is_asked_back(
    recognizer: Recognizer,
) -> None:
    surely = decide(recognizer, 1.0, 9.0, 9.0, 9.0).confidence
    hardly = decide(recognizer, 1.0, BEYOND, 9.0, 9.0).confidence
    asked = [decide(recognizer, 1.0, ratio, 9.0, 9.0).confidence for ratio in (1.0, WITHIN)]
    assert max(asked) <= SURE <= hardly < surely


def test_profile_paper_answers_with_one_label(recognizer: Recognizer) -> None:
    result = Recognizer(recognizer.language, "paper").recognize(recording(circle))
    assert (result.label, result.pair) == (result.nearest, None)
