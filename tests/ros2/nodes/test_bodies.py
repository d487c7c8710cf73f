"""Bodies and hands survive their messages, and other people's messages mean what they say."""

from __future__ import annotations

import numpy as np
import pytest
from hri_msgs.msg import Skeleton2D
from keypoints_interfaces.msg import (
    HandKeypoints,
    HandKeypointsArray,
    PoseKeypoints,
    PoseKeypointsArray,
)
from std_msgs.msg import Header

from app.recognition.poses.frame import Body, Hand
from app.recognition.poses.landmarks import HAND_LANDMARKS, POSE_LANDMARKS
from app.recognition.poses.skeletons import SKELETON_2D
from app.recognition.recording.salute import best_salute
from osg_ros.topics.body_messages import (
    read_body,
    read_published_body,
    to_body_message,
    to_published_keypoints,
    to_skeleton_message,
)
from osg_ros.topics.hand_messages import to_hands_message, to_published_hand_keypoints
from tests.recognition.parametric_hand import hand_xy, salute

SIZE = (640, 480)


def body() -> Body:
    """Return a body of which one landmark is not seen."""
    random = np.random.default_rng(1)
    xy = random.uniform(0, 480, (len(POSE_LANDMARKS), 2))
    xy[POSE_LANDMARKS.index("left_ear")] = np.nan
    return Body(xy, random.uniform(0, 1, len(POSE_LANDMARKS)), 0.75)


def saluting() -> Hand:
    return Hand(hand_xy(salute()), "right", 0.9)


def test_a_body_is_read_back_to_the_last_bit() -> None:
    message = to_body_message(Header(), SIZE, body())
    read = read_body(message)
    assert read is not None
    assert np.array_equal(read.xy, body().xy, equal_nan=True)
    assert np.array_equal(read.visibility, body().visibility)
    assert (read.score, message.body_id) == (0.75, "diver")
    assert (message.image_width, message.image_height) == SIZE


def test_nobody_is_a_message_without_keypoints() -> None:
    message = to_body_message(Header(), SIZE, None)
    assert (message.body_id, list(message.keypoints)) == ("", [])
    assert read_body(message) is None


def test_hands_come_with_the_salute_that_they_make() -> None:
    message = to_hands_message(Header(), SIZE, [saluting()])
    assert message.salute == best_salute([saluting()]) > 0.5
    (hand,) = message.hands
    assert np.array_equal([(point.x, point.y) for point in hand.keypoints], saluting().xy)
    assert [point.name for point in hand.keypoints] == list(HAND_LANDMARKS)
    assert (hand.side, hand.score) == ("right", 0.9)


def test_the_published_ports_pose_has_its_names_and_fractions_of_the_picture() -> None:
    message = to_published_keypoints(PoseKeypointsArray, PoseKeypoints, SIZE, body())
    assert [point.name for point in message.keypoints][:2] == ["NOSE", "LEFT_EYE_INNER"]
    assert message.keypoints[0].x == pytest.approx(body().xy[0, 0] / 640, abs=1e-6)
    moment = read_published_body(message, 3.0, SIZE)
    assert np.allclose(moment.xy[0], body().xy, atol=1e-3, equal_nan=True)
    assert moment.time[0] == 3.0


def test_the_published_ports_hands_lie_where_they_are_in_the_picture() -> None:
    hand = Hand(saluting().xy * 0 + [320, 120], "left", 0.9)
    message = to_published_hand_keypoints(HandKeypointsArray, HandKeypoints, SIZE, [hand, hand])
    assert len(message.keypoints) == 42
    assert (message.keypoints[21].name, message.keypoints[21].z) == ("Point_0", 0.0)
    assert (message.keypoints[0].x, message.keypoints[0].y) == (0.5, 0.25)


def test_a_skeleton_of_ros4hri_has_each_point_where_its_constant_says() -> None:
    message = to_skeleton_message(Skeleton2D, Header(), SIZE, body())
    xy = dict(zip(POSE_LANDMARKS, (body().xy / SIZE).tolist(), strict=True))
    right_eye = message.skeleton[Skeleton2D.RIGHT_EYE]
    assert (right_eye.x, right_eye.y) == pytest.approx(xy["right_eye"], abs=1e-6)
    shoulders = np.mean([xy["left_shoulder"], xy["right_shoulder"]], axis=0)
    neck = message.skeleton[Skeleton2D.NECK]
    assert (neck.x, neck.y) == pytest.approx(shoulders, abs=1e-6)
    assert message.skeleton[Skeleton2D.LEFT_EAR].c == 0.0


def test_recordings_of_skeletons_are_read_by_the_same_constants() -> None:
    for place, name in enumerate(SKELETON_2D):
        assert getattr(Skeleton2D, (name or "neck").upper()) == place
