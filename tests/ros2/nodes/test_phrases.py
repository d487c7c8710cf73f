"""Keypoints in, phrases out, and of a phrase that is shown twice one command."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

from osg_interfaces.msg import (
    BodyKeypoints,
    Command,
    CommandState,
    GestureRecognition,
    Hands,
    Phrase,
)
from rosgraph_msgs.msg import Clock

from app.recognition import Recording, takes_in
from app.recognition.phrases.grammar import Grammar
from app.recognition.phrases.phrase import OneOf
from app.recognition.phrases.phrase import Phrase as LanguagePhrase
from osg_ros.nodes.command_node import CommandNode
from osg_ros.nodes.recognition_node import RecognitionNode
from osg_ros.topics.stamps import to_nanoseconds, to_stamp
from tests.api.recordings import recording_of
from tests.ros2.nodes.bench import LATCHED, Bench
from tests.ros2.nodes.keypoint_messages import messages_of, stamped
from tests.ros2.nodes.test_recognition_node import language_of

PHOTO = LanguagePhrase("photo", (OneOf(("circle",)),), {"do": "photo"}, "take a photo")
SPOKEN = "mission: take a photo"
CLOSED = Grammar((PHOTO,), end="line", timeout=5)
OPEN = Grammar((replace(PHOTO, parts=(*PHOTO.parts, OneOf(("line",), least=0))),), timeout=5)


class Robot:
    """A recogniser and a command node that share a language with the phrase ``photo``."""

    def __init__(self, bench: Bench, folder: Path, grammar: Grammar, **rules: Any) -> None:
        path = folder / "phrases.json"
        replace(language_of("circle", "line"), grammar=grammar).save(path)
        self._bench = bench
        self.phrases = bench.subscribe(Phrase, "phrase")
        self.commands = bench.subscribe(Command, "command")
        self.states = bench.subscribe(CommandState, "command_state", LATCHED)
        # Played faster than it was shown: the recording's clock says what is late.
        self._node = bench.active(CommandNode, use_sim_time=True, stale_seconds=60.0, **rules)
        self._recogniser = bench.active(RecognitionNode, language=str(path))
        bench.wait(lambda: self._node.facts()["language id"] != "", "language")
        self._clock = bench.speaker(Clock, "/clock")
        self._bodies = bench.speaker(BodyKeypoints, "body_keypoints")
        self._hands = bench.speaker(Hands, "hands")
        for topic in ("phrase", "recognition"):
            bench.wait(lambda topic=topic: self._listened(topic), topic)  # type: ignore[misc]

    def show(self, recording: Recording) -> None:
        """Show a recording, with its stamps."""
        self.see(messages_of(recording))

    def see(self, pictures: Iterable[tuple[BodyKeypoints, Hands]]) -> None:
        """See bodies and hands one by one, as they are stamped."""
        for body, hands in pictures:
            now, inputs = to_nanoseconds(body.header.stamp), self._recogniser.health.inputs
            self._clock.publish(Clock(clock=to_stamp(now)))
            self._bench.wait(lambda now=now: self._now() == now, "time")  # type: ignore[misc]
            self._bodies.publish(body)
            self._hands.publish(hands)
            self._bench.wait(
                lambda inputs=inputs: self._recogniser.health.inputs > inputs,  # type: ignore[misc]
                "picture seen",
            )

    def _listened(self, topic: str) -> bool:
        return bool(self._node.count_publishers(topic)) and bool(
            self._recogniser.count_subscribers(topic)
        )

    def _now(self) -> int:
        return int(self._node.get_clock().now().nanoseconds)


def test_a_message_that_is_shown_twice_gives_one_command(bench: Bench, tmp_path: Path) -> None:
    robot = Robot(bench, tmp_path, CLOSED, confirm_seconds=60.0)
    recognitions = bench.subscribe(GestureRecognition, "recognition")
    recording = recording_of("circle", "line", "circle", "line")
    robot.show(recording)
    bench.wait(lambda: len(recognitions) == len(robot.phrases) == 4, "phrases")
    bench.wait(lambda: bool(robot.commands), "command")
    assert [phrase.kind for phrase in robot.phrases] == [Phrase.CONTINUES, Phrase.COMPLETE] * 2
    first, last = robot.phrases[:2]
    assert (list(first.gestures), first.label, list(first.expected)) == (
        ["circle"],
        "circle",
        ["line"],
    )
    takes = takes_in(recording)
    assert to_nanoseconds(last.start) == stamped(takes[0].start)
    assert to_nanoseconds(last.end) == stamped(takes[1].end)
    assert (last.body_id, last.header.frame_id, last.text) == ("diver", "camera", SPOKEN)
    assert last.confidence == min(each.confidence for each in recognitions[:2])
    (asked,) = {each.label: each for each in robot.states if each.state == each.CONFIRMING}.values()
    assert asked.label == SPOKEN
    # The gestures alone have commands in this language, and gave none.
    (command,) = robot.commands
    assert [each["command"] for each in json.loads(command.command)] == [{"do": "photo"}]
    assert (command.label, command.emergency) == (SPOKEN, False)
    assert (command.language_id, command.body_id) == (last.language_id, "diver")
    assert command.header.stamp == robot.phrases[-1].header.stamp


def test_a_pause_ends_a_message_that_needs_no_end(bench: Bench, tmp_path: Path) -> None:
    robot = Robot(bench, tmp_path, OPEN, confirm=False)
    recording = recording_of("circle")
    robot.show(recording)
    (*_, (body, hands)) = messages_of(recording)
    body.header.stamp = hands.header.stamp = to_stamp(stamped(recording.poses.duration + 20))
    robot.see([(body, hands)])
    bench.wait(lambda: bool(robot.commands), "command")
    assert [phrase.kind for phrase in robot.phrases] == [Phrase.CONTINUES, Phrase.COMPLETE]
    assert robot.phrases[1].label == ""
    assert robot.commands[0].label == SPOKEN


def test_an_emergency_needs_no_phrase(bench: Bench, tmp_path: Path) -> None:
    robot = Robot(bench, tmp_path, CLOSED, emergency=["circle"])
    robot.show(recording_of("circle"))
    bench.wait(lambda: bool(robot.commands), "command")
    assert (robot.commands[0].label, robot.commands[0].emergency) == ("circle", True)
