"""Landmarks that a pose estimator lacks: fingers, above all."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition import Gesture, Language, PoseSequence, Recognizer
from app.recognition.poses.skeletons import COCO_17
from tests.recognition.strategies import SHAPES, Shape, recording

FINGERS = {"pinky": (0.04, 0.13), "index": (-0.03, 0.15), "thumb": (-0.07, 0.09)}
"""Places of a hanging hand's fingers relative to the wrist, in torso lengths."""


def with_fingers(shape: Shape, *, seed: int = 0, torso: float = 120.0) -> PoseSequence:
    """Record a diver with fingers and a face in their natural places."""
    poses = recording(shape, jitter=0.01, seed=seed, torso=torso)
    xy = poses.xy.copy()
    for side, sign in (("left", -1), ("right", 1)):
        wrist = poses.column(f"{side}_wrist")
        for finger, (x, y) in FINGERS.items():
            place = poses.landmarks.index(f"{side}_{finger}")
            xy[:, place] = wrist + np.array([sign * x, y]) * torso
    return replace(poses, xy=xy)


def without_fingers(poses: PoseSequence) -> PoseSequence:
    """Keep COCO's landmarks, as a recording by YOLO-pose has them."""
    return poses.select(COCO_17)


def unseen_fingers(poses: PoseSequence) -> PoseSequence:
    """Mark the other landmarks as never seen, as in a stream of `Body`."""
    xy = poses.xy.copy()
    xy[:, [name not in COCO_17 for name in poses.landmarks]] = np.nan
    return replace(poses, xy=xy)


def all_there(poses: PoseSequence) -> PoseSequence:
    return poses


@pytest.fixture(scope="module", params=[all_there, without_fingers], ids=["33", "COCO"])
def recognizer(request: pytest.FixtureRequest) -> Recognizer:
    """Return a recogniser of a language defined with all landmarks, or with COCO's."""
    gestures = [
        Gesture.from_demonstration(label, request.param(with_fingers(shape)))
        for label, shape in SHAPES.items()
    ]
    return Recognizer(Language("pool", gestures))


@pytest.mark.parametrize("label", SHAPES)
@pytest.mark.parametrize("seen", [all_there, without_fingers, unseen_fingers])
def test_a_gesture_of_the_arm_is_known_with_fingers_and_without(
    recognizer: Recognizer, label: str, seen: Callable[[PoseSequence], PoseSequence]
) -> None:
    result = recognizer.recognize(seen(with_fingers(SHAPES[label], seed=1, torso=90.0)))
    assert result.label == label


@given(st.sampled_from(sorted(SHAPES)), st.integers(0, 2**32 - 1))
def test_a_landmark_that_is_never_seen_is_as_good_as_none(
    recognizer: Recognizer, label: str, seed: int
) -> None:
    poses = with_fingers(SHAPES[label], seed=seed)
    one, other = (recognizer.recognize(each(poses)) for each in (without_fingers, unseen_fingers))
    assert one.label == other.label
    np.testing.assert_allclose(one.distances, other.distances, rtol=1e-12)
