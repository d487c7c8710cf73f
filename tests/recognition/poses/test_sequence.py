"""A recording refuses what it cannot mean, and finds the diver's torso."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from app.recognition import PoseError, PoseSequence
from app.recognition.poses.sequence import SHOULDER_WIDTHS_PER_TORSO, FloatArray, join_sequences
from tests.recognition.strategies import circle, recording

WRIST_AND_NOSE = {
    "landmarks": ("right_wrist", "nose"),
    "xy": np.array([[[1.0, 2.0], [3.0, 4.0]], [[5.0, 6.0], [np.nan, np.nan]]]),
    "confidence": np.array([[0.9, 0.8], [0.7, 0.0]]),
    "time": np.array([0.0, 0.1]),
    "frame_size": (640, 480),
}


def wrist_and_nose(**changes: Any) -> PoseSequence:
    return PoseSequence(**{**WRIST_AND_NOSE, **changes})


TORSO = ("left_shoulder", "right_shoulder", "left_hip", "right_hip")


def torso(xy: Sequence[Sequence[tuple[float, float]]]) -> PoseSequence:
    return PoseSequence(
        landmarks=TORSO, xy=np.array(xy), time=np.arange(len(xy)) / 10, frame_size=(640, 480)
    )


def centre_of(poses: PoseSequence) -> FloatArray:
    centre = poses.torso_centre()
    assert centre is not None
    return centre


UNSEEN = (np.nan, np.nan)


@pytest.mark.parametrize(
    ("changes", "complaint"),
    [
        ({"landmarks": ()}, "landmarks is empty"),
        ({"landmarks": "nose"}, "landmarks must be non-empty names"),
        ({"landmarks": ("nose", "")}, "landmarks must be non-empty names"),
        ({"landmarks": ("nose", "nose")}, r"occur twice: \['nose'\]"),
        ({"xy": np.zeros((2, 3, 2))}, r"xy has shape \(2, 3, 2\), expected \(frames, 2 landmarks"),
        ({"xy": np.zeros((2, 2, 3))}, "xy has shape"),
        ({"xy": np.full((2, 2, 2), np.inf)}, "infinite values; mark what was not seen with NaN"),
        ({"xy": "pixels"}, "xy is not an array of numbers"),
        ({"time": [0.0]}, r"time has shape \(1,\), expected \(2,\)"),
        ({"time": [0.0, np.nan]}, "time holds NaN"),
        ({"time": [0.1, 0.1]}, r"time does not increase at frame 1 \(0.1 s, then 0.1 s\)"),
        ({"confidence": [[0.5, 0.5]]}, r"confidence has shape \(1, 2\), expected \(2, 2\)"),
        ({"confidence": np.full((2, 2), 1.1)}, r"outside \[0, 1\]"),
        ({"confidence": np.full((2, 2), np.nan)}, r"outside \[0, 1\]"),
        ({"world": np.zeros((2, 2, 2))}, r"world has shape \(2, 2, 2\), expected \(2, 2, 3\)"),
        ({"world": np.full((2, 2, 3), np.inf)}, "world holds infinite values"),
        ({"frame_size": (640,)}, r"frame_size is \(640,\)"),
        ({"frame_size": (640, 0)}, r"expected \(width, height\) in pixels, both > 0"),
    ],
)
def test_a_malformed_recording_is_refused_with_the_value_seen(
    changes: dict[str, Any], complaint: str
) -> None:
    with pytest.raises(PoseError, match=complaint):
        wrist_and_nose(**changes)


def test_the_arrays_of_a_recording_cannot_be_changed_from_outside() -> None:
    xy = np.zeros((2, 2, 2))
    poses = wrist_and_nose(xy=xy)
    xy[0, 0, 0] = 7.0
    assert poses.xy[0, 0, 0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        poses.xy[0, 0, 0] = 7.0


def test_recordings_with_the_same_values_are_equal_and_nan_equals_nan() -> None:
    assert wrist_and_nose() == wrist_and_nose()
    assert wrist_and_nose() != wrist_and_nose(confidence=None)
    assert wrist_and_nose(confidence=None) == wrist_and_nose(confidence=None)
    assert wrist_and_nose() != wrist_and_nose(frame_size=(480, 640))
    assert wrist_and_nose() != "a recording"


def test_duration_is_the_time_between_the_first_and_the_last_frame() -> None:
    assert wrist_and_nose(time=[3.0, 4.5]).duration == 1.5
    assert wrist_and_nose().between(0.0, 0.0).duration == 0.0


def test_a_landmark_is_seen_where_it_has_both_coordinates() -> None:
    half = np.array([[[1.0, np.nan], [3.0, 4.0]], [[5.0, 6.0], [np.nan, np.nan]]])
    np.testing.assert_array_equal(wrist_and_nose(xy=half).seen, [[False, True], [True, False]])


def test_a_column_is_one_landmarks_path() -> None:
    np.testing.assert_array_equal(wrist_and_nose().column("right_wrist"), [[1, 2], [5, 6]])
    with pytest.raises(PoseError, match="no landmark 'left_wrist'"):
        wrist_and_nose().column("left_wrist")


def test_select_keeps_landmarks_in_the_order_asked_for() -> None:
    swapped = wrist_and_nose().select(["nose", "right_wrist"])
    assert swapped.landmarks == ("nose", "right_wrist")
    np.testing.assert_array_equal(swapped.xy[0], [[3, 4], [1, 2]])
    assert swapped.confidence is not None
    np.testing.assert_array_equal(swapped.confidence[0], [0.8, 0.9])
    assert wrist_and_nose(confidence=None).select(["nose"]).confidence is None
    with pytest.raises(PoseError, match=r"no landmarks \['tail'\]"):
        wrist_and_nose().select(["nose", "tail"])


def test_between_includes_both_ends() -> None:
    poses = recording(circle, frames=30, rate=10.0)
    part = poses.between(1.0, 2.0)
    np.testing.assert_allclose(part.time, np.arange(10, 21) / 10)
    np.testing.assert_array_equal(part.xy, poses.xy[10:21])
    assert len(poses.between(5.0, 9.0)) == 0


def test_the_torso_centre_is_midway_between_shoulders_and_hips() -> None:
    poses = torso([[(10, 0), (20, 0), (12, 30), (18, 30)]])
    np.testing.assert_allclose(centre_of(poses), [[15, 15]])
    assert poses.torso_length() == 30


def test_where_the_hips_are_hidden_the_centre_stays_below_the_shoulders() -> None:
    poses = torso(
        [
            [(10, 0), (20, 0), (12, 30), (18, 30)],
            [(110, 5), (120, 5), UNSEEN, UNSEEN],
            [UNSEEN, UNSEEN, (12, 40), (18, 40)],
        ]
    )
    np.testing.assert_allclose(centre_of(poses), [[15, 15], [115, 20], [15, 25]])


def test_where_the_torso_is_hidden_its_centre_is_interpolated_in_time() -> None:
    seen = [(10, 0), (20, 0), (12, 30), (18, 30)]
    later = [(x + 20, y) for x, y in seen]
    poses = torso([seen, [UNSEEN] * 4, later, [UNSEEN] * 4])
    np.testing.assert_allclose(centre_of(poses), [[15, 15], [25, 15], [35, 15], [35, 15]])


def test_one_wrong_frame_does_not_change_the_torso_length() -> None:
    right = [(10, 0), (20, 0), (10, 30), (20, 30)]
    wrong = [(10, 0), (20, 0), (10, 300), (20, 300)]
    assert torso([right, right, wrong]).torso_length() == 30


def test_without_hips_the_torso_length_follows_from_the_shoulders() -> None:
    poses = torso([[(10, 0), (30, 0), UNSEEN, UNSEEN]])
    assert poses.torso_length() == 20 * SHOULDER_WIDTHS_PER_TORSO


def test_without_shoulders_there_is_no_torso() -> None:
    hidden = torso([[UNSEEN, UNSEEN, (12, 30), (18, 30)]])
    assert hidden.torso_centre() is None
    assert hidden.torso_length() is None
    assert wrist_and_nose().torso_centre() is None
    assert wrist_and_nose().torso_length() is None


def test_a_torso_without_extent_has_no_length() -> None:
    assert torso([[(10, 10)] * 4]).torso_length() is None


def test_places_in_the_world_stay_with_their_landmarks_and_moments() -> None:
    world = np.arange(12.0).reshape(2, 2, 3)
    poses = wrist_and_nose(world=world)
    selected, cut = poses.select(["nose"]).world, poses.between(0.05, 0.2).world
    assert selected is not None
    assert cut is not None
    np.testing.assert_array_equal(selected, world[:, 1:])
    np.testing.assert_array_equal(cut, world[1:])
    assert poses != wrist_and_nose(world=world + 1)
    assert poses != wrist_and_nose()


def test_a_joined_part_without_places_in_the_world_has_none_there() -> None:
    with_world = wrist_and_nose(world=np.ones((2, 2, 3)))
    later = wrist_and_nose(time=[0.2, 0.3])
    joined = join_sequences([with_world, later]).world
    assert joined is not None
    assert np.isfinite(joined[:2]).all()
    assert np.isnan(joined[2:]).all()
    assert join_sequences([wrist_and_nose(), later]).world is None
