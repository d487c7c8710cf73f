"""All topics of the recogniser, fed by the robot's runtime."""

from __future__ import annotations

from std_msgs.msg import Header

from app.recognition.estimation import FrameLandmarks
from app.robot import (
    Event,
    Frame,
    LanguageChanged,
    LanguageRefused,
    PhraseHeard,
    SourceLost,
    SourceWarned,
    SpokenLanguage,
    StateChanged,
    TakeRecognized,
    TakeRejected,
)
from osg_ros.nodes.managed_node import ManagedNode
from osg_ros.topics.body_topics import BodyTopics, HandTopics
from osg_ros.topics.recognition_topics import RecognitionTopics
from osg_ros.topics.stamps import Stopwatch


class GestureTopics:
    """Publishes what `app.robot.Runtime` sees and tells.

    Parameters
    ----------
    node
        Whose publishers they become.

    Attributes
    ----------
    recognitions
        Those of them that tell what was recognised.

    """

    def __init__(self, node: ManagedNode) -> None:
        self.recognitions = RecognitionTopics(node)
        self._node = node
        self._bodies = BodyTopics(node)
        self._hands = HandTopics(node)

    def look(self, header: Header, frame: Frame, found: FrameLandmarks) -> None:
        """Tell what was found in a frame whose picture has that header."""
        self._node.count_input()
        height, width = frame.image.shape[:2]
        self._bodies.publish(header, (width, height), found.body)
        self._hands.publish(header, (width, height), found.hands)

    def hear(
        self, event: Event, language: SpokenLanguage, clock: Stopwatch | None, frame_id: str
    ) -> None:
        """Tell what happened.

        Parameters
        ----------
        event
            As the runtime gives it.
        language
            That is listened for.
        clock
            From its seconds to stamps; None before the first frame.
        frame_id
            The camera.

        """
        match event:
            case TakeRecognized() | TakeRejected() if clock:
                self.recognitions.taken(event, language, clock, frame_id)
            case PhraseHeard() if clock:
                self.recognitions.phrased(event, clock, frame_id)
            case StateChanged() if clock:
                self.recognitions.changed(event, clock, frame_id)
            case LanguageChanged():
                self.recognitions.speaks(language)
            case LanguageRefused() | SourceLost() | SourceWarned():
                self._node.complain(event.reason)
            case _:
                pass
