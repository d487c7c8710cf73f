"""Hand node: finds the hands and the salute in every picture; second of the separate nodes."""

from __future__ import annotations

from typing import Any

from osg_interfaces.msg import BodyKeypoints

from app.recognition.errors import OsgError
from app.recognition.estimation.factory import ComposedEstimator, TrackedHands, hand_tracker
from app.recognition.estimation.water import WaterSight
from app.recognition.poses.frame import Body, FrameLandmarks, Image
from app.recognition.poses.landmarks import POSE_LANDMARKS
from osg_ros.estimation_settings import PROVIDER, THREADS, WATER
from osg_ros.nodes.managed_node import SENSOR_DATA, ManagedNode
from osg_ros.nodes.process import spin
from osg_ros.topics.body_messages import read_body
from osg_ros.topics.body_topics import HandTopics
from osg_ros.topics.image_messages import TRANSPORT, PictureDecoder, select_image_topic
from osg_ros.topics.stamps import to_nanoseconds
from osg_ros.topics.synchronization import StampPairs


class ReceivedBody:
    """The body that the pose node found in the current picture; a `BodyFinder`.

    Attributes
    ----------
    body
        The body, or None if none was seen.

    """

    def __init__(self) -> None:
        self.body: Body | None = None

    def track(self, image: Image, time: float) -> FrameLandmarks:
        """Return the body."""
        return FrameLandmarks(self.body, ())

    def examine(self, image: Image) -> FrameLandmarks:
        """Return the body."""
        return FrameLandmarks(self.body, ())

    def reset(self) -> None:
        """Do nothing: every picture comes with its own body."""


class HandNode(ManagedNode):
    """Node that publishes the hands in pictures, with the bodies of the pose node.

    It needs the body to search a distant diver's hands at the ends of the arms.
    """

    def __init__(self, **options: Any) -> None:
        settings = (TRANSPORT, WATER, THREADS, PROVIDER)
        super().__init__("hand_node", settings, "image, body_keypoints", **options)
        self._sight: WaterSight | None = None

    def prepare(self) -> None:
        """Load the models and create the publishers."""
        tracker = hand_tracker(
            search="pose", threads=self.settings["threads"], provider=self.settings["provider"]
        )
        self._received = ReceivedBody()
        hands = ComposedEstimator(self._received, TrackedHands(tracker), POSE_LANDMARKS)
        self._sight = WaterSight(hands, self.settings["water"])
        self._hands = HandTopics(self)

    def begin(self) -> None:
        """Process pictures from now on, with tracking reset."""
        assert self._sight
        self._sight.reset()
        self._decoder = PictureDecoder()
        self._pairs: StampPairs[Any, BodyKeypoints] = StampPairs()
        kind, topic = select_image_topic(self.settings["image_transport"])
        self.add_subscription(kind, topic, self._take_picture, SENSOR_DATA)
        self.add_subscription(BodyKeypoints, "body_keypoints", self._take_body, SENSOR_DATA)

    def release(self) -> None:
        """Release the models."""
        self._sight = None

    def _take_picture(self, picture: Any) -> None:
        pair = self._pairs.first(to_nanoseconds(picture.header.stamp), picture)
        if pair is not None:
            self._look(*pair)

    def _take_body(self, body: BodyKeypoints) -> None:
        pair = self._pairs.second(to_nanoseconds(body.header.stamp), body)
        if pair is not None:
            self._look(*pair)

    def _look(self, picture: Any, body: BodyKeypoints) -> None:
        assert self._sight
        self.count_input()
        try:
            image = self._decoder.decode(picture)
            self._received.body = read_body(body)
            found = self._sight.estimate(image, to_nanoseconds(picture.header.stamp) / 1e9)
        except OsgError as error:
            self.report_problem(f"a picture is left out: {error}")
            return
        height, width = image.shape[:2]
        self._hands.publish(picture.header, (width, height), found.hands)


def main() -> None:
    """Run the node."""
    spin(lambda: [HandNode()])
