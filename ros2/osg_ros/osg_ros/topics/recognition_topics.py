"""The topics on which a node tells what was recognised, in what state, and by which language."""

from __future__ import annotations

import json

from builtin_interfaces.msg import Time
from osg_interfaces.msg import ActiveLanguage, GestureRecognition, RecognizerState
from rclpy.duration import Duration
from std_msgs.msg import Header, String

from app.recognition.recording.segmentation import TakeState
from app.robot import (
    PhraseHeard,
    SpokenLanguage,
    StateChanged,
    TakeRecognized,
    TakeRejected,
)
from osg_ros.commands.table import command_text
from osg_ros.nodes.managed_node import LATCHED, RESULTS, ManagedNode
from osg_ros.topics.body_messages import DIVER
from osg_ros.topics.optional_messages import message_type
from osg_ros.topics.phrase_topic import PhraseTopic, phrase_labels
from osg_ros.topics.stamps import Stopwatch

LONGEST_DELIVERY = 2.0
"""Seconds to wait for a subscriber that may be gone."""

STATES = {
    TakeState.idle: RecognizerState.IDLE,
    TakeState.recording: RecognizerState.RECORDING,
    TakeState.done: RecognizerState.DONE,
}


class RecognitionTopics:
    """Publishes what a listener tells.

    A rejected take goes out on `recognition` alone, with its reason. What reads only a label must
    never see one that is not meant.

    Parameters
    ----------
    node
        Whose publishers they become.

    """

    def __init__(self, node: ManagedNode) -> None:
        self._node = node
        self._told: int | None = None
        self._spoken: SpokenLanguage | None = None
        self._recognition = node.publisher(GestureRecognition, "recognition", RESULTS)
        self._label = node.publisher(String, "recognized_gesture", RESULTS)
        self._phrases = PhraseTopic(node)
        self._state = node.publisher(RecognizerState, "state", LATCHED)
        self._language = node.publisher(ActiveLanguage, "language", LATCHED)
        self._classification_type = message_type("vision_msgs", "Classification")
        self._hypothesis_type = message_type("vision_msgs", "ObjectHypothesis")
        if self._classification_type:
            self._classification = node.publisher(
                self._classification_type, "classification", RESULTS
            )

    def taken(
        self,
        event: TakeRecognized | TakeRejected,
        language: SpokenLanguage,
        clock: Stopwatch,
        frame_id: str,
    ) -> None:
        """Tell what a take was.

        Parameters
        ----------
        event
            What the listener says.
        language
            That it was recognised by.
        clock
            From its seconds to stamps.
        frame_id
            The camera.

        """
        header = Header(stamp=clock.stamp(event.time), frame_id=frame_id)
        message = recognition_message(event, language, clock, header)
        self._recognition.publish(message)
        if not isinstance(event, TakeRecognized):
            return
        self._label.publish(String(data=message.label))
        if self._classification_type and self._hypothesis_type:
            hypothesis = self._hypothesis_type(class_id=message.label, score=message.confidence)
            self._classification.publish(
                self._classification_type(header=header, results=[hypothesis])
            )

    def phrased(self, event: PhraseHeard, clock: Stopwatch, frame_id: str) -> None:
        """Tell what came of a gesture or of a pause; see `taken`."""
        self._phrases.heard(event, clock, frame_id)

    def changed(self, event: StateChanged, clock: Stopwatch, frame_id: str) -> None:
        """Tell another state of the salutes; see `taken`."""
        header = Header(stamp=clock.stamp(event.time), frame_id=frame_id)
        self._tell(header, STATES[event.state])

    def active(self, listening: bool) -> None:
        """Tell that pictures are looked at from now on, or no longer."""
        state = RecognizerState.IDLE if listening else RecognizerState.INACTIVE
        self._tell(Header(stamp=self._now()), state)

    def speaks(self, language: SpokenLanguage) -> None:
        """Tell which language is recognised from now on; once, until it changes."""
        if language is not self._spoken:
            self._spoken = language
            self._language.publish(language_message(language, Header(stamp=self._now())))

    def flush(self) -> None:
        """Wait until what was said has arrived, for whoever ends right afterwards."""
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


def recognition_message(
    event: TakeRecognized | TakeRejected, language: SpokenLanguage, clock: Stopwatch, header: Header
) -> GestureRecognition:
    """Return the message of a take; see `RecognitionTopics.taken`."""
    recognized = isinstance(event, TakeRecognized)
    answer = event.recognition
    return GestureRecognition(
        header=header,
        body_id=DIVER,
        language_id=event.sha256,
        language_name=language.name,
        language_revision=event.revision,
        profile=language.recognizer.profile,
        start=clock.stamp(event.start),
        end=clock.stamp(event.end),
        closed=event.closed,
        label=event.label if isinstance(event, TakeRecognized) else "",
        nearest=event.nearest or "",
        confidence=event.confidence or 0.0,
        margin=event.margin or 0.0,
        rejected=not recognized,
        reason=event.reason if isinstance(event, TakeRejected) else "",
        report=json.dumps(answer.to_dict(), allow_nan=False) if answer else "",
    )


def language_message(language: SpokenLanguage, header: Header) -> ActiveLanguage:
    """Return the message of a language."""
    spoken = language.recognizer.language
    return ActiveLanguage(
        header=header,
        language_id=language.sha256,
        name=language.name,
        revision=language.revision,
        profile=language.recognizer.profile,
        labels=list(spoken.labels),
        commands=[command_text(gesture.command) for gesture in spoken.gestures],
        phrase_labels=phrase_labels(language),
    )
