"""The topics on which a node tells what it sees of bodies and hands.

The nodes of the published port and of ROS4HRI ask for reliable delivery, and would hear nothing
from a publisher that offers best effort. Our own topics follow the profile of sensor data.
"""

from __future__ import annotations

from collections.abc import Sequence

from osg_interfaces.msg import BodyKeypoints, Hands
from std_msgs.msg import Bool, Header

from app.recognition.poses.frame import Body, Hand
from app.recognition.recording.salute import ENTER_SCORE, best_salute
from osg_ros.nodes.managed_node import RESULTS, SENSOR_DATA, ManagedNode
from osg_ros.topics.body_messages import (
    DIVER,
    FrameSize,
    body_message,
    published_keypoints,
    skeleton_message,
)
from osg_ros.topics.hand_messages import hands_message, published_hand_keypoints
from osg_ros.topics.optional_messages import message_type


class BodyTopics:
    """Publishes bodies: ours always, the published port's and ROS4HRI's where their types are.

    Parameters
    ----------
    node
        Whose publishers they become.

    """

    def __init__(self, node: ManagedNode) -> None:
        self._ours = node.publisher(BodyKeypoints, "body_keypoints", SENSOR_DATA)
        self._published_type = message_type("keypoints_interfaces", "PoseKeypointsArray")
        if self._published_type:
            self._part_type = message_type("keypoints_interfaces", "PoseKeypoints")
            self._published = node.publisher(self._published_type, "pose_keypoints", RESULTS)
        self._skeleton_type = message_type("hri_msgs", "Skeleton2D")
        if self._skeleton_type:
            ids = message_type("hri_msgs", "IdsList")
            self._ids_type = ids
            self._tracked = node.publisher(ids, "humans/bodies/tracked", RESULTS)
            self._skeleton = node.publisher(
                self._skeleton_type, f"humans/bodies/{DIVER}/skeleton2d", RESULTS
            )

    def publish(self, header: Header, size: FrameSize, body: Body | None) -> None:
        """Tell what was seen in a picture of that header and size."""
        self._ours.publish(body_message(header, size, body))
        if self._published_type and body is not None:
            keypoints = published_keypoints(self._published_type, self._part_type, size, body)
            self._published.publish(keypoints)
        if self._skeleton_type and self._ids_type:
            seen = [] if body is None else [DIVER]
            self._tracked.publish(self._ids_type(header=header, ids=seen))
            if body is not None:
                skeleton = skeleton_message(self._skeleton_type, header, size, body)
                self._skeleton.publish(skeleton)


class HandTopics:
    """Publishes hands and salutes: ours always, the published port's hands where its types are.

    Parameters
    ----------
    node
        Whose publishers they become.

    """

    def __init__(self, node: ManagedNode) -> None:
        self._ours = node.publisher(Hands, "hands", SENSOR_DATA)
        self._salute = node.publisher(Bool, "vulcan_salute_detected", RESULTS)
        self._published_type = message_type("keypoints_interfaces", "HandKeypointsArray")
        if self._published_type:
            self._part_type = message_type("keypoints_interfaces", "HandKeypoints")
            self._published = node.publisher(self._published_type, "hand_keypoints", RESULTS)

    def publish(self, header: Header, size: FrameSize, hands: Sequence[Hand]) -> None:
        """Tell what was seen in a picture of that header and size."""
        self._ours.publish(hands_message(header, size, hands))
        self._salute.publish(Bool(data=best_salute(hands) >= ENTER_SCORE))
        if self._published_type and hands:
            keypoints = published_hand_keypoints(self._published_type, self._part_type, size, hands)
            self._published.publish(keypoints)
