"""Hand differences: which finger is to blame, and what the explanation of a held shape says."""

import numpy as np
import pytest

from app.recognition import Gesture, Language, RecognitionContext, Recognizer, explain
from app.recognition.explanation.hand_differences import find_hand_differences, measure_bends
from app.recognition.poses.hand_shape import HandShape
from app.recognition.poses.sequence import PoseSequence
from tests.recognition.held_takes import CURLED, FIST, FLAT, TWO, fingers, hold
from tests.recognition.parametric_hand import Finger, Fingers, hand_xy


def shape(made: Fingers) -> HandShape:
    return HandShape.of_frames("right", hand_xy(made)[None])


@pytest.fixture(scope="module")
def language() -> Language:
    shapes = {"stop": FLAT, "fist": FIST, "two": TWO}
    return Language(
        name="signs",
        gestures=[Gesture.from_demonstration(label, hold(each)) for label, each in shapes.items()],
    )


def explained(language: Language, poses: PoseSequence, expected: str) -> str:
    context = RecognitionContext(recognizer=Recognizer(language), poses=poses, whole=poses)
    explanation = explain(context, expected)
    against = sum(verdict.against for verdict in explanation.verdicts) + explanation.turned
    if explanation.margin == explanation.margin and abs(explanation.margin) < float("inf"):
        assert against + explanation.margin == pytest.approx(0, abs=1e-9)
    return explanation.sentence


def test_the_bent_finger_is_named_with_its_degrees() -> None:
    first, *others = find_hand_differences("two", (shape(fingers(0)),), (shape(TWO),))
    assert first.kind == "hand_shape"
    assert first.words.startswith("the middle finger is bent ")
    assert first.words.endswith("degrees more than in 'two'")
    assert all(other.share <= first.share for other in others)


@pytest.mark.parametrize("bend", [0.0, 60.0, 120.0])
def test_the_bend_of_a_finger_is_estimated(bend: float) -> None:
    third = bend / 3
    bent = Finger(0.0, CURLED)
    made = (Finger(8.0, (third, third, third)), bent, bent, bent)
    measured = measure_bends(shape(made))
    assert measured[0] == pytest.approx(bend, abs=30)
    assert measured[1:].min() > 130


def test_a_turned_hand_is_told_with_its_turn() -> None:
    hand = shape(TWO)
    (first, *_) = find_hand_differences("two", (hand.turn(60),), (hand,))
    assert first.words == "the hand is turned by 60 degrees clockwise"


def test_a_refused_shape_is_explained(language: Language) -> None:
    sentence = explained(language, hold(fingers(0), seed=4), "two")
    assert "the middle finger is bent" in sentence


def test_a_movement_instead_of_a_held_shape_is_explained(language: Language) -> None:
    around = np.linspace(0, 2 * np.pi, 40)
    circle = hold(FLAT, moving=0.4 * np.column_stack([np.cos(around), np.sin(around)]))
    mixed = Language(
        name="mixed", gestures=[*language.gestures, Gesture.from_demonstration("circle", circle)]
    )
    assert "no hand holds a shape" in explained(mixed, circle, "fist")
    assert "'fist'" in explained(mixed, hold(FIST, seed=2), "circle")
