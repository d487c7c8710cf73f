"""The hands and the salute in every picture: the second of the separate nodes."""

from __future__ import annotations

from typing import Any

from osg_interfaces.msg import BodyKeypoints

from app.recognition.errors import OsgError
from app.recognition.estimation.landmark_models.hands import HandTracker
from app.recognition.estimation.onnx_estimator import hand_tracker
from app.recognition.estimation.water import correct_colours
from osg_ros.estimation_settings import PROVIDER, THREADS, WATER
from osg_ros.nodes.managed_node import SENSOR_DATA, ManagedNode
from osg_ros.nodes.process import spin
from osg_ros.topics.body_messages import body_in
from osg_ros.topics.body_topics import HandTopics
from osg_ros.topics.image_messages import TRANSPORT, PictureDecoder, picture_topic
from osg_ros.topics.stamps import nanoseconds_of
from osg_ros.topics.synchronization import StampPairs


class HandNode(ManagedNode):
    """Publishes the hands in the pictures whose bodies the pose node tells.

    It needs the body: a distant diver's hands are looked for where the arms end.
    """

    def __init__(self, **options: Any) -> None:
        settings = (TRANSPORT, WATER, THREADS, PROVIDER)
        super().__init__("hand_node", settings, "image, body_keypoints", **options)
        self._tracker: HandTracker | None = None

    def prepare(self) -> None:
        """Load the models and make the publishers."""
        self._water = self.settings["water"]
        self._tracker = hand_tracker(
            search="pose", threads=self.settings["threads"], provider=self.settings["provider"]
        )
        self._hands = HandTopics(self)

    def begin(self) -> None:
        """Look at pictures from now on, as at those of another camera."""
        assert self._tracker
        self._tracker.reset()
        self._decoder = PictureDecoder()
        self._pairs: StampPairs[Any, BodyKeypoints] = StampPairs()
        kind, topic = picture_topic(self.settings["image_transport"])
        self.subscription(kind, topic, self._take_picture, SENSOR_DATA)
        self.subscription(BodyKeypoints, "body_keypoints", self._take_body, SENSOR_DATA)

    def release(self) -> None:
        """Release the models."""
        self._tracker = None

    def _take_picture(self, picture: Any) -> None:
        pair = self._pairs.first(nanoseconds_of(picture.header.stamp), picture)
        if pair is not None:
            self._look(*pair)

    def _take_body(self, body: BodyKeypoints) -> None:
        pair = self._pairs.second(nanoseconds_of(body.header.stamp), body)
        if pair is not None:
            self._look(*pair)

    def _look(self, picture: Any, body: BodyKeypoints) -> None:
        assert self._tracker
        self.count_input()
        try:
            image = correct_colours(self._decoder.decode(picture), self._water)
            followed = self._tracker.follow(image)
            hands = self._tracker.complete(image, followed, body_in(body))
        except OsgError as error:
            self.complain(f"a picture is left out: {error}")
            return
        height, width = image.shape[:2]
        self._hands.publish(picture.header, (width, height), hands)


def main() -> None:
    """Run the node."""
    spin(lambda: [HandNode()])
