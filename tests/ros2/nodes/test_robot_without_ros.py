"""Subscribers with the real rclpy receive what a robot without ROS 2 publishes."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Iterable

import pytest
import rclpy
from osg_interfaces.msg import Answer, GestureRecognition, Phrase
from std_msgs.msg import String

from app.robot import PhraseHeard, TakeRecognized, TakeRejected
from app.robot.event_messages import MESSAGES, format_line
from osg_ros.topics.stamps import to_nanoseconds
from tests.robot.publishing_robot import list_round_events
from tests.ros2 import workspace
from tests.ros2.nodes.bench import PATIENCE, RELIABLE, Bench

pytest.importorskip("cyclonedds", reason="needs the extra dds")

ROUNDS = 2
"""Rounds to receive: a subscriber that joins amid the first has all by the end of the second."""


@pytest.mark.slow
def test_ros_receives_every_take_and_phrase_as_the_robot_emitted_it(
    bench: Bench, domain: int
) -> None:
    events = list_round_events()
    emitted_takes = [each for each in events if isinstance(each, TakeRecognized | TakeRejected)]
    emitted_labels = [each.label for each in emitted_takes if isinstance(each, TakeRecognized)]
    emitted_phrases = [each for each in events if isinstance(each, PhraseHeard)]
    takes: list[GestureRecognition] = []
    labels: list[String] = []
    phrases: list[Phrase] = []
    answers: list[Answer] = []
    lines: list[String] = []
    for kind, topic, seen in (
        (GestureRecognition, "recognition", takes),
        (String, "recognized_gesture", labels),
        (Phrase, "phrase", phrases),
        (Answer, "answer", answers),
        (String, "events", lines),
    ):
        bench.probe.create_subscription(kind, f"/osg/{topic}", seen.append, RELIABLE)

    def all_received() -> bool:
        return (
            len(takes) >= ROUNDS * len(emitted_takes)
            and len(labels) >= ROUNDS * len(emitted_labels)
            and len(phrases) >= ROUNDS * len(emitted_phrases)
            and len(answers) >= ROUNDS
            and len(lines) >= ROUNDS * len(events)
        )

    robot = [sys.executable, "-m", "tests.robot.publishing_robot"]
    with subprocess.Popen(robot, env=workspace.environment(domain)) as process:
        try:
            end = time.monotonic() + PATIENCE
            while not all_received() and time.monotonic() < end:
                rclpy.spin_once(bench.probe, timeout_sec=0.1)
        finally:
            process.kill()
    assert all_received()
    compare_takes(takes, emitted_takes)
    compare_phrases(phrases, emitted_phrases)
    assert {(each.answer, each.pulses) for each in answers} == {("one_of_two", 3)}
    assert {label.data for label in labels} == set(emitted_labels)
    assert {line.data for line in lines} == {format_line(event) for event in events}
    assert {MESSAGES.validate_json(line.data).event for line in lines} == {
        "language_changed",
        "state_changed",
        "take_recognized",
        "take_rejected",
        "phrase_heard",
        "answer_given",
    }


def nanoseconds(moment: float) -> int:
    """Of a moment in seconds, as stamps have it."""
    return round(moment * 1e9)


def compare_takes(
    takes: Iterable[GestureRecognition], events: Iterable[TakeRecognized | TakeRejected]
) -> None:
    expected = {(nanoseconds(event.start), nanoseconds(event.end)): event for event in events}
    received = {(to_nanoseconds(take.start), to_nanoseconds(take.end)): take for take in takes}
    assert received.keys() == expected.keys()
    assert {len(take.pair) for take in takes} == {0, 2}
    for span, take in received.items():
        event = expected[span]
        assert take.rejected is isinstance(event, TakeRejected)
        assert take.label == ("" if isinstance(event, TakeRejected) else event.label)
        assert (take.nearest, take.confidence) == (event.nearest, event.confidence)
        assert (take.language_id, take.language_revision) == (event.sha256, event.revision)
        assert take.language_name == "pool"
        assert tuple(take.pair) == (getattr(event, "pair", None) or ())
        assert event.recognition is not None
        assert take.novelty == event.recognition.nearest_novelty
        assert json.loads(take.report)["nearest"] == event.nearest


def compare_phrases(phrases: Iterable[Phrase], events: Iterable[PhraseHeard]) -> None:
    expected = {event.phrase.kind: event for event in events}
    received = {phrase.kind: phrase for phrase in phrases}
    assert received.keys() == expected.keys() == {Phrase.COMPLETE, Phrase.OUTSIDE}
    for kind, message in received.items():
        event = expected[kind]
        phrase = event.phrase
        assert to_nanoseconds(message.header.stamp) == nanoseconds(event.time)
        assert to_nanoseconds(message.start) == nanoseconds(phrase.start)
        assert to_nanoseconds(message.end) == nanoseconds(phrase.end)
        assert (message.language_id, message.language_revision) == (event.sha256, event.revision)
        assert tuple(message.gestures) == phrase.gestures
        assert tuple(message.expected) == phrase.expected
        assert message.label == (phrase.label or "")
        assert (message.confidence, message.text) == (event.confidence, phrase.text)
        mission = phrase.mission.to_list() if phrase.mission else None
        assert (json.loads(message.mission) if message.mission else None) == mission
    assert json.loads(received[Phrase.COMPLETE].mission)[0]["command"] == {"do": "photo"}
