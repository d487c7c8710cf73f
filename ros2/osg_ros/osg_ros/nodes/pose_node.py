"""Pose node: finds the body in every picture; first of the separate nodes."""

from __future__ import annotations

from typing import Any

from app.recognition.errors import OsgError
from app.recognition.estimation.factory import ComposedEstimator, body_tracker
from app.recognition.estimation.water import WaterSight
from app.recognition.poses.landmarks import POSE_LANDMARKS
from osg_ros.estimation_settings import PROVIDER, THREADS, WATER
from osg_ros.nodes.managed_node import NEWEST, ManagedNode
from osg_ros.nodes.process import spin
from osg_ros.topics.body_topics import BodyTopics
from osg_ros.topics.image_messages import TRANSPORT, PictureDecoder, select_image_topic
from osg_ros.topics.stamps import Stopwatch, to_nanoseconds


class PoseNode(ManagedNode):
    """Node that publishes the body in each picture of a topic, with the picture's stamp."""

    def __init__(self, **options: Any) -> None:
        settings = (TRANSPORT, WATER, THREADS, PROVIDER)
        super().__init__("pose_node", settings, "image", **options)
        self._sight: WaterSight | None = None
        self._stopwatch: Stopwatch | None = None

    def prepare(self) -> None:
        """Load the models and create the publishers."""
        tracker = body_tracker(threads=self.settings["threads"], provider=self.settings["provider"])
        bodies = ComposedEstimator(tracker, None, POSE_LANDMARKS)
        self._sight = WaterSight(bodies, self.settings["water"])
        self._bodies = BodyTopics(self)

    def begin(self) -> None:
        """Process pictures from now on, with tracking reset."""
        assert self._sight
        self._sight.reset()
        self._stopwatch = None
        self._decoder = PictureDecoder()
        kind, topic = select_image_topic(self.settings["image_transport"])
        self.add_subscription(kind, topic, self._look, NEWEST)

    def release(self) -> None:
        """Release the models."""
        self._sight = None

    def _look(self, message: Any) -> None:
        assert self._sight
        self.count_input()
        stamp = to_nanoseconds(message.header.stamp)
        if self._stopwatch is None:
            self._stopwatch = Stopwatch(stamp)
        try:
            image = self._decoder.decode(message)
            found = self._sight.estimate(image, self._stopwatch.seconds(stamp))
        except OsgError as error:
            self.report_problem(f"a picture is left out: {error}")
            return
        height, width = image.shape[:2]
        self._bodies.publish(message.header, (width, height), found.body)


def main() -> None:
    """Run the node."""
    spin(lambda: [PoseNode()])
