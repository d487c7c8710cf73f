"""The pose node and the hand node, each with half of the models, under water."""

from __future__ import annotations

from pathlib import Path

import pytest
from osg_interfaces.msg import BodyKeypoints, Hands
from sensor_msgs.msg import Image

from osg_ros.nodes.hand_node import HandNode
from osg_ros.nodes.pose_node import PoseNode
from osg_ros.topics.image_messages import to_image_message
from tests.recognition.estimation.clip_frames import clip_frames
from tests.recognition.estimation.test_water_sight import murky_with_lamp
from tests.ros2.nodes.bench import BEST_EFFORT, RELIABLE, Bench

pytestmark = pytest.mark.usefixtures("installed_models")


def test_they_ask_their_models_for_the_correction_of_the_water(
    bench: Bench, sample_clips: Path
) -> None:
    (frame,) = clip_frames(sample_clips / "circle-demonstration.mp4", 1)
    for kind in (PoseNode, HandNode):
        bench.active(kind, threads=1)
    bodies = bench.subscribe(BodyKeypoints, "body_keypoints", BEST_EFFORT)
    hands = bench.subscribe(Hands, "hands", BEST_EFFORT)
    camera = bench.probe.create_publisher(Image, "image", RELIABLE)
    bench.wait(lambda: camera.get_subscription_count() == 2, "subscriptions of both nodes")
    message = to_image_message(murky_with_lamp(frame.image))
    # Best effort: what was lost is sent again, as a picture of its own.
    for second in range(20):
        message.header.stamp.sec = second
        camera.publish(message)
        if bench.comes(lambda: bool(hands), 5.0):
            break
    assert bodies[-1].keypoints
    assert hands[-1].hands
