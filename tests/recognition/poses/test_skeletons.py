"""Landmarks by other people's names."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.poses.landmarks import LANDMARK_GROUPS, POSE_LANDMARKS, UPPER_BODY
from app.recognition.poses.skeletons import (
    BODY_25,
    COCO_17,
    COCO_18,
    LandmarkSet,
    find_missing_landmarks,
    translate_landmark,
)


@pytest.mark.parametrize(("landmarks", "count"), [(COCO_17, 17), (COCO_18, 18), (BODY_25, 25)])
def test_a_set_has_as_many_landmarks_as_its_name_says_and_none_twice(
    landmarks: LandmarkSet, count: int
) -> None:
    named = [name for name in landmarks if name is not None]
    assert len(landmarks) == count
    assert len(set(named)) == len(named)
    assert set(named) <= set(POSE_LANDMARKS)


def test_the_two_sets_of_coco_differ_in_their_order_and_the_neck() -> None:
    assert set(COCO_18) - {None} == set(COCO_17)
    assert COCO_18.count(None) == 1


@pytest.mark.parametrize("landmarks", [COCO_17, COCO_18, BODY_25])
def test_what_coco_and_openpose_lack_of_the_upper_body_are_the_fingers(
    landmarks: LandmarkSet,
) -> None:
    fingers = {
        name
        for side in ("left", "right")
        for name in LANDMARK_GROUPS[f"{side}_hand"]
        if not name.endswith("wrist")
    }
    assert set(find_missing_landmarks([name for name in landmarks if name])) == fingers


def test_what_is_missing_for_gestures_is_told_in_order() -> None:
    assert find_missing_landmarks(POSE_LANDMARKS) == find_missing_landmarks(UPPER_BODY) == ()
    assert find_missing_landmarks({*UPPER_BODY} - {"right_hip", "nose"}) == ("nose", "right_hip")


@pytest.mark.parametrize(
    "name",
    [
        "left_wrist",
        "LWrist",
        "wristL",
        "Wrist.L",
        "LEFT WRIST",
        "leftWrist",
        "wrist_l",
        "leftwrist",
    ],
)
def test_a_side_may_stand_before_or_behind(name: str) -> None:
    assert translate_landmark(name) == "left_wrist"


@pytest.mark.parametrize(
    ("name", "landmark"),
    [
        ("Nose", "nose"),
        ("RBigToe", "right_foot_index"),
        ("LEFT_EYE_INNER", "left_eye_inner"),
        ("MOUTH_RIGHT", "mouth_right"),
        ("r_ankle", "right_ankle"),
    ],
)
def test_names_of_other_programs_are_known(name: str, landmark: str) -> None:
    assert translate_landmark(name) == landmark


@pytest.mark.parametrize(
    "name", ["Neck", "MidHip", "wrist", "rear", "tail", "left", "left_nose", ""]
)
def test_a_name_without_a_counterpart_means_none(name: str) -> None:
    assert translate_landmark(name) is None


@given(st.sampled_from(POSE_LANDMARKS), st.sampled_from(["snake", "upper", "camel", "spaced"]))
def test_every_landmark_is_known_in_every_style(landmark: str, style: str) -> None:
    words = landmark.split("_")
    written = {
        "snake": landmark,
        "upper": landmark.upper(),
        "camel": words[0] + "".join(word.title() for word in words[1:]),
        "spaced": " ".join(words),
    }[style]
    assert translate_landmark(written) == landmark
