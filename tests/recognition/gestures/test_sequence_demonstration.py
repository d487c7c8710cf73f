"""Sequences of two held hand shapes: one gesture from one demonstration, in its order."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.recognition import (
    Gesture,
    GestureError,
    Language,
    LanguageError,
    PoseError,
    PoseSequence,
    Recognizer,
    Recording,
    draw_variants,
    takes_in,
)
from app.recognition.gestures.switches import Switches
from app.recognition.poses.frame import mirror_hands
from tests.recognition.held_takes import FIST, FLAT, TWO, fingers, follow, hold
from tests.recognition.parametric_hand import Fingers
from tests.recognition.strategies import circle, recording

ONE, LITTLE = fingers(0), fingers(2, 3)


def show(
    *shapes: Fingers, seed: int = 0, left: bool = False, roll: float = 0.0, transition: float = 0.4
) -> PoseSequence:
    takes = [hold(each, seed=seed + n, left=left, roll=roll) for n, each in enumerate(shapes)]
    return follow(*takes, transition=transition)


GO_UP = Gesture.from_demonstration("flat, fist", show(FLAT, FIST))
SINGLES = [
    Gesture.from_demonstration(label, hold(shape))
    for label, shape in (("flat", FLAT), ("fist", FIST), ("two", TWO))
]
CIRCLE = Gesture.from_demonstration("circle", recording(circle))


@pytest.fixture(scope="module")
def recognizer() -> Recognizer:
    others = [
        Gesture.from_demonstration("fist, two", show(FIST, TWO)),
        Gesture.from_demonstration("flat, one", show(FLAT, ONE)),
    ]
    return Recognizer(Language("pool", [GO_UP, *others, *SINGLES, CIRCLE]))


def test_a_take_of_two_shapes_is_one_gesture() -> None:
    assert GO_UP.is_held
    assert GO_UP.salient == ()
    assert [len(hands) for hands in GO_UP.held_shapes] == [1, 1]
    assert GO_UP.image.any()
    assert np.array_equal(GO_UP.redraw().image, GO_UP.image)


@pytest.mark.parametrize("transition", [0.1, 1.0])
@pytest.mark.parametrize(
    ("shapes", "label"),
    [((FLAT, FIST), "flat, fist"), ((FIST, TWO), "fist, two"), ((FLAT, ONE), "flat, one")],
)
def test_both_shapes_in_their_order_are_recognised(
    recognizer: Recognizer, shapes: tuple[Fingers, Fingers], label: str, transition: float
) -> None:
    take = show(*shapes, seed=9, roll=8, transition=transition)
    assert recognizer.recognize(take).label == label


@pytest.mark.parametrize("shapes", [(FIST, FLAT), (TWO, FIST), (FIST, LITTLE)])
def test_another_order_or_second_shape_is_refused(
    recognizer: Recognizer, shapes: tuple[Fingers, Fingers]
) -> None:
    assert recognizer.recognize(show(*shapes, seed=9)).label is None


def test_one_shape_is_never_a_sequence_nor_a_sequence_one_shape(recognizer: Recognizer) -> None:
    alone = recognizer.recognize(hold(FLAT, seed=5))
    assert alone.label == "flat"
    pair = [alone.gestures.index(each) for each in ("flat, fist", "flat, one")]
    assert np.isinf(alone.distances[:, pair]).all()
    two = recognizer.recognize(show(FIST, FLAT, seed=5))
    assert np.isinf(two.distances[:, two.gestures.index("flat")]).all()
    assert two.nearest in ("flat, fist", "fist, two", "flat, one")


def test_one_shape_beside_sequences_alone_says_what_is_missing() -> None:
    with pytest.raises(PoseError, match="holds a shape, or two in sequence, as the gestures"):
        Recognizer(Language("pool", [GO_UP])).recognize(replace(hold(FLAT), hands=None))
    with pytest.raises(PoseError, match="nothing to compare: one hand shape is held in this take"):
        Recognizer(Language("pool", [GO_UP])).recognize(hold(FLAT))


def test_three_shapes_are_refused_with_their_moments(recognizer: Recognizer) -> None:
    take = show(FLAT, FIST, FLAT)
    with pytest.raises(
        GestureError, match=r"the second from \d.\d s and the third from \d.\d s on"
    ):
        Gesture.from_demonstration("three", take)
    with pytest.raises(PoseError, match=r"the take shows three hand shapes .* two at most"):
        recognizer.recognize(take)


def test_three_shapes_beside_a_small_movement_are_a_finding(recognizer: Recognizer) -> None:
    way = 0.12 * np.sin(np.linspace(0, 6 * np.pi, 120))
    parts = [
        hold(shape, moving=np.column_stack([0 * part, part]))
        for shape, part in zip((FLAT, FIST, FLAT), np.split(way, 3), strict=True)
    ]
    nod = Gesture.from_demonstration("nod", follow(*parts), salient=["right_wrist"])
    beside = Recognizer(replace(recognizer.language, gestures=(*recognizer.language.gestures, nod)))
    result = beside.recognize(follow(*parts))
    assert result.nearest == "nod"
    assert any("three hand shapes" in each for each in result.findings)
    assert result.fault is None


def test_the_other_hand_shows_the_same_sequence_unless_switched_off(
    recognizer: Recognizer,
) -> None:
    take = show(FIST, TWO, seed=4, left=True)
    assert recognizer.recognize(take).label == "fist, two"
    gesture = recognizer.language.gesture("fist, two")
    strict = replace(gesture, switches=Switches(mirror="off"))
    one_sided = Recognizer(Language("pool", [strict]))
    assert (
        one_sided.recognize(show(FIST, TWO, seed=4)).novelty[0]
        < one_sided.recognize(take).novelty[0]
    )


def test_both_parts_are_mirrored_or_none() -> None:
    aside = Gesture.from_demonstration("aside", show(FIST, TWO, roll=-70))
    fist, two = aside.held_shapes
    assert aside.trajectory is not None
    half = replace(aside.trajectory, hands=fist, then_hands=mirror_hands(two))
    whole = aside.trajectory.mirror()
    distances = Recognizer(Language("pool", [aside])).recognize_trajectory
    assert distances(whole).distances[-3:].max() < 1e-6
    assert distances(half).distances[-3:].max() > 0.1


def test_the_mirror_image_is_shown_with_the_other_hand() -> None:
    mirrored = GO_UP.mirror()
    assert [[hand.side for hand in hands] for hands in mirrored.held_shapes] == [["left"], ["left"]]
    assert np.array_equal(mirrored.mirror().image, GO_UP.image)


def test_a_further_demonstration_holds_as_many_shapes() -> None:
    both = GO_UP.with_demonstration(show(FLAT, FIST, left=True))
    assert [len(each.held_shapes) for each in both.single_demonstrations()] == [2, 2]
    with pytest.raises(GestureError, match="is a sequence of two held hand shapes and this demo"):
        GO_UP.with_demonstration(hold(FLAT))
    with pytest.raises(GestureError, match="a held hand shape and this demonstration is a seq"):
        SINGLES[0].with_demonstration(show(FLAT, FIST))


def test_named_landmarks_make_it_a_movement() -> None:
    assert GO_UP.with_salient(["right_wrist"]).held_shapes == ()


def test_a_sequence_is_as_novel_as_the_more_novel_of_its_shapes() -> None:
    recognizer = Recognizer(Language("pool", [GO_UP, *SINGLES[:2]]))
    for shapes in ((FLAT, LITTLE), (LITTLE, FIST), (FLAT, ONE)):
        novelty = recognizer.recognize(show(*shapes, seed=3)).novelty[0]
        apart = [
            recognizer.recognize(hold(shape, seed=3 + n)).novelty[1 + n]
            for n, shape in enumerate(shapes)
        ]
        assert novelty == pytest.approx(max(apart), rel=0.1)


def test_a_language_without_sequences_answers_as_before() -> None:
    alone = Recognizer(Language("pool", [*SINGLES, CIRCLE]))
    beside = Recognizer(Language("pool", [*SINGLES, CIRCLE, GO_UP]))
    whole = show(FLAT, FIST)
    assert alone.query(whole).then_hands == ()
    assert len(beside.query(whole).then_hands) == 1
    for shape in (FLAT, FIST, TWO, ONE):
        one, other = (each.recognize(hold(shape, seed=7)) for each in (alone, beside))
        assert one.label == other.label
        assert np.array_equal(one.distances[:, :4], other.distances[:, :4])


def test_a_sequence_survives_its_file_to_the_last_bit(recognizer: Recognizer) -> None:
    text = recognizer.language.to_json()
    again = Language.from_json(text)
    assert again.to_json() == text
    take = show(FIST, TWO, seed=3)
    results = [Recognizer(each).recognize(take) for each in (recognizer.language, again)]
    assert results[0].to_dict() == results[1].to_dict()


def test_a_second_shape_takes_little_room() -> None:
    one, two = (Language("pool", [each]).to_json() for each in (SINGLES[0], GO_UP))
    assert len(two) < len(one) + 1000


def test_files_without_sequences_do_not_name_them() -> None:
    assert "then_hands" not in Language("pool", [*SINGLES, CIRCLE]).to_json()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda shown: shown.pop("hands"), "without a first hand shape there is no second"),
        (lambda shown: shown["then_hands"][0].update(side="left"), "held by other hands than"),
        (lambda shown: shown["then_hands"].extend(shown["then_hands"]), "two right hands"),
    ],
)
def test_a_file_with_half_a_sequence_is_refused(change: object, message: str) -> None:
    content = json.loads(Language("pool", [GO_UP]).to_json())
    del content["sha256"]
    assert callable(change)
    change(content["gestures"][0]["trajectory"])
    with pytest.raises(LanguageError, match=message) as refusal:
        Language.from_json(json.dumps(content))
    assert refusal.value.pointer.startswith("/gestures/0/trajectory/then_hands")


def test_variants_vary_both_shapes() -> None:
    assert GO_UP.trajectory is not None
    for variant in draw_variants(GO_UP.trajectory, 3, person="another"):
        for shown, made in zip(GO_UP.held_shapes, variant.held_shapes, strict=True):
            assert 0 < float(np.abs(made[0].xy - shown[0].xy).max()) < 1.5


SIGNS = Path(__file__).parents[2] / "sign_recordings"
"""What the models find in rendered clips of held signs between salutes, by two divers each."""


def take_of(name: str) -> PoseSequence:
    (only,) = takes_in(Recording.load(SIGNS / f"{name}.npz"))
    return only.poses


def put_on(body: PoseSequence, shown: PoseSequence) -> PoseSequence:
    """Return 40 frames of a take's body with the right hand of another take."""
    assert body.hands is not None
    assert shown.hands is not None
    own, other = (np.linspace(0, len(each) - 1, 40).round().astype(int) for each in (body, shown))
    hands = np.full((40, 2, 21, 2), np.nan)
    right = shown.hands[other, 1]
    hands[:, 1] = right - right[:, :1] + body.hands[own, 1, :1]
    return PoseSequence(
        landmarks=body.landmarks,
        xy=body.xy[own],
        time=np.arange(40) / 25,
        frame_size=body.frame_size,
        hands=hands,
    )


