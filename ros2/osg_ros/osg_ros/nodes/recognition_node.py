"""Recognition node: recognises takes and phrases in keypoints; third of the separate nodes."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from typing import Any, Final

from osg_interfaces.msg import BodyKeypoints, Hands
from std_msgs.msg import Bool

from app.recognition import PoseSequence
from app.recognition.poses.frame import FrameLandmarks
from app.recognition.recording.extraction import build_frame_sequence
from app.robot import (
    ActiveLanguage,
    PhraseHeard,
    PhraseListener,
    StateChanged,
    TakeRecognized,
    TakeRejected,
    create_listener,
)
from osg_ros.language_service import LANGUAGE, PROFILE, WITHOUT_SALUTES, LanguageService
from osg_ros.nodes.managed_node import SENSOR_DATA, ManagedNode
from osg_ros.nodes.process import spin
from osg_ros.parameters import Setting
from osg_ros.topics.body_messages import read_body, read_published_body
from osg_ros.topics.optional_messages import find_message_type
from osg_ros.topics.recognition_topics import RecognitionTopics
from osg_ros.topics.stamps import StampOrArrival, Stopwatch, to_nanoseconds
from osg_ros.topics.synchronization import StampPairs

INPUT: Final = Setting(
    "input",
    "osg",
    "Input keypoints: osg (`body_keypoints`, `hands`), or those of the published port's nodes "
    "(`pose_keypoints`, `vulcan_salute_detected`), which have no stamps.",
    choices=("osg", "published"),
)
IMAGE_WIDTH: Final = Setting(
    "image_width", 1280, "Pixels of the camera's picture, for the published port's input.", 1, 16384
)
IMAGE_HEIGHT: Final = Setting(
    "image_height", 720, "Pixels of the camera's picture, for the published port's input.", 1, 16384
)


class RecognitionNode(ManagedNode):
    """Node that recognises the gestures in topics of keypoints."""

    def __init__(self, **options: Any) -> None:
        settings = (LANGUAGE, PROFILE, WITHOUT_SALUTES, INPUT, IMAGE_WIDTH, IMAGE_HEIGHT)
        super().__init__("recognition_node", settings, "keypoints", **options)
        self._service: LanguageService | None = None
        self._listener: PhraseListener | None = None
        # The service that changes the language runs in another thread than the subscriptions.
        self._listening = threading.Lock()
        self._stopwatch: Stopwatch | None = None

    def prepare(self) -> None:
        """Load the language and create the publishers.

        Raises
        ------
        ValueError
            When the language is refused, or the published port's messages are not installed.

        """
        self._keypoints_type = find_message_type("keypoints_interfaces", "PoseKeypointsArray")
        if self.settings["input"] == "published" and self._keypoints_type is None:
            raise ValueError(
                "parameter input is 'published' and the package keypoints_interfaces is not "
                "installed; build it with this one and source the workspace"
            )
        self._without_salutes = self.settings["without_salutes"]
        self._service = LanguageService(self, self._create_listener, self._change_language)
        self._recognitions = RecognitionTopics(self)

    def begin(self) -> None:
        """Subscribe, with a new listener."""
        assert self._service
        self._listener = self._create_listener(self._service.language)
        self._stopwatch = None
        self._recognitions.publish_active(True)
        self._recognitions.publish_language(self._service.language)
        if self.settings["input"] == "osg":
            self._stamp_of = StampOrArrival("body_keypoints", self._read_clock, self.report_problem)
            self._pairs: StampPairs[BodyKeypoints, Hands] = StampPairs()
            self.add_subscription(BodyKeypoints, "body_keypoints", self._take_body, SENSOR_DATA)
            self.add_subscription(Hands, "hands", self._take_hands, SENSOR_DATA)
        else:
            self._size = self.settings["image_width"], self.settings["image_height"]
            self._body: Any = None
            self.add_subscription(
                self._keypoints_type, "pose_keypoints", self._keep_body, SENSOR_DATA
            )
            self.add_subscription(Bool, "vulcan_salute_detected", self._take_salute, SENSOR_DATA)

    def halt(self) -> None:
        """Drop the listener with its open take."""
        if self._listener is not None:
            self._listener = None
            self._recognitions.publish_active(False)

    def release(self) -> None:
        """Remove the service."""
        if self._service is not None:
            self._service.close()
            self._service = None

    def facts(self) -> Mapping[str, str]:
        """Return the language and the number of late keypoints, for diagnostics."""
        listener = self._listener
        late = {"late or repeated": str(listener.order.late)} if listener else {}
        return {**(self._service.facts() if self._service else {}), **late}

    def _create_listener(self, language: ActiveLanguage) -> PhraseListener:
        return create_listener(language, without_salutes=self._without_salutes)

    def _take_body(self, body: BodyKeypoints) -> None:
        pair = self._pairs.first(to_nanoseconds(body.header.stamp), body)
        if pair is not None:
            self._hear(*pair)

    def _take_hands(self, hands: Hands) -> None:
        pair = self._pairs.second(to_nanoseconds(hands.header.stamp), hands)
        if pair is not None:
            self._hear(*pair)

    def _hear(self, body: BodyKeypoints, hands: Hands) -> None:
        stamp = self._stamp_of(body.header.stamp)
        found = FrameLandmarks(read_body(body), ())
        size = (body.image_width, body.image_height)
        try:
            moment = build_frame_sequence(found, self._find_stopwatch(stamp).seconds(stamp), size)
        except ValueError as error:
            self.report_problem(f"keypoints are left out: {error}")
            return
        self._listen(moment, hands.salute, body.header.frame_id)

    def _keep_body(self, body: Any) -> None:
        """Keep the published port's body until the salute of the same frame arrives."""
        self.count_input()
        self._body = body

    def _take_salute(self, salute: Bool) -> None:
        now = self._read_clock()
        body, self._body = self._body, None
        moment = read_published_body(body, self._find_stopwatch(now).seconds(now), self._size)
        self._listen(moment, float(salute.data), "")

    def _read_clock(self) -> int:
        return int(self.get_clock().now().nanoseconds)

    def _find_stopwatch(self, stamp: int) -> Stopwatch:
        if self._stopwatch is None:
            self._stopwatch = Stopwatch(stamp)
        return self._stopwatch

    def _listen(self, moment: PoseSequence, salute: float, frame_id: str) -> None:
        assert self._listener is not None
        assert self._stopwatch is not None
        self.count_input()
        with self._listening:
            language = self._listener.language
            for event in self._listener.feed(moment, salute):
                match event:
                    case TakeRecognized() | TakeRejected():
                        self._recognitions.publish_take(event, language, self._stopwatch, frame_id)
                    case PhraseHeard():
                        self._recognitions.publish_phrase(event, self._stopwatch, frame_id)
                    case StateChanged():
                        self._recognitions.publish_state(event, self._stopwatch, frame_id)
                    case _:
                        pass

    def _change_language(self, language: ActiveLanguage) -> None:
        with self._listening:
            if self._listener is not None:
                self._listener.set_language(language)
                self._recognitions.publish_language(language)


def main() -> None:
    """Run the node."""
    spin(lambda: [RecognitionNode()])
