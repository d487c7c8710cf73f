"""Gesture topics: publish all landmarks and events of the robot's runtime."""

from __future__ import annotations

from std_msgs.msg import Header

from app.recognition.poses.frame import FrameLandmarks
from app.recognition.text.wording import ask_twins
from app.robot import (
    ActiveLanguage,
    Event,
    Frame,
    FrameRateChanged,
    LanguageChanged,
    LanguageRefused,
    OutputFailed,
    PhraseHeard,
    SourceLost,
    SourceWarned,
    StateChanged,
    TakeRecognized,
    TakeRejected,
)
from osg_ros.nodes.managed_node import ManagedNode
from osg_ros.topics.body_topics import BodyTopics, HandTopics
from osg_ros.topics.recognition_topics import RecognitionTopics
from osg_ros.topics.stamps import Stopwatch


class GestureTopics:
    """Publishers of the landmarks and events of `app.robot.Runtime`.

    Parameters
    ----------
    node
        Node that gets the publishers.

    Attributes
    ----------
    recognitions
        Publishers of the recognitions.

    """

    def __init__(self, node: ManagedNode) -> None:
        self.recognitions = RecognitionTopics(node)
        self._node = node
        self._bodies = BodyTopics(node)
        self._hands = HandTopics(node)

    def publish_frame(self, header: Header, frame: Frame, found: FrameLandmarks) -> None:
        """Publish the landmarks of a frame whose picture has that header."""
        self._node.count_input()
        height, width = frame.image.shape[:2]
        self._bodies.publish(header, (width, height), found.body)
        self._hands.publish(header, (width, height), found.hands)

    def publish_event(
        self, event: Event, language: ActiveLanguage, clock: Stopwatch | None, frame_id: str
    ) -> None:
        """Publish an event.

        Parameters
        ----------
        event
            Event of the runtime.
        language
            The active language.
        clock
            Converts the event's seconds to stamps; None before the first frame.
        frame_id
            Frame of the camera.

        """
        match event:
            case TakeRecognized() | TakeRejected() if clock:
                self.recognitions.publish_take(event, language, clock, frame_id)
            case PhraseHeard() if clock:
                self.recognitions.publish_phrase(event, clock, frame_id)
            case StateChanged() if clock:
                self.recognitions.publish_state(event, clock, frame_id)
            case LanguageChanged(undecided_twins=undecided):
                self.recognitions.publish_language(language)
                for twins in undecided:
                    self._node.report_problem(ask_twins(twins))
            case LanguageRefused() | SourceLost() | SourceWarned() | OutputFailed():
                self._node.report_problem(event.reason)
            case FrameRateChanged(sufficient=False):
                self._node.report_problem(event.words)
            case _:
                pass
