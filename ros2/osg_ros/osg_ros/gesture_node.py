"""The whole recogniser in one node: pictures in, bodies, hands, states and recognitions out.

It runs the same loop as `osg-studio robot`, on a topic in place of a camera. Nothing is sent
between its parts as messages, so this is the one to use on a robot with few cores.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from std_msgs.msg import Header

from app.recognition.estimation import FrameLandmarks, PoseEstimator, create_estimator
from app.robot import (
    Event,
    Frame,
    LanguageChanged,
    LanguageRefused,
    SourceLost,
    SourceWarned,
    SpokenLanguage,
    StateChanged,
    TakeRecognized,
    TakeRejected,
)
from osg_ros.body_topics import BodyTopics, HandTopics
from osg_ros.estimation_settings import PROVIDER, THREADS, WATER
from osg_ros.gesture_worker import GestureWorker, StampedSource
from osg_ros.language_service import LANGUAGE, PROFILE, LanguageService
from osg_ros.managed_node import SENSOR_DATA, ManagedNode
from osg_ros.pictures import TRANSPORT, picture_topic
from osg_ros.recognition_topics import RecognitionTopics
from osg_ros.spinning import spin
from osg_ros.topic_source import TopicSource


class GestureNode(ManagedNode):
    """Recognises the gestures in a topic of pictures, or in another source.

    Parameters
    ----------
    opened
        Opens a source in place of the topic whenever the node is activated.
    **options
        For `rclpy.node.Node`.

    Attributes
    ----------
    worker
        What looks at the frames while the node is active.

    """

    def __init__(self, opened: Callable[[], StampedSource] | None = None, **options: Any) -> None:
        settings = (LANGUAGE, PROFILE, TRANSPORT, WATER, THREADS, PROVIDER)
        super().__init__("gesture_node", settings, "image", **options)
        self.worker: GestureWorker | None = None
        self._opened = opened
        self._estimator: PoseEstimator | None = None
        self._service: LanguageService | None = None

    def prepare(self) -> None:
        """Load the language and the models, and make the publishers."""
        self._service = LanguageService(self, self._change_language)
        self._estimator = create_estimator(
            threads=self.settings["threads"], provider=self.settings["provider"]
        )
        self._bodies = BodyTopics(self)
        self._hands = HandTopics(self)
        self._recognitions = RecognitionTopics(self)

    def begin(self) -> None:
        """Look at pictures from now on, in a thread of their own."""
        assert self._service is not None
        assert self._estimator is not None
        self._recognitions.active(True)
        self.worker = GestureWorker(
            self._opened() if self._opened else self._topic(),
            self._estimator,
            self._service.language,
            self.settings["water"],
            self,
        )

    def halt(self) -> None:
        """Stop after the picture that is looked at now."""
        if self.worker is not None:
            self.worker.stop()
            self.worker = None
            self._recognitions.active(False)

    def release(self) -> None:
        """Withdraw the service and release the models."""
        if self._service is not None:
            self._service.close()
            self._service = None
        if self._estimator is not None:
            self._estimator.close()
            self._estimator = None

    def facts(self) -> Mapping[str, str]:
        """Tell the language."""
        return self._service.facts() if self._service else {}

    def look(self, source: StampedSource, frame: Frame, found: FrameLandmarks) -> None:
        """Publish what was seen in a frame."""
        assert source.stopwatch is not None
        self.count_input()
        height, width = frame.image.shape[:2]
        header = Header(stamp=source.stopwatch.stamp(frame.time), frame_id=source.frame_id)
        self._bodies.publish(header, (width, height), found.body)
        self._hands.publish(header, (width, height), found.hands)

    def hear(self, source: StampedSource, event: Event, language: SpokenLanguage) -> None:
        """Publish what happened."""
        match event:
            case TakeRecognized() | TakeRejected() if source.stopwatch:
                self._recognitions.taken(event, language, source.stopwatch, source.frame_id)
            case StateChanged() if source.stopwatch:
                self._recognitions.changed(event, source.stopwatch, source.frame_id)
            case LanguageChanged():
                self._recognitions.speaks(language)
            case LanguageRefused() | SourceLost() | SourceWarned():
                self.complain(event.reason)
            case _:
                pass

    def _topic(self) -> TopicSource:
        """Subscribe to the topic of pictures."""
        kind, topic = picture_topic(self.settings["image_transport"])
        source = TopicSource(self.resolve_topic_name(topic), self.complain)
        self.subscription(kind, topic, source.put, SENSOR_DATA)
        return source

    def _change_language(self, language: SpokenLanguage) -> None:
        if self.worker is not None:
            self.worker.speak(language)


def main() -> None:
    """Run the node."""
    spin(lambda: [GestureNode()])
