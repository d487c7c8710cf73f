"""Recognitions in, commands out, as messages; what is decided is tested with the dialogue."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from osg_interfaces.msg import ActiveLanguage as LanguageMessage
from osg_interfaces.msg import Answer, Command, CommandState, GestureRecognition
from std_msgs.msg import Header

from app.robot import ActiveLanguage
from osg_ros.nodes.command_node import CommandNode
from osg_ros.topics.stamps import to_nanoseconds, to_stamp
from tests.ros2.nodes.bench import LATCHED, Bench

PROMPT = 8.0
"""Seconds after which a message is stale, in tests of other things: a slow machine needs many."""

STALE = 600.0
"""Age in seconds that is stale with either setting."""


class Robot:
    """A command node that knows a language, and a diver in front of it."""

    def __init__(self, bench: Bench, **rules: Any) -> None:
        self.bench = bench
        self.commands = bench.subscribe(Command, "command")
        self.answers = bench.subscribe(Answer, "answer")
        self.states = bench.subscribe(CommandState, "command_state", LATCHED)
        self._languages = bench.probe.create_publisher(LanguageMessage, "language", LATCHED)
        self._languages.publish(
            LanguageMessage(
                language_id="id",
                name="pool",
                revision=3,
                labels=["circle", "line", "wave"],
                commands=["photo", '{"go":"up"}', ""],
            )
        )
        self.node = bench.active(CommandNode, **{"stale_seconds": PROMPT, **rules})
        bench.wait(lambda: self.node.facts()["language id"] == "id", "language")
        bench.wait(lambda: bool(self.states), "first state")
        self._recognitions = bench.speaker(GestureRecognition, "recognition")

    def show(self, label: str, *, seconds_ago: float = 0.0, **other: Any) -> str:
        """Show a gesture, and return what the robot says about it."""
        now = self.bench.probe.get_clock().now().nanoseconds - round(seconds_ago * 1e9)
        message = GestureRecognition(
            header=Header(stamp=to_stamp(now)),
            body_id="diver",
            language_id="id",
            language_revision=3,
            label=label,
            nearest=label,
            confidence=0.9,
        )
        for name, value in other.items():
            setattr(message, name, value)
        self._recognitions.publish(message)
        self.bench.wait(
            lambda: self.states[-1].header.stamp == message.header.stamp, f"answer to {label}"
        )
        return str(self.states[-1].reason)


def test_a_command_comes_with_the_repetition_and_its_stamp(bench: Bench) -> None:
    robot = Robot(bench)
    assert robot.show("circle") == "repeat 'circle' to confirm: photo"
    asked = robot.states[-1]
    assert (asked.state, asked.label) == (CommandState.CONFIRMING, "circle")
    seconds = to_nanoseconds(asked.deadline) - to_nanoseconds(asked.header.stamp)
    assert seconds / 1e9 == pytest.approx(20.0)
    assert robot.show("circle") == "'circle': photo"
    bench.wait(lambda: bool(robot.commands), "command")
    (command,) = robot.commands
    assert (command.command, command.label, command.emergency) == ("photo", "circle", False)
    assert (command.body_id, command.language_revision) == ("diver", 3)
    assert command.header.stamp == robot.states[-1].header.stamp
    assert robot.states[-1].state == CommandState.WAITING


def test_an_emergency_needs_no_repetition_and_an_object_stays_one(bench: Bench) -> None:
    robot = Robot(bench, emergency=["line"])
    robot.show("line")
    bench.wait(lambda: bool(robot.commands), "command")
    assert (robot.commands[0].command, robot.commands[0].emergency) == ('{"go":"up"}', True)


def test_a_pair_is_asked_and_the_next_gesture_decides(bench: Bench) -> None:
    robot = Robot(bench, emergency=["line"])
    pair: dict[str, Any] = {"pair": ["circle", "line"], "rejected": True, "nearest": "circle"}
    assert robot.show("", **pair) == "line or circle? show it again"
    asked = robot.states[-1]
    assert (asked.state, asked.label) == (CommandState.CONFIRMING, "circle or line")
    assert robot.show("circle") == "'circle': photo"
    bench.wait(lambda: bool(robot.commands), "command")
    assert [command.label for command in robot.commands] == ["circle"]


def test_each_answer_to_the_diver_comes_once_with_its_pattern(bench: Bench) -> None:
    robot = Robot(bench, cancel=["wave"])
    pair: dict[str, Any] = {"pair": ["circle", "line"], "rejected": True}
    for label, other in (("circle", {}), ("circle", {}), ("", pair), ("wave", {}), ("", {})):
        robot.show(label, **other)
    bench.wait(lambda: len(robot.answers) >= 4, "answers")
    shown = [(each.answer, each.pulses) for each in robot.answers]
    # Who carries out the command answers that it is done.
    assert shown == [("repeat", 2), ("one_of_two", 3), ("done", 4), ("refused", 5)]
    assert {each.pulse_seconds for each in robot.answers} == {0.5}
    assert robot.answers[0].text == "repeat 'circle' to confirm: photo"


@pytest.mark.parametrize(
    "other",
    [
        {"rejected": True},
        {"confidence": 0.3},
        {"novelty": 0.9},
        {"pair": ["line", "wave"]},
        {"pair": ["line", "wave", "circle"]},
    ],
)
def test_nothing_comes_of_what_is_rejected_or_unsure(bench: Bench, other: dict[str, Any]) -> None:
    robot = Robot(bench, emergency=["line"], least_confidence=0.5)
    robot.show("line", **other)
    # A report on the first would come before the report on the second.
    robot.show("circle")
    robot.show("circle")
    bench.wait(lambda: bool(robot.commands), "command")
    assert [command.label for command in robot.commands] == ["circle"]


@pytest.mark.parametrize(
    "other",
    [
        {"seconds_ago": STALE},
        {"seconds_ago": 86_400.0},
        {"language_id": "older"},
        {"language_id": "older", "header": Header()},
        {"header": Header()},
        {"confidence": 0.0},
    ],
)
def test_an_emergency_of_a_bag_of_another_language_or_unsure_moves_nothing(
    bench: Bench, other: dict[str, Any]
) -> None:
    robot = Robot(bench, emergency=["line"])
    assert robot.show("line", **other).startswith(("ignored", "not understood"))
    assert robot.show("circle").startswith("repeat")
    assert robot.commands == []
    assert robot.show("line").startswith("emergency")
    bench.wait(lambda: bool(robot.commands), "command")
    assert [command.label for command in robot.commands] == ["line"]


def test_two_recognitions_of_one_take_and_another_body_confirm_nothing(bench: Bench) -> None:
    robot = Robot(bench)
    now = bench.probe.get_clock().now().nanoseconds
    start = to_stamp(now - 1_500_000_000)
    assert robot.show("circle", seconds_ago=0.05, start=start).startswith("repeat")
    assert "once more" in robot.show("circle", start=start)
    assert robot.show("circle", body_id="other").startswith("repeat")
    assert robot.commands == []


def test_a_gesture_can_take_it_back(bench: Bench) -> None:
    robot = Robot(bench, cancel=["wave"])
    robot.show("circle")
    assert robot.show("wave") == "'circle' is cancelled"
    assert robot.show("circle").startswith("repeat")
    assert robot.commands == []


def test_what_is_not_repeated_is_given_up_aloud(bench: Bench) -> None:
    robot = Robot(bench, confirm_seconds=1.0, stale_seconds=4.0)
    robot.show("circle")
    count = len(robot.states)
    bench.wait(lambda: len(robot.states) > count, "end of the wait")
    assert robot.states[-1].state == CommandState.WAITING
    assert robot.states[-1].reason == "'circle' was not repeated in time; show it twice"


def test_the_language_file_is_enough_where_nobody_tells_the_language(
    bench: Bench, language_file: Path
) -> None:
    node = bench.active(CommandNode, language=str(language_file))
    spoken = ActiveLanguage.load(language_file)
    assert node.facts() == {"language id": spoken.sha256, "commands": "circle, three, wedge"}


def test_a_label_that_the_language_lacks_is_told_to_diagnostics(bench: Bench) -> None:
    robot = Robot(bench, emergency=["stop!"])
    report = robot.node.health.report(0.0, 1.0, {})
    assert "has no gestures ['stop!']" in report.status[0].message