def show_signs(
    diver: int, *labels: str, transition: float = 0.4, unseen: bool = False
) -> PoseSequence:
    body = take_of(f"two-{diver}")
    takes = (put_on(body, take_of(f"{label}-{diver}")) for label in labels)
    return follow(*takes, transition=transition, unseen=unseen)


PAIRS = [("ok", "two"), ("two", "ok"), ("stop", "two"), ("two", "stop")]


@pytest.fixture(scope="module")
def signs() -> Recognizer:
    """Return a recogniser of what the first diver shows: four sequences and their signs."""
    gestures = [Gesture.from_demonstration(", ".join(pair), show_signs(1, *pair)) for pair in PAIRS]
    gestures += [
        Gesture.from_demonstration(label, take_of(f"{label}-1")) for label in ("ok", "stop", "two")
    ]
    return Recognizer(Language("signs", gestures))


@pytest.mark.parametrize(("transition", "unseen"), [(0.2, False), (0.8, True)])
@pytest.mark.parametrize("pair", PAIRS)
def test_what_the_models_find_of_another_diver_is_recognised(
    signs: Recognizer, pair: tuple[str, str], transition: float, unseen: bool
) -> None:
    take = show_signs(2, *pair, transition=transition, unseen=unseen)
    assert signs.recognize(take).label == ", ".join(pair)


@pytest.mark.parametrize("label", ["ok", "stop", "two"])
def test_another_divers_single_sign_stays_one(signs: Recognizer, label: str) -> None:
    assert signs.recognize(take_of(f"{label}-2")).label == label
