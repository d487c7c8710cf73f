"""Takes, recognitions and phrases of keypoints of other nodes: the third of the separate nodes."""

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
    PhraseHeard,
    PhraseListener,
    SpokenLanguage,
    StateChanged,
    TakeRecognized,
    TakeRejected,
    hearing_of,
)
from osg_ros.language_service import LANGUAGE, PROFILE, WITHOUT_SALUTES, LanguageService
from osg_ros.nodes.managed_node import SENSOR_DATA, ManagedNode
from osg_ros.nodes.process import spin
from osg_ros.parameters import Setting
from osg_ros.topics.body_messages import body_in, published_moment
from osg_ros.topics.optional_messages import message_type
from osg_ros.topics.recognition_topics import RecognitionTopics
from osg_ros.topics.stamps import Stopwatch, nanoseconds_of
from osg_ros.topics.synchronization import StampPairs

INPUT: Final = Setting(
    "input",
    "osg",
    "Whose keypoints: osg (`body_keypoints`, `hands`), or those of the published port's nodes "
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
    """Recognises the gestures in topics of keypoints."""

    def __init__(self, **options: Any) -> None:
        settings = (LANGUAGE, PROFILE, WITHOUT_SALUTES, INPUT, IMAGE_WIDTH, IMAGE_HEIGHT)
        super().__init__("recognition_node", settings, "keypoints", **options)
        self._service: LanguageService | None = None
        self._listener: PhraseListener | None = None
        # The service that changes the language runs beside what listens.
        self._listening = threading.Lock()
        self._stopwatch: Stopwatch | None = None

    def prepare(self) -> None:
        """Load the language and make the publishers.

        Raises
        ------
        ValueError
            Also when the published port's messages are asked for and not installed.

        """
        self._keypoints_type = message_type("keypoints_interfaces", "PoseKeypointsArray")
        if self.settings["input"] == "published" and self._keypoints_type is None:
            raise ValueError(
                "parameter input is 'published' and the package keypoints_interfaces is not "
                "there; build it with this one and source the workspace"
            )
        self._without_salutes = self.settings["without_salutes"]
        self._service = LanguageService(self, self._hearing, self._change_language)
        self._recognitions = RecognitionTopics(self)

    def begin(self) -> None:
        """Listen from now on, as to another camera."""
        assert self._service
        self._listener = self._hearing(self._service.language)
        self._stopwatch = None
        self._recognitions.active(True)
        self._recognitions.speaks(self._service.language)
        if self.settings["input"] == "osg":
            self._pairs: StampPairs[BodyKeypoints, Hands] = StampPairs()
            self.subscription(BodyKeypoints, "body_keypoints", self._take_body, SENSOR_DATA)
            self.subscription(Hands, "hands", self._take_hands, SENSOR_DATA)
        else:
            self._size = self.settings["image_width"], self.settings["image_height"]
            self._body: Any = None
            self.subscription(self._keypoints_type, "pose_keypoints", self._keep_body, SENSOR_DATA)
            self.subscription(Bool, "vulcan_salute_detected", self._take_salute, SENSOR_DATA)

    def halt(self) -> None:
        """Forget the take that was begun."""
        if self._listener is not None:
            self._listener = None
            self._recognitions.active(False)

    def release(self) -> None:
        """Withdraw the service."""
        if self._service is not None:
            self._service.close()
            self._service = None

    def facts(self) -> Mapping[str, str]:
        """Tell the language."""
        return self._service.facts() if self._service else {}

    def _hearing(self, language: SpokenLanguage) -> PhraseListener:
        return hearing_of(language, without_salutes=self._without_salutes)

    def _take_body(self, body: BodyKeypoints) -> None:
        pair = self._pairs.first(nanoseconds_of(body.header.stamp), body)
        if pair is not None:
            self._hear(*pair)

    def _take_hands(self, hands: Hands) -> None:
        pair = self._pairs.second(nanoseconds_of(hands.header.stamp), hands)
        if pair is not None:
            self._hear(*pair)

    def _hear(self, body: BodyKeypoints, hands: Hands) -> None:
        stamp = nanoseconds_of(body.header.stamp)
        found = FrameLandmarks(body_in(body), ())
        size = (body.image_width, body.image_height)
        try:
            moment = build_frame_sequence(found, self._stopwatch_from(stamp).seconds(stamp), size)
        except ValueError as error:
            self.complain(f"keypoints are left out: {error}")
            return
        self._listen(moment, hands.salute, body.header.frame_id)

    def _keep_body(self, body: Any) -> None:
        """Keep the published port's body until its salute comes, which it sends for every frame."""
        self.count_input()
        self._body = body

    def _take_salute(self, salute: Bool) -> None:
        now = self.get_clock().now().nanoseconds
        body, self._body = self._body, None
        moment = published_moment(body, self._stopwatch_from(now).seconds(now), self._size)
        self._listen(moment, float(salute.data), "")

    def _stopwatch_from(self, stamp: int) -> Stopwatch:
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
                        self._recognitions.taken(event, language, self._stopwatch, frame_id)
                    case PhraseHeard():
                        self._recognitions.phrased(event, self._stopwatch, frame_id)
                    case StateChanged():
                        self._recognitions.changed(event, self._stopwatch, frame_id)
                    case _:
                        pass

    def _change_language(self, language: SpokenLanguage) -> None:
        with self._listening:
            if self._listener is not None:
                self._listener.speak(language)
                self._recognitions.speaks(language)


def main() -> None:
    """Run the node."""
    spin(lambda: [RecognitionNode()])
