"""Moving shapes: gestures that are one movement with two hand shapes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.recognition import Gesture, Language, PoseSequence, Recognizer
from app.recognition.gestures.profile import Tuning
from app.recognition.gestures.switches import Switch, Switches
from app.recognition.voters.registry import HAND_VOTER_NAMES, VOTER_NAMES
from tests.recognition.held_takes import FIST, FLAT, TWO, hold
from tests.recognition.moving_takes import circle, corner, draw, without_hands


def gesture(label: str, poses: PoseSequence, hand_shape: Switch = "auto") -> Gesture:
    made = Gesture.from_demonstration(label, poses)
    return replace(made, switches=Switches(hand_shape=hand_shape))


def twins(first: Switch = "on", second: Switch = "on") -> Language:
    return Language(
        "twins",
        [
            gesture("fist", draw(FIST, circle()), first),
            gesture("flat", draw(FLAT, circle(0.42), seed=1), second),
            gesture("corner", draw(FLAT, corner(), seed=2)),
        ],
    )


def counts(language: Language, label: str) -> bool:
    counting = Recognizer(language).sensitivity(label)
    assert counting is not None
    return counting.hand_shape


@pytest.mark.parametrize("turning", [0.0, 25.0])
def test_the_hand_shape_decides_between_twins(turning: float) -> None:
    recognizer = Recognizer(twins())
    for shape, label in ((FIST, "fist"), (FLAT, "flat")):
        for seed in (5, 6, 7):
            query = draw(shape, circle(0.41), seed=seed, turning=turning, roll=15.0)
            assert recognizer.recognize(query).label == label


def test_a_shape_that_neither_twin_has_is_refused() -> None:
    result = Recognizer(twins()).recognize(draw(TWO, circle(0.41), seed=5))
    assert result.label is None
    assert result.nearest in ("fist", "flat")
    assert result.novelty_by_view["hand"][result.gestures.index(result.nearest)] > 1
    assert result.novelty_by_view["movement"][result.gestures.index(result.nearest)] < 1


@pytest.mark.parametrize(
    ("switches", "decided"),
    [(("auto", "auto"), False), (("on", "auto"), False), (("off", "auto"), True)],
)
def test_the_shape_of_one_demonstration_counts_only_if_it_is_meant(
    switches: tuple[Switch, Switch], decided: bool
) -> None:
    language = twins(*switches)
    counting = [counts(language, label) for label in language.labels]
    assert counting == [*(switch == "on" for switch in switches), False]
    assert Recognizer(language).undecided_twins == (() if decided else (("fist", "flat"),))


def test_without_a_twin_hands_change_nothing() -> None:
    shown = [("circle", draw(FIST, circle())), ("corner", draw(FLAT, corner(), seed=2))]
    seeing, blind = (
        Recognizer(Language("pool", [gesture(label, of(poses)) for label, poses in shown]))
        for of in (lambda poses: poses, without_hands)
    )
    for query in (draw(FLAT, circle(0.41), seed=5), draw(TWO, corner(0.7), seed=6)):
        result = seeing.recognize(query)
        assert result.voters == VOTER_NAMES
        assert result.to_dict() == blind.recognize(without_hands(query)).to_dict()


def test_the_same_movement_with_the_same_shape_is_no_twin() -> None:
    alike = [
        gesture("one", draw(FLAT, circle())),
        gesture("other", draw(FLAT, circle(0.42), seed=1, roll=10.0)),
    ]
    assert not counts(Language("pool", alike), "one")


def test_switched_off_the_shape_is_not_looked_at() -> None:
    language = twins("off", "off")
    assert not counts(language, "fist")
    assert Recognizer(language).recognize(draw(TWO, circle())).voters == VOTER_NAMES


def test_switched_on_the_shape_counts_without_a_twin() -> None:
    language = Language(
        "pool",
        [gesture("fist", draw(FIST, circle()), "on"), gesture("corner", draw(FLAT, corner()))],
    )
    recognizer = Recognizer(language)
    assert recognizer.recognize(draw(FIST, circle(0.41), seed=5)).label == "fist"
    refused = recognizer.recognize(draw(FLAT, circle(0.41), seed=5))
    assert (refused.label, refused.nearest, refused.fault) == (None, "fist", None)
    assert recognizer.recognize(draw(FIST, corner(), seed=5)).label == "corner"


def test_twins_without_a_hand_are_refused_naming_both() -> None:
    query = without_hands(draw(FIST, circle(0.41), seed=5))
    result = Recognizer(twins()).recognize(query)
    # Beside shapes that count, the second opinion abstains.
    alone = Tuning(weights={"second_opinion": 0.0})
    plain = Recognizer(twins("off", "off"), tuning=alone).recognize(query)
    assert (result.label, result.nearest) == (None, plain.nearest)
    assert result.fault is not None
    assert "'fist'" in result.fault
    assert "'flat'" in result.fault
    assert "no hand is seen" in result.fault
    np.testing.assert_array_equal(result.scores, plain.scores)
    assert not np.isfinite(result.distances[len(VOTER_NAMES) :]).any()


def test_other_movements_are_recognised_without_a_hand_beside_twins() -> None:
    result = Recognizer(twins()).recognize(without_hands(draw(FIST, corner(0.7), seed=5)))
    assert (result.label, result.fault) == ("corner", None)


def test_a_demonstration_without_hands_has_no_shape_that_could_count() -> None:
    blind = [
        gesture("fist", without_hands(draw(FIST, circle())), "on"),
        gesture("corner", draw(FLAT, corner())),
    ]
    language = Language("pool", blind)
    assert not counts(language, "fist")
    assert Recognizer(language).recognize(draw(FLAT, circle(0.41), seed=5)).label == "fist"


def test_a_further_demonstration_without_hands_does_not_undo_the_shape() -> None:
    language = twins()
    fist = language.gesture("fist").with_demonstration(
        without_hands(draw(FIST, circle(0.41), seed=9))
    )
    recognizer = Recognizer(replace(language, gestures=[fist, *language.gestures[1:]]))
    assert recognizer.recognize(draw(FLAT, circle(0.41), seed=9)).label == "flat"


def test_a_second_shape_of_one_gesture_is_as_good_as_the_first() -> None:
    language = twins()
    fist = language.gesture("fist").with_demonstration(draw(TWO, circle(0.39), seed=8))
    recognizer = Recognizer(replace(language, gestures=[fist, *language.gestures[1:]]))
    assert recognizer.recognize(draw(TWO, circle(0.41), seed=5)).label == "fist"
    assert recognizer.recognize(draw(FLAT, circle(0.41), seed=5)).label == "flat"


def test_the_mirror_image_is_made_with_the_other_hand() -> None:
    language = twins()
    mirrored = [
        replace(each, switches=replace(each.switches, mirror="on")) for each in language.gestures
    ]
    recognizer = Recognizer(replace(language, gestures=mirrored))
    for shape, label in ((FIST, "fist"), (FLAT, "flat")):
        query = hold(shape, frames=60, moving=circle(0.41), left=True, seed=5)
        assert recognizer.recognize(query).label == label


def test_hand_voters_have_weight_and_votes_where_a_shape_counts() -> None:
    result = Recognizer(twins()).recognize(draw(FLAT, circle(0.41), seed=5))
    assert all(result.weights[name] > 0 for name in HAND_VOTER_NAMES)
    assert {result.votes[name] for name in HAND_VOTER_NAMES} == {"flat"}
    assert sum(result.weights.values()) == pytest.approx(1.0)
    np.testing.assert_allclose(result.scores[:2].argmin(), 1)


def test_profile_paper_compares_no_shape() -> None:
    recognizer = Recognizer(twins("on", "on"), "paper")
    query = draw(FLAT, circle(0.41), seed=5)
    one, other = recognizer.recognize(query), recognizer.recognize(without_hands(query))
    assert one.to_dict() == other.to_dict()
    assert one.fault is None


def test_a_saved_language_answers_the_same() -> None:
    language = twins("auto", "auto")
    text = language.to_json()
    restored = Language.from_json(text)
    assert restored.to_json() == text
    assert '"hand_shape"' not in text
    query = draw(FLAT, circle(0.41), seed=5)
    result = Recognizer(restored).recognize(query)
    assert result.to_dict() == Recognizer(language).recognize(query).to_dict()
