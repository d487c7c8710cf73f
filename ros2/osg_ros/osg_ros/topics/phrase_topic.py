"""The topic on which a node tells which phrases the gestures make."""

from __future__ import annotations

import json

from osg_interfaces.msg import Phrase
from rclpy.duration import Duration
from std_msgs.msg import Header

from app.robot import PhraseHeard, SpokenLanguage
from osg_ros.nodes.managed_node import RESULTS, ManagedNode
from osg_ros.topics.body_messages import DIVER
from osg_ros.topics.stamps import Stopwatch


class PhraseTopic:
    """Publishes what a `PhraseListener` tells of phrases.

    Parameters
    ----------
    node
        Whose publisher it becomes.

    """

    def __init__(self, node: ManagedNode) -> None:
        self._phrase = node.publisher(Phrase, "phrase", RESULTS)

    def heard(self, event: PhraseHeard, clock: Stopwatch, frame_id: str) -> None:
        """Tell what came of a gesture or of a pause; see `RecognitionTopics.taken`."""
        header = Header(stamp=clock.stamp(event.time), frame_id=frame_id)
        self._phrase.publish(phrase_message(event, clock, header))

    def flush(self, patience: Duration) -> None:
        """Wait until what was said has arrived."""
        self._phrase.wait_for_all_acked(patience)


def phrase_message(event: PhraseHeard, clock: Stopwatch, header: Header) -> Phrase:
    """Return the message of what came of a gesture or of a pause.

    Parameters
    ----------
    event
        What the listener says.
    clock
        From its seconds to stamps.
    header
        Of the picture after which it was known.

    """
    phrase = event.phrase
    mission = "" if phrase.mission is None else _compact(phrase.mission.to_list())
    return Phrase(
        header=header,
        body_id=DIVER,
        language_id=event.sha256,
        language_revision=event.revision,
        kind=phrase.kind,
        start=clock.stamp(phrase.start),
        end=clock.stamp(phrase.end),
        gestures=list(phrase.gestures),
        label=phrase.label or "",
        expected=list(phrase.expected),
        confidence=event.confidence,
        mission=mission,
        text=phrase.text,
    )


def phrase_labels(language: SpokenLanguage) -> list[str]:
    """Return the labels that a language's phrases use, each once; none where it has no phrases."""
    grammar = language.recognizer.language.grammar
    if grammar is None or not grammar.phrases:
        return []
    return list(dict.fromkeys(use.label for use in grammar.uses()))


def _compact(content: object) -> str:
    return json.dumps(content, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
