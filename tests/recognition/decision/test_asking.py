"""Asking back: a take between two gestures is answered with both, one between more with none."""

import random
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition import Gesture, Language, Recognition, Recognizer
from app.recognition.decision.rejection import ASK_RATIO, find_answer
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
def test_the_answer_is_the_nearest_gestures_and_none_that_is_rejected(
    measured: list[tuple[float, float]],
) -> None:
    scores, novelty = split(measured)
    answer = find_answer(scores, novelty)
    accepted = ~(novelty > 1)
    nearest = int(scores.argmin())
    assert bool(answer) == accepted[nearest]
    assert answer[:1] == ((nearest,) if answer else ())
    assert sorted(answer, key=lambda index: scores[index]) == list(answer)
    if answer:
        meant = {
            index
            for index in range(len(scores))
            if accepted[index] and scores[index] <= ASK_RATIO * scores[nearest]
        }
        assert set(answer) == meant


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
    return Recognizer(Language("pool", gestures))


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


def test_a_gesture_that_is_rejected_is_not_asked_for(recognizer: Recognizer) -> None:
    assert decide(recognizer, 9.0, 1.0, WITHIN, 9.0, far=(2,)).label == "line"
    rejected = decide(recognizer, 9.0, 1.0, WITHIN, 9.0, far=(1,))
    assert (rejected.label, rejected.pair, rejected.between) == (None, None, ())


def test_profile_paper_answers_with_one_label(recognizer: Recognizer) -> None:
    result = Recognizer(recognizer.language, "paper").recognize(recording(circle))
    assert (result.label, result.pair) == (result.nearest, None)
