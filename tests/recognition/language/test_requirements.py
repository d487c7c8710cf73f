"""What a language needs is what its gestures follow."""

import pytest

from app.recognition import Gesture, Language
from app.recognition.errors import LandmarkError
from app.recognition.language.requirements import (
    find_requirements,
    require_landmarks,
    require_trigger,
)
from app.recognition.poses.landmarks import POSE_LANDMARKS
from app.recognition.poses.skeletons import COCO_17
from tests.posed import BY_BELLY
from tests.recognition.strategies import circle, line, recording


def test_a_language_needs_the_landmarks_its_gestures_follow() -> None:
    language = Language(
        "pool",
        [
            Gesture.from_demonstration("circle", recording(circle)),
            Gesture.from_demonstration("left line", recording(line, hand="left_wrist")),
        ],
    )
    needed = find_requirements(language)
    assert needed.salient == ("left_wrist", "right_wrist")
    assert not set(needed.limbs) & {*needed.salient, *needed.torso}
    assert set(needed.torso) == {"left_shoulder", "right_shoulder", "left_hip", "right_hip"}
    assert "pose_landmark_full" in needed.models


def test_an_empty_language_needs_no_landmark_of_a_gesture() -> None:
    needed = find_requirements(Language("empty"))
    assert needed.salient == needed.limbs == ()


def test_a_source_that_has_what_is_followed_will_do() -> None:
    language = Language("pool", [Gesture.from_demonstration("circle", recording(circle))])
    for landmarks in (POSE_LANDMARKS, COCO_17):
        require_landmarks(language, landmarks, "the source")


def test_one_demonstration_that_the_source_can_show_is_enough() -> None:
    pointed = Gesture.from_demonstration(
        "pointed", recording(circle, hand="right_index"), salient=["right_index"]
    )
    language = Language("pool", [pointed.with_demonstration(recording(circle, hand="left_wrist"))])
    assert find_requirements(language).salient == ("left_wrist", "right_index")
    require_landmarks(language, COCO_17, "yolo-pose")


def test_a_source_that_lacks_a_landmark_is_refused_with_its_name() -> None:
    pointed = Gesture.from_demonstration(
        "pointed", recording(circle, hand="right_index"), salient=["right_index"]
    )
    language = Language("pool", [Gesture.from_demonstration("line", recording(line)), pointed])
    with pytest.raises(
        LandmarkError, match=r"yolo-pose gives no landmark 'right_index', which 'pointed' of 'pool'"
    ) as refused:
        require_landmarks(language, COCO_17, "yolo-pose")
    assert refused.value.landmark == "right_index"


def test_a_trigger_needs_the_arms_and_a_salute_none_of_the_body() -> None:
    posed = Language("pool", trigger=BY_BELLY)
    require_trigger(posed, COCO_17, "yolo-pose")
    without = [name for name in COCO_17 if name != "left_elbow"]
    with pytest.raises(
        LandmarkError, match=r"yolo-pose gives no landmark 'left_elbow', by which the trigger"
    ) as refused:
        require_trigger(posed, without, "yolo-pose")
    assert refused.value.landmark == "left_elbow"
    require_trigger(Language("pool"), (), "a source of nothing")
