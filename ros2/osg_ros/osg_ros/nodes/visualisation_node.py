"""Visualisation node: draws keypoints, state and recognition into the pictures."""

from __future__ import annotations

from typing import Any, Final

import cv2
import numpy as np
from osg_interfaces.msg import BodyKeypoints, GestureRecognition, Hands, Keypoint, RecognizerState
from sensor_msgs.msg import Image

from app.recognition.errors import OsgError
from app.recognition.poses.frame import Image as RGBImage
from app.recognition.poses.landmarks import SKELETON
from osg_ros.nodes.managed_node import LATCHED, RESULTS, SENSOR_DATA, ManagedNode
from osg_ros.nodes.process import spin
from osg_ros.topics.image_messages import (
    TRANSPORT,
    PictureDecoder,
    select_image_topic,
    to_image_message,
)
from osg_ros.topics.stamps import to_nanoseconds
from osg_ros.topics.synchronization import StampPairs

BODY, HAND, SALUTE = (64, 224, 255), (255, 200, 64), (64, 255, 96)
"""Colours in RGB, distinct for colour-blind viewers and bright against water."""

VISIBLE: Final = 0.5
"""Lowest visibility of a landmark that is drawn; MediaPipe's drawings use the same."""

STATES: Final = {
    RecognizerState.INACTIVE: "inactive",
    RecognizerState.IDLE: "idle",
    RecognizerState.RECORDING: "recording",
    RecognizerState.DONE: "done",
}


class VisualisationNode(ManagedNode):
    """Node that publishes annotated pictures on `processed_frames`."""

    def __init__(self, **options: Any) -> None:
        super().__init__(
            "visualisation_node", (TRANSPORT,), "image, body_keypoints, hands", **options
        )

    def prepare(self) -> None:
        """Create the publisher."""
        self._frames = self.add_publisher(Image, "processed_frames", SENSOR_DATA)

    def begin(self) -> None:
        """Subscribe to the pictures and results."""
        self._decoder = PictureDecoder()
        self._found: StampPairs[BodyKeypoints, Hands] = StampPairs()
        self._drawn: StampPairs[Any, tuple[BodyKeypoints, Hands]] = StampPairs()
        self._state = self._words = ""
        kind, topic = select_image_topic(self.settings["image_transport"])
        self.add_subscription(kind, topic, self._take_picture, SENSOR_DATA)
        self.add_subscription(BodyKeypoints, "body_keypoints", self._take_body, SENSOR_DATA)
        self.add_subscription(Hands, "hands", self._take_hands, SENSOR_DATA)
        self.add_subscription(RecognizerState, "state", self._take_state, LATCHED)
        self.add_subscription(GestureRecognition, "recognition", self._take_recognition, RESULTS)

    def _take_picture(self, picture: Any) -> None:
        self._draw(self._drawn.first(to_nanoseconds(picture.header.stamp), picture))

    def _take_body(self, body: BodyKeypoints) -> None:
        self._take_found(self._found.first(to_nanoseconds(body.header.stamp), body))

    def _take_hands(self, hands: Hands) -> None:
        self._take_found(self._found.second(to_nanoseconds(hands.header.stamp), hands))

    def _take_found(self, found: tuple[BodyKeypoints, Hands] | None) -> None:
        if found is not None:
            self._draw(self._drawn.second(to_nanoseconds(found[0].header.stamp), found))

    def _take_state(self, state: RecognizerState) -> None:
        self._state = STATES.get(state.state, "")

    def _take_recognition(self, recognition: GestureRecognition) -> None:
        share = f"{recognition.nearest} {recognition.confidence:.0%}"
        self._words = f"rejected: {share}" if recognition.rejected else share
        if recognition.pair:
            self._words = f"{' or '.join(recognition.pair)}?"

    def _draw(self, pair: tuple[Any, tuple[BodyKeypoints, Hands]] | None) -> None:
        if pair is None:
            return
        picture, (body, hands) = pair
        self.count_input()
        try:
            image = np.array(self._decoder.decode(picture))
        except OsgError as error:
            self.report_problem(f"a picture is left out: {error}")
            return
        draw_body(image, body)
        draw_hands(image, hands)
        write_text(image, f"{self._state}  {self._words}")
        message = to_image_message(image)
        message.header = picture.header
        self._frames.publish(message)


def draw_body(image: RGBImage, body: BodyKeypoints) -> None:
    """Draw the bones between visible landmarks into an RGB image."""
    points = {
        each.name: pixel
        for each in body.keypoints
        if each.confidence >= VISIBLE and (pixel := to_pixel(each))
    }
    for one, other in SKELETON:
        if one in points and other in points:
            cv2.line(image, points[one], points[other], BODY, 2, cv2.LINE_AA)
    for point in points.values():
        cv2.circle(image, point, 3, BODY, -1, cv2.LINE_AA)


def draw_hands(image: RGBImage, hands: Hands) -> None:
    """Draw the landmarks of hands into an RGB image, in another colour while one salutes."""
    colour = SALUTE if hands.salute >= VISIBLE else HAND
    for hand in hands.hands:
        for point in filter(None, map(to_pixel, hand.keypoints)):
            cv2.circle(image, point, 2, colour, -1, cv2.LINE_AA)


def write_text(image: RGBImage, words: str) -> None:
    """Write one line at the bottom of an RGB image."""
    # OpenCV's fonts have only ASCII; labels may have other characters.
    text = words.encode("ascii", "replace").decode()
    place = (8, image.shape[0] - 10)
    for colour, width in (((0, 0, 0), 4), ((255, 255, 255), 1)):
        cv2.putText(image, text, place, cv2.FONT_HERSHEY_SIMPLEX, 0.6, colour, width, cv2.LINE_AA)


def to_pixel(keypoint: Keypoint) -> tuple[int, int] | None:
    """Return the pixel of a keypoint; None where it was not seen or lies far outside."""
    if not (abs(keypoint.x) < 2**15 and abs(keypoint.y) < 2**15):
        return None
    return round(keypoint.x), round(keypoint.y)


def main() -> None:
    """Run the node."""
    spin(lambda: [VisualisationNode()])
