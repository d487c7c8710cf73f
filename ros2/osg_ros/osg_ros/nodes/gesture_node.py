"""Gesture node: turns pictures into bodies, hands, states and recognitions, in one node.

It runs the same loop as `osg-studio robot`, with a topic in place of a camera. Its parts exchange
no messages, which suits a robot with few cores.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from std_msgs.msg import Header

from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.factory import create_estimator, finds_hands, list_landmarks
from app.recognition.language.requirements import require_landmarks, require_trigger
from app.recognition.poses.frame import FrameLandmarks
from app.robot import ActiveLanguage, Event, Frame, PhraseListener, create_listener
from osg_ros.estimation_settings import ESTIMATOR, HANDS, PROVIDER, THREADS, WATER
from osg_ros.language_service import LANGUAGE, PROFILE, WITHOUT_SALUTES, LanguageService
from osg_ros.nodes.gesture_worker import GestureWorker
from osg_ros.nodes.managed_node import SENSOR_DATA, ManagedNode
from osg_ros.nodes.process import spin
from osg_ros.topics.gesture_topics import GestureTopics
from osg_ros.topics.image_messages import TRANSPORT, select_image_topic
from osg_ros.topics.topic_source import TopicSource


class GestureNode(ManagedNode):
    """Node that recognises the gestures in a topic of pictures."""

    def __init__(self, **options: Any) -> None:
        listening = (LANGUAGE, PROFILE, WITHOUT_SALUTES)
        looking = (TRANSPORT, WATER, ESTIMATOR, HANDS, THREADS, PROVIDER)
        super().__init__("gesture_node", (*listening, *looking), "image", **options)
        self._worker: GestureWorker | None = None
        self._estimator: PoseEstimator | None = None
        self._service: LanguageService | None = None

    def prepare(self) -> None:
        """Load the models and the language, and create the publishers.

        Raises
        ------
        EstimatorError
            When a model cannot be loaded, or the salutes need hands and no hand model is set.

        """
        self._estimator = create_estimator(
            self.settings["estimator"],
            hands=self.settings["hands"],
            threads=self.settings["threads"],
            provider=self.settings["provider"],
        )
        self._without_salutes = self.settings["without_salutes"]
        self._service = LanguageService(self, self._create_listener, self._change_language)
        self._water = self.settings["water"]
        self._topics = GestureTopics(self)

    def begin(self) -> None:
        """Process pictures from now on, in a separate thread."""
        assert self._service is not None
        assert self._estimator is not None
        self._topics.recognitions.publish_active(True)
        kind, topic = select_image_topic(self.settings["image_transport"])
        source = TopicSource(
            self.resolve_topic_name(topic),
            self._report_picture,
            lambda: int(self.get_clock().now().nanoseconds),
        )
        self.add_subscription(kind, topic, source.put, SENSOR_DATA)
        language = self._service.language
        # The worker publishes it with the first picture, which may come much later.
        self._topics.recognitions.publish_language(language)
        listener = self._create_listener(language)
        self._worker = GestureWorker(source, self._estimator, listener, self._water, self)

    def halt(self) -> None:
        """Stop after the current picture."""
        if self._worker is not None:
            self._worker.stop()
            self._worker = None
            self._topics.recognitions.publish_active(False)

    def release(self) -> None:
        """Remove the service and release the models."""
        if self._service is not None:
            self._service.close()
            self._service = None
        if self._estimator is not None:
            self._estimator.close()
            self._estimator = None

    def facts(self) -> Mapping[str, str]:
        """Return the language and the state of the recogniser, for diagnostics."""
        worker = self._worker.facts() if self._worker else {}
        return {**(self._service.facts() if self._service else {}), **worker}

    def watch(self) -> None:
        """End the process if the recogniser has stopped for good."""
        if self._worker is not None and (fault := self._worker.find_fault()):
            self.fail(fault)

    def handle_frame(self, source: TopicSource, frame: Frame, found: FrameLandmarks) -> None:
        """Publish the landmarks of a frame."""
        assert source.stopwatch is not None
        header = Header(stamp=source.stopwatch.stamp(frame.time), frame_id=source.frame_id)
        self._topics.publish_frame(header, frame, found)

    def handle_event(self, source: TopicSource, event: Event, language: ActiveLanguage) -> None:
        """Publish an event."""
        self._topics.publish_event(event, language, source.stopwatch, source.frame_id)

    def _report_picture(self, what: str) -> None:
        """Report a picture that cannot be used; it arrived all the same."""
        self.count_input()
        self.report_problem(what)

    def _create_listener(self, language: ActiveLanguage) -> PhraseListener:
        assert self._estimator is not None
        landmarks = list_landmarks(self._estimator)
        require_landmarks(language.recognizer.language, landmarks, "the pose estimator")
        require_trigger(language.recognizer.language, landmarks, "the pose estimator")
        return create_listener(
            language,
            without_salutes=self._without_salutes,
            hands=finds_hands(self._estimator),
        )

    def _change_language(self, language: ActiveLanguage) -> None:
        if self._worker is not None:
            self._worker.set_language(language)


def main() -> None:
    """Run the node."""
    spin(lambda: [GestureNode()])
