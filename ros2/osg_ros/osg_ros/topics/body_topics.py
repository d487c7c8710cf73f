"""Body topics: publish the bodies and hands found in each picture.

Nodes of the published port and of ROS4HRI request reliable delivery and would receive nothing from
a best-effort publisher. This project's own topics use the sensor-data profile.
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
    to_body_message,
    to_published_keypoints,
    to_skeleton_message,
)
from osg_ros.topics.hand_messages import to_hands_message, to_published_hand_keypoints
from osg_ros.topics.optional_messages import find_message_type


class BodyTopics:
    """Publishers of bodies: always ours, and the published port's and ROS4HRI's if installed.

    Parameters
    ----------
    node
        Node that gets the publishers.

    """

    def __init__(self, node: ManagedNode) -> None:
        self._ours = node.add_publisher(BodyKeypoints, "body_keypoints", SENSOR_DATA)
        self._published_type = find_message_type("keypoints_interfaces", "PoseKeypointsArray")
        if self._published_type:
            self._part_type = find_message_type("keypoints_interfaces", "PoseKeypoints")
            self._published = node.add_publisher(self._published_type, "pose_keypoints", RESULTS)
        self._skeleton_type = find_message_type("hri_msgs", "Skeleton2D")
        if self._skeleton_type:
            ids = find_message_type("hri_msgs", "IdsList")
            self._ids_type = ids
            self._tracked = node.add_publisher(ids, "humans/bodies/tracked", RESULTS)
            self._skeleton = node.add_publisher(
                self._skeleton_type, f"humans/bodies/{DIVER}/skeleton2d", RESULTS
            )

    def publish(self, header: Header, size: FrameSize, body: Body | None) -> None:
        """Publish the body of a picture with that header and size; None when nobody was seen."""
        self._ours.publish(to_body_message(header, size, body))
        if self._published_type and body is not None:
            keypoints = to_published_keypoints(self._published_type, self._part_type, size, body)
            self._published.publish(keypoints)
        if self._skeleton_type and self._ids_type:
            seen = [] if body is None else [DIVER]
            self._tracked.publish(self._ids_type(header=header, ids=seen))
            if body is not None:
                skeleton = to_skeleton_message(self._skeleton_type, header, size, body)
                self._skeleton.publish(skeleton)


class HandTopics:
    """Publishers of hands and salutes: always ours, and the published port's hands if installed.

    Parameters
    ----------
    node
        Node that gets the publishers.

    """

    def __init__(self, node: ManagedNode) -> None:
        self._ours = node.add_publisher(Hands, "hands", SENSOR_DATA)
        self._salute = node.add_publisher(Bool, "vulcan_salute_detected", RESULTS)
        self._published_type = find_message_type("keypoints_interfaces", "HandKeypointsArray")
        if self._published_type:
            self._part_type = find_message_type("keypoints_interfaces", "HandKeypoints")
            self._published = node.add_publisher(self._published_type, "hand_keypoints", RESULTS)

    def publish(self, header: Header, size: FrameSize, hands: Sequence[Hand]) -> None:
        """Publish the hands of a picture with that header and size."""
        self._ours.publish(to_hands_message(header, size, hands))
        self._salute.publish(Bool(data=best_salute(hands) >= ENTER_SCORE))
        if self._published_type and hands:
            keypoints = to_published_hand_keypoints(
                self._published_type, self._part_type, size, hands
            )
            self._published.publish(keypoints)
