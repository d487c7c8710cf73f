"""Hand shapes during a movement: authored from a rendered diver's clips, read from others'."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.recognition import (
    Gesture,
    Language,
    LanguageError,
    PoseSequence,
    RecognitionContext,
    Recognizer,
    Recording,
    draw_variants,
    explain,
    takes_in,
)
from app.recognition.gestures.switches import Switches
from app.recognition.health.check import check_health
from tests.recognition.held_takes import FIST, FLAT, hold
from tests.recognition.moving_takes import circle, corner, draw

SHAPED = Path(__file__).parents[2] / "shaped_recordings"
"""What the models find in rendered clips of circles between salutes, by three divers with several
hand shapes (`SHAPED_CLIPS` of `languages.render.cast`); the first demonstrates them."""


def take(name: str) -> PoseSequence:
    (only,) = takes_in(Recording.load(SHAPED / f"circle-by-{name}.npz"))
    return only.poses


MEANT, ANY = Switches(hand_shape="on"), Switches(hand_shape="off")


@pytest.fixture(scope="module")
def shown() -> list[Gesture]:
    gestures = [Gesture.from_demonstration(label, take(f"{label}-1")) for label in ("fist", "flat")]
    return [*gestures, Gesture.from_demonstration("corner", draw(FLAT, corner()))]


@pytest.fixture(scope="module")
def recognizer(shown: list[Gesture]) -> Recognizer:
    fist, flat, other = shown
    meant = [replace(each, switches=MEANT) for each in (fist, flat)]
    return Recognizer(Language("twins", [*meant, other]))


def test_the_hand_of_one_demonstration_decides_nothing(shown: list[Gesture]) -> None:
    recognizer = Recognizer(Language("pool", shown))
    blind = Recognizer(
        Language("blind", [replace(each, switches=ANY) for each in recognizer.language.gestures])
    )
    for name in ("fist-2", "flat-2", "flat-3", "two-2"):
        seen = recognizer.recognize(take(name))
        assert seen.to_dict() == blind.recognize(take(name)).to_dict()


def test_the_author_is_asked_once_whether_the_hands_are_meant(shown: list[Gesture]) -> None:
    fist, flat, other = shown
    asked = Recognizer(Language("pool", shown))
    assert asked.undecided_twins == (("fist", "flat"),)
    (finding,) = [
        each
        for each in check_health(asked.language).findings
        if {"fist", "flat"} <= set(each.gestures) and each.kind != "misread"
    ]
    assert finding.kind == "hand_shape_undecided"
    assert finding.error
    assert "On purpose?" in finding.message
    assert [each.shape for each in finding.drawings] == [(224, 224)] * 2
    for answer in (MEANT, ANY):
        decided = [replace(each, switches=answer) for each in (fist, flat)]
        assert Recognizer(Language("pool", [*decided, other])).undecided_twins == ()


def test_what_may_be_either_of_undecided_twins_is_asked_back(shown: list[Gesture]) -> None:
    recognizer = Recognizer(Language("pool", shown))
    result = recognizer.recognize(draw(FLAT, corner(), seed=3))
    assert recognizer.ask_undecided(result) is result
    label = result.model_copy(update={"label": "fist", "pair": None})
    assert recognizer.ask_undecided(label).pair == ("fist", "flat")
    assert recognizer.ask_undecided(label).label is None


def test_the_hands_of_several_demonstrations_that_agree_count(shown: list[Gesture]) -> None:
    fist, flat, other = shown
    twice = [fist.with_demonstration(take("fist-2")), flat.with_demonstration(take("flat-2"))]
    agreed = Recognizer(Language("pool", [*twice, other]))
    assert agreed.undecided_twins == ()
    assert agreed.recognize(take("fist-3")).label == "fist"
    mixed = [fist.with_demonstration(take("fist-2")), flat.with_demonstration(take("two-2"))]
    once = [twice[0], flat]
    for gestures in (mixed, once):
        recognizer = Recognizer(Language("pool", [*gestures, other]))
        assert recognizer.undecided_twins == (("fist", "flat"),)


@pytest.mark.parametrize("diver", [2, 3])
@pytest.mark.parametrize("label", ["fist", "flat"])
def test_another_divers_hand_tells_two_circles_apart(
    recognizer: Recognizer, label: str, diver: int
) -> None:
    assert recognizer.recognize(take(f"{label}-{diver}")).label == label


def test_the_finger_is_named_that_makes_the_difference(recognizer: Recognizer) -> None:
    poses = take("flat-2")
    context = RecognitionContext(recognizer=recognizer, poses=poses, whole=poses)
    explanation = explain(context, "fist")
    assert "finger is bent" in explanation.sentence
    assert "less than in 'fist'" in explanation.sentence
    against = sum(voter.against for voter in explanation.breakdown) + explanation.turned
    assert against == pytest.approx(-explanation.margin)


def test_what_the_movement_decided_is_not_put_down_to_the_hand(recognizer: Recognizer) -> None:
    poses = draw(FLAT, corner(0.7), seed=3)
    context = RecognitionContext(recognizer=recognizer, poses=poses, whole=poses)
    assert "bent" not in explain(context, "fist").sentence.split(" because ")[-1].split(".")[0]


def test_switching_the_shape_off_is_found_as_a_remedy(recognizer: Recognizer) -> None:
    fist, _, other = recognizer.language.gestures
    insisting = replace(fist, switches=Switches(hand_shape="on"))
    poses = take("flat-2")
    context = RecognitionContext(
        recognizer=Recognizer(Language("pool", [insisting, other])), poses=poses, whole=poses
    )
    found = explain(context, "fist").counterfactuals
    assert any("switch hand shape of 'fist' off" in each.change.words for each in found)


def test_the_health_check_tells_that_the_hand_must_be_seen(recognizer: Recognizer) -> None:
    report = check_health(recognizer.language)
    (note,) = [each for each in report.findings if each.kind == "hand_shape_only"]
    assert note.gestures == ("fist", "flat")
    assert not note.error
    assert "duplicate" not in {each.kind for each in report.findings}


def test_only_the_hands_that_carry_the_movement_are_kept() -> None:
    gesture = Gesture.from_demonstration("flat", take("flat-1"))
    assert gesture.trajectory is not None
    assert [hand.side for hand in gesture.trajectory.moving_hands] == ["right"]
    elsewhere = gesture.with_salient(["left_wrist"])
    assert elsewhere.trajectory is not None
    assert elsewhere.trajectory.moving_hands == ()


def test_a_held_shape_has_no_moving_hand() -> None:
    gesture = Gesture.from_demonstration("fist", hold(FIST))
    assert gesture.trajectory is not None
    assert gesture.trajectory.moving_hands == ()


def test_variants_vary_the_moving_hand() -> None:
    gesture = Gesture.from_demonstration("fist", draw(FIST, circle()))
    assert gesture.trajectory is not None
    (shown,) = gesture.trajectory.moving_hands
    variants = draw_variants(gesture.trajectory, 3, person="another")
    for variant in variants:
        (hand,) = variant.moving_hands
        assert 0 < float(np.abs(hand.xy - shown.xy).max()) < 1.5


def test_a_file_with_moving_hands_but_nothing_that_moves_is_refused() -> None:
    text = Language("held", [Gesture.from_demonstration("fist", hold(FIST))]).to_json()
    content = json.loads(text)
    del content["sha256"]
    trajectory = content["gestures"][0]["trajectory"]
    trajectory["moving_hands"] = trajectory.pop("hands")
    with pytest.raises(LanguageError) as refusal:
        Language.from_json(json.dumps(content))
    assert refusal.value.pointer == "/gestures/0/trajectory/moving_hands"
