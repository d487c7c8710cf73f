"""Views: a turned diver is compared with a demonstration turned alike."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from app.recognition import (
    Gesture,
    Language,
    PoseSequence,
    RecognitionContext,
    Recognizer,
    explain,
)
from app.recognition.decision.fusion import FARTHEST, STEP, choose_turn
from app.recognition.gestures.switches import Switches
from tests.recognition.strategies import SHAPES, Shape, in_space, recording

TURNED = (-60.0, -40.0, -30.0, 30.0, 50.0, 60.0)


def language(shapes: Sequence[str] = tuple(SHAPES), *, depth: bool = True) -> Language:
    gestures = []
    for name in shapes:
        poses = in_space(recording(SHAPES[name]))
        poses = poses if depth else replace(poses, world=None)
        gestures.append(Gesture.from_demonstration(name, poses))
    return Language("pool", gestures)


@pytest.fixture(scope="module")
def recognizer() -> Recognizer:
    return Recognizer(language())


def show(shape: Shape, turned: float) -> PoseSequence:
    return in_space(recording(shape, frames=70, jitter=0.01), turned)


@pytest.mark.parametrize("turned", TURNED)
@pytest.mark.parametrize("name", SHAPES)
def test_a_turned_diver_is_recognised(recognizer: Recognizer, name: str, turned: float) -> None:
    result = recognizer.recognize(show(SHAPES[name], turned))
    assert result.label == name
    assert result.facing == pytest.approx(turned, abs=3)
    assert set(result.views) == {STEP * round(turned / STEP)}


def test_the_turn_is_what_helps(recognizer: Recognizer) -> None:
    flat = Recognizer(language(depth=False))
    query = show(SHAPES["circle"], 60.0)
    at = recognizer.language.labels.index("circle")
    turned, as_shown = recognizer.recognize(query), flat.recognize(query)
    assert turned.scores[at] < 0.65 * as_shown.scores[at]
    assert not as_shown.views.any()


def test_in_front_of_the_camera_depth_changes_nothing(recognizer: Recognizer) -> None:
    flat = Recognizer(language(depth=False))
    for name, shape in SHAPES.items():
        query = show(shape, 10.0)
        with_depth, without = recognizer.recognize(query), flat.recognize(query)
        assert with_depth.label == without.label == name
        np.testing.assert_array_equal(with_depth.distances, without.distances)


@pytest.mark.parametrize("turned", [0.0, *TURNED])
def test_a_take_without_depth_is_compared_with_all_views(
    recognizer: Recognizer, turned: float
) -> None:
    query = replace(show(SHAPES["wedge"], turned), world=None)
    result = recognizer.recognize(query)
    assert result.label == "wedge"
    assert result.facing is None


def test_each_demonstration_is_turned_by_its_own_angle() -> None:
    gestures = [
        Gesture.from_demonstration(name, in_space(recording(SHAPES[name]), turned))
        for name, turned in (("circle", 0.0), ("line", 30.0), ("wedge", -30.0))
    ]
    result = Recognizer(Language("pool", gestures)).recognize(show(SHAPES["line"], 30.0))
    assert result.label == "line"
    assert result.views.tolist() == [30.0, 0.0, 60.0]


def test_a_mirror_image_is_turned_the_other_way() -> None:
    gestures = [
        replace(gesture, switches=Switches(mirror="on")) if gesture.label == "wedge" else gesture
        for gesture in language().gestures
    ]
    poses = show(SHAPES["wedge"], 45.0)
    assert poses.world is not None
    mirrored = Gesture.from_demonstration("wedge", poses).mirror()
    result = Recognizer(Language("pool", gestures)).recognize_trajectory(
        mirrored.trajectory  # type: ignore[arg-type]
    )
    assert result.label == "wedge"
    assert result.facing == pytest.approx(-45, abs=3)


def test_explanations_compare_with_the_demonstration_as_it_was_turned(
    recognizer: Recognizer,
) -> None:
    query = recognizer.query(show(SHAPES["square"], 60.0))
    table = recognizer.compare(query)
    at = recognizer.language.labels.index("square")
    shown = table.find_nearest_demonstration(recognizer.language.gestures, at).trajectory
    assert shown is not None
    assert shown.facing == pytest.approx(60, abs=1)


@pytest.mark.parametrize(
    ("query", "reference", "turn"),
    [
        (0.0, None, 0),
        (14.0, 0.0, 0),
        (16.0, 0.0, 30),
        (-44.0, 0.0, -30),
        (100.0, 0.0, FARTHEST),
        (120.0, 0.0, 0),  # seen from behind
        (170.0, -170.0, -30),
        (40.0, 35.0, 0),
    ],
)
def test_a_turn_is_the_nearest_step_between_the_two_divers(
    query: float, reference: float | None, turn: int
) -> None:
    assert choose_turn(query, reference) == turn


@pytest.mark.parametrize(("turned", "side"), [(60.0, "left"), (-60.0, "right")])
def test_an_explanation_says_how_far_the_diver_is_turned(
    recognizer: Recognizer, turned: float, side: str
) -> None:
    poses = show(SHAPES["circle"], turned)
    context = RecognitionContext(recognizer=recognizer, poses=poses, whole=poses)
    explained = explain(context, "line", with_counterfactuals=False)
    (told,) = (each for each in explained.details if "turned" in each)
    assert told.endswith(f"degrees to their {side}.")
    assert explained.to_dict()["facing"] == pytest.approx(turned, abs=3)
