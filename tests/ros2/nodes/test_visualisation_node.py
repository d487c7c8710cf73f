"""What was seen is drawn into the picture that it was seen in."""

from __future__ import annotations

import numpy as np
from osg_interfaces.msg import BodyKeypoints, Hands
from sensor_msgs.msg import Image

from osg_ros.nodes.visualisation_node import BODY, VisualisationNode
from osg_ros.topics.image_messages import PictureDecoder, to_image_message
from tests.api.recordings import recording_of
from tests.ros2.nodes.bench import BEST_EFFORT, Bench
from tests.ros2.nodes.keypoint_messages import messages_of

RELIABLY = {
    f"qos_overrides./{topic}.{end}.reliability": "reliable"
    for topic, end in (
        ("image", "subscription"),
        ("body_keypoints", "subscription"),
        ("hands", "subscription"),
        ("processed_frames", "publisher"),
    )
}


def test_bones_are_drawn_where_the_landmarks_are(bench: Bench) -> None:
    drawn = bench.subscribe(Image, "processed_frames", BEST_EFFORT)
    node = bench.active(VisualisationNode, **RELIABLY)
    pictures = bench.speaker(Image, "image")
    bodies = bench.speaker(BodyKeypoints, "body_keypoints")
    hands = bench.speaker(Hands, "hands")
    bench.wait(lambda: node.count_subscribers("processed_frames") == 1, "subscriber")
    body, seen = next(messages_of(recording_of("line")))
    picture = to_image_message(np.zeros((480, 640, 3), dtype=np.uint8))
    picture.header = body.header
    hands.publish(seen)
    pictures.publish(picture)
    bodies.publish(body)
    bench.wait(lambda: bool(drawn), "processed frame")
    assert drawn[0].header == body.header
    image = PictureDecoder().decode(drawn[0])
    left, right = ((point.x, point.y) for point in body.keypoints if "shoulder" in point.name)
    middle = round((left[0] + right[0]) / 2), round((left[1] + right[1]) / 2)
    assert tuple(image[middle[1], middle[0]]) == BODY
    assert tuple(image[20, 20]) == (0, 0, 0)
