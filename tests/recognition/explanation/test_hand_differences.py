"""Hand differences: which finger is to blame, and what the explanation of a held shape says."""

import numpy as np
import pytest

from app.recognition import Gesture, Language, RecognitionContext, Recognizer, explain
from app.recognition.decision.hand_references import HeldShapes
from app.recognition.explanation.hand_differences import find_held_difference, measure_bends
from app.recognition.poses.frame import HandShape
from app.recognition.poses.sequence import PoseSequence
from tests.recognition.held_takes import CURLED, FIST, FLAT, TWO, fingers, follow, hold
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


def difference(shapes: HeldShapes, shown: HeldShapes) -> str:
    """Return in words how held hands differ from those of 'go'."""
    found = find_held_difference("go", shapes, shown)
    assert found is not None
    assert found.share > 0.1
    return found.words


def explained(language: Language, poses: PoseSequence, expected: str) -> str:
    context = RecognitionContext(recognizer=Recognizer(language), poses=poses, whole=poses)
    explanation = explain(context, expected)
    against = sum(voter.against for voter in explanation.breakdown) + explanation.turned
    if explanation.margin == explanation.margin and abs(explanation.margin) < float("inf"):
        assert against + explanation.margin == pytest.approx(0, abs=1e-9)
    return explanation.sentence[0].lower() + explanation.sentence[1:]


def test_the_bent_finger_is_named_with_its_degrees() -> None:
    words = difference(((shape(fingers(0)),),), ((shape(TWO),),))
    assert words.startswith("the middle finger is bent ")
    assert words.endswith("degrees more than in 'go'")


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
    words = difference(((hand.turn(60),),), ((hand,),))
    assert words == "the hand is turned by 60 degrees clockwise"


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
    assert "is not seen moving" in explained(mixed, hold(FIST, seed=2), "circle")


SEQUENCE = ((shape(FLAT),), (shape(FIST),))


@pytest.mark.parametrize(
    ("shapes", "words"),
    [
        ((), "no hand holds two shapes in this take, and 'go' is two in sequence"),
        (SEQUENCE[:1], "the second shape is missing: 'go' is two in sequence"),
        (SEQUENCE[1:], "the first shape is missing: 'go' is two in sequence"),
        ((((shape(TWO).turn(90)),),), "one hand shape is held in this take, and 'go' is two in "),
        (SEQUENCE[::-1], "the shapes come in the other order than in 'go'"),
    ],
)
def test_what_a_sequence_lacks_is_told_first(
    shapes: tuple[tuple[HandShape, ...], ...], words: str
) -> None:
    assert difference(shapes, SEQUENCE).startswith(words)


def test_a_wrong_finger_is_told_with_the_shape_in_which_it_is_wrong() -> None:
    shown = ((shape(FIST),), (shape(TWO),))
    for seen, ordinal in (
        ((shape(FIST), shape(fingers(0))), "second"),
        ((shape(fingers(1)), shape(TWO)), "first"),
    ):
        words = difference([(hand,) for hand in seen], shown)
        assert words.startswith(f"in the {ordinal} shape the middle finger is bent ")
    mirrored = [(hand.mirror(),) for hand in (shape(FIST), shape(fingers(0)))]
    assert difference(mirrored, shown).startswith("in the second shape the middle finger is bent ")


def test_of_two_wrong_shapes_the_farther_one_is_told() -> None:
    shown = ((shape(TWO),), (shape(FLAT),))
    seen = ((shape(TWO).turn(40),), (shape(FLAT).turn(90),))
    words = difference(seen, shown)
    assert words == "in the second shape the hand is turned by 90 degrees clockwise"


def test_the_same_sequence_differs_in_nothing() -> None:
    assert find_held_difference("go", SEQUENCE, SEQUENCE) is None


def test_a_sequence_is_explained_beside_its_single_shapes(language: Language) -> None:
    go = Gesture.from_demonstration("go", follow(hold(FLAT), hold(FIST)))
    beside = Language(name="signs", gestures=[*language.gestures, go])
    swapped, alone = follow(hold(FIST, seed=3), hold(FLAT, seed=4)), hold(FLAT, seed=3)
    assert "the shapes come in the other order" in explained(beside, swapped, "go")
    assert "the second shape is missing" in explained(beside, alone, "go")
    assert "two hand shapes are held one after the other" in explained(beside, swapped, "fist")
    assert "as expected" in explained(beside, follow(hold(FLAT, seed=5), hold(FIST)), "go")


def test_a_refused_sequence_is_not_offered_as_a_demonstration(
    language: Language,
) -> None:
    go = Gesture.from_demonstration("go", follow(hold(FLAT), hold(FIST)))
    poses = follow(hold(FIST, seed=3), hold(FLAT, seed=4))
    recognizer = Recognizer(Language(name="signs", gestures=[*language.gestures, go]))
    found = explain(
        RecognitionContext(recognizer=recognizer, poses=poses, whole=poses), "go"
    ).counterfactuals
    assert "further_demonstration" not in {each.change.kind for each in found}
