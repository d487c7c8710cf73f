"""Phrase topic: publishes the phrases that the gestures form."""

from __future__ import annotations

import json

from osg_interfaces.msg import Phrase
from rclpy.duration import Duration
from std_msgs.msg import Header

from app.robot import ActiveLanguage, PhraseHeard
from osg_ros.nodes.managed_node import RESULTS, ManagedNode
from osg_ros.topics.body_messages import DIVER
from osg_ros.topics.stamps import Stopwatch


class PhraseTopic:
    """Publisher of the phrases of a `PhraseListener`.

    Parameters
    ----------
    node
        Node that gets the publisher.

    """

    def __init__(self, node: ManagedNode) -> None:
        self._phrase = node.add_publisher(Phrase, "phrase", RESULTS)

    def publish(self, event: PhraseHeard, clock: Stopwatch, frame_id: str) -> None:
        """Publish a phrase event; see `RecognitionTopics.publish_take`."""
        header = Header(stamp=clock.stamp(event.time), frame_id=frame_id)
        self._phrase.publish(to_phrase_message(event, clock, header))

    def flush(self, patience: Duration) -> None:
        """Wait until the published messages have arrived."""
        self._phrase.wait_for_all_acked(patience)


def to_phrase_message(event: PhraseHeard, clock: Stopwatch, header: Header) -> Phrase:
    """Convert a phrase event to a message.

    Parameters
    ----------
    event
        Event of the listener.
    clock
        Converts the event's seconds to stamps.
    header
        Header of the picture after which the event was known.

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
        pair=list(phrase.pair or ()),
    )


def list_phrase_labels(language: ActiveLanguage) -> list[str]:
    """Return the labels that a language's phrases use, each once; none where it has no phrases."""
    grammar = language.recognizer.language.grammar
    if grammar is None or not grammar.phrases:
        return []
    return list(dict.fromkeys(use.label for use in grammar.uses()))


def _compact(content: object) -> str:
    return json.dumps(content, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
