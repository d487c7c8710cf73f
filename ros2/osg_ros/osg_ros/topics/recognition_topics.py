"""Recognition topics: publish recognitions, the state of the salutes, and the active language."""

from __future__ import annotations

from builtin_interfaces.msg import Time
from osg_interfaces.msg import ActiveLanguage as LanguageMessage
from osg_interfaces.msg import GestureRecognition, RecognizerState
from rclpy.duration import Duration
from std_msgs.msg import Header, String

from app.recognition.recording.segmentation import TakeState
from app.robot import (
    ActiveLanguage,
    PhraseHeard,
    StateChanged,
    TakeRecognized,
    TakeRejected,
)
from app.robot.take_result import list_message_fields
from osg_ros.commands.table import format_command
from osg_ros.nodes.managed_node import LATCHED, RESULTS, ManagedNode
from osg_ros.topics.body_messages import DIVER
from osg_ros.topics.optional_messages import find_message_type
from osg_ros.topics.phrase_topic import PhraseTopic, list_phrase_labels
from osg_ros.topics.stamps import Stopwatch

LONGEST_DELIVERY = 2.0
"""Seconds to wait for a subscriber that may have ended."""

STATES = {
    TakeState.idle: RecognizerState.IDLE,
    TakeState.recording: RecognizerState.RECORDING,
    TakeState.done: RecognizerState.DONE,
}


class RecognitionTopics:
    """Publishers of a listener's events.

    A take that is rejected or lies between two gestures is published on `recognition` alone, with
    its reason, so that a subscriber of the label topics never gets the label of such a take.

    Parameters
    ----------
    node
        Node that gets the publishers.

    """

    def __init__(self, node: ManagedNode) -> None:
        self._node = node
        self._told: int | None = None
        self._active_language: ActiveLanguage | None = None
        self._recognition = node.add_publisher(GestureRecognition, "recognition", RESULTS)
        self._label = node.add_publisher(String, "recognized_gesture", RESULTS)
        self._phrases = PhraseTopic(node)
        self._state = node.add_publisher(RecognizerState, "state", LATCHED)
        self._language = node.add_publisher(LanguageMessage, "language", LATCHED)
        self._classification_type = find_message_type("vision_msgs", "Classification")
        self._hypothesis_type = find_message_type("vision_msgs", "ObjectHypothesis")
        if self._classification_type:
            self._classification = node.add_publisher(
                self._classification_type, "classification", RESULTS
            )

    def publish_take(
        self,
        event: TakeRecognized | TakeRejected,
        language: ActiveLanguage,
        clock: Stopwatch,
        frame_id: str,
    ) -> None:
        """Publish a take.

        Parameters
        ----------
        event
            Event of the listener.
        language
            Language that recognised the take.
        clock
            Converts the event's seconds to stamps.
        frame_id
            Frame of the camera.

        """
        header = Header(stamp=clock.stamp(event.time), frame_id=frame_id)
        message = to_recognition_message(event, language, clock, header)
        self._recognition.publish(message)
        if not isinstance(event, TakeRecognized):
            return
        self._label.publish(String(data=message.label))
        if self._classification_type and self._hypothesis_type:
            hypothesis = self._hypothesis_type(class_id=message.label, score=message.confidence)
            self._classification.publish(
                self._classification_type(header=header, results=[hypothesis])
            )

    def publish_phrase(self, event: PhraseHeard, clock: Stopwatch, frame_id: str) -> None:
        """Publish a phrase event; see `publish_take`."""
        self._phrases.publish(event, clock, frame_id)

    def publish_state(self, event: StateChanged, clock: Stopwatch, frame_id: str) -> None:
        """Publish a state of the salutes; see `publish_take`."""
        header = Header(stamp=clock.stamp(event.time), frame_id=frame_id)
        self._tell(header, STATES[event.state])

    def publish_active(self, listening: bool) -> None:
        """Publish whether recognition is active."""
        state = RecognizerState.IDLE if listening else RecognizerState.INACTIVE
        self._tell(Header(stamp=self._now()), state)

    def publish_language(self, language: ActiveLanguage) -> None:
        """Publish the active language, unless it is the one published last."""
        if language is not self._active_language:
            self._active_language = language
            self._language.publish(to_language_message(language, Header(stamp=self._now())))

    def flush(self) -> None:
        """Wait until the published messages have arrived; for a process that ends afterwards."""
        patience = Duration(seconds=LONGEST_DELIVERY)
        for publisher in (self._recognition, self._label):
            publisher.wait_for_all_acked(patience)
        self._phrases.flush(patience)

    def _tell(self, header: Header, state: int) -> None:
        if state != self._told:
            self._told = state
            self._state.publish(RecognizerState(header=header, state=state))

    def _now(self) -> Time:
        return self._node.get_clock().now().to_msg()


def to_recognition_message(
    event: TakeRecognized | TakeRejected, language: ActiveLanguage, clock: Stopwatch, header: Header
) -> GestureRecognition:
    """Convert a take to a message; see `RecognitionTopics.publish_take`."""
    fields = list_message_fields(event, language.name)
    fields["profile"] = language.recognizer.profile
    return GestureRecognition(
        header=header,
        body_id=DIVER,
        start=clock.stamp(event.start),
        end=clock.stamp(event.end),
        **fields,
    )


def to_language_message(language: ActiveLanguage, header: Header) -> LanguageMessage:
    """Convert a language to a message."""
    content = language.recognizer.language
    return LanguageMessage(
        header=header,
        language_id=language.sha256,
        name=language.name,
        revision=language.revision,
        profile=language.recognizer.profile,
        labels=list(content.labels),
        commands=[format_command(gesture.command) for gesture in content.gestures],
        phrase_labels=list_phrase_labels(language),
    )
