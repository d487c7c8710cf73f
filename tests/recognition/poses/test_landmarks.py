"""The names of landmarks are MediaPipe's, complete and consistent."""

from app.recognition.poses.landmarks import (
    HAND_LANDMARKS,
    HIPS,
    LANDMARK_GROUPS,
    POSE_LANDMARKS,
    SHOULDERS,
    SKELETON,
    other_side,
)


def test_a_body_has_33_landmarks_and_a_hand_21() -> None:
    assert len(set(POSE_LANDMARKS)) == len(POSE_LANDMARKS) == 33
    assert len(set(HAND_LANDMARKS)) == len(HAND_LANDMARKS) == 21


def test_known_indices_of_the_models_outputs() -> None:
    assert POSE_LANDMARKS.index("nose") == 0
    assert [POSE_LANDMARKS.index(name) for name in SHOULDERS] == [11, 12]
    assert [POSE_LANDMARKS.index(name) for name in ("left_wrist", "right_wrist")] == [15, 16]
    assert [POSE_LANDMARKS.index(name) for name in HIPS] == [23, 24]
    assert HAND_LANDMARKS.index("index_finger_tip") == 8


def test_groups_and_bones_name_landmarks_of_the_body() -> None:
    grouped = [name for names in LANDMARK_GROUPS.values() for name in names]
    assert len(set(grouped)) == len(grouped)
    assert set(grouped) <= set(POSE_LANDMARKS)
    assert {name for bone in SKELETON for name in bone} <= set(POSE_LANDMARKS)


def test_every_landmark_has_a_counterpart_or_is_its_own() -> None:
    assert other_side("left_wrist") == "right_wrist"
    assert other_side("mouth_right") == "mouth_left"
    assert other_side("nose") == "nose"
    assert {other_side(name) for name in POSE_LANDMARKS} == set(POSE_LANDMARKS)
    assert [other_side(other_side(name)) for name in POSE_LANDMARKS] == list(POSE_LANDMARKS)
