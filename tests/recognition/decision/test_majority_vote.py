"""Majority vote: of several demonstrations the nearest one counts, voter by voter."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from app.recognition import Gesture, Language, Recognizer
from tests.recognition.strategies import SHAPES, circle, recording, square, wedge


def gesture(label: str, *, hand: str = "right_wrist") -> Gesture:
    return Gesture.from_demonstration(label, recording(SHAPES[label], jitter=0.01, hand=hand))


@given(
    st.lists(st.sampled_from(sorted(SHAPES)), min_size=1, max_size=4),
    st.lists(st.integers(1, 3), min_size=4, max_size=4),
    st.sampled_from(sorted(SHAPES)),
)
@settings(max_examples=25, deadline=None)
def test_a_gestures_distance_is_that_of_its_nearest_demonstration(
    shapes: list[str], counts: list[int], shown: str
) -> None:
    gestures = []
    for number, (shape, count) in enumerate(zip(shapes, counts, strict=False)):
        made = Gesture.from_demonstration(f"gesture {number}", recording(SHAPES[shape]))
        for seed in range(1, count):
            made = made.with_demonstration(recording(SHAPES[shape], jitter=0.02, seed=seed))
        gestures.append(made)
    query = recording(SHAPES[shown], jitter=0.02, seed=9)
    found = Recognizer(Language("pool", gestures), "paper").recognize(query).distances
    for column, several in enumerate(gestures):
        alone = [
            Recognizer(Language("one", [each]), "paper").recognize(query).distances[:, 0]
            for each in several.single_demonstrations()
        ]
        np.testing.assert_allclose(found[:, column], np.min(alone, axis=0), atol=1e-9)


def test_a_second_demonstration_makes_its_figure_known() -> None:
    one = gesture("circle")
    language = Language("pool", [one, gesture("line")])
    query = recording(square, jitter=0.01, seed=3)
    before = Recognizer(language, "paper").recognize(query)
    both = one.with_demonstration(recording(square, jitter=0.01))
    after = Recognizer(Language("pool", [both, gesture("line")]), "paper").recognize(query)
    assert after.label == "circle"
    assert (after.distances[:, 0] <= before.distances[:, 0]).all()
    assert (after.distances[:, 0] < before.distances[:, 0]).any()


def test_a_demonstration_with_the_other_hand_is_recognised_with_that_hand() -> None:
    both = gesture("circle").with_demonstration(recording(circle, hand="left_wrist"))
    recognizer = Recognizer(Language("pool", [both, gesture("wedge")]), "paper")
    left = recognizer.recognize(recording(circle, hand="left_wrist", jitter=0.01))
    assert left.label == "circle"
    right = recognizer.recognize(recording(wedge, jitter=0.01))
    assert right.label == "wedge"
