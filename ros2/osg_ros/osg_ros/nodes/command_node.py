"""Command node: turns recognised gestures and phrases into confirmed commands.

Rejected and stale recognitions never become commands. The node needs only the messages, not OSG
Studio, so it runs wherever ROS 2 does.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, Final

from osg_interfaces.msg import ActiveLanguage as LanguageMessage
from osg_interfaces.msg import Answer, Command, CommandState, GestureRecognition, Phrase
from std_msgs.msg import Header

from osg_ros.commands.dialogue import (
    CommandDialogue,
    CommandTable,
    Decision,
    RecognizedGesture,
    RecognizedPhrase,
)
from osg_ros.commands.replies import PULSE_SECONDS
from osg_ros.commands.rules import (
    CONFIRM_SECONDS,
    EMERGENCY_AGE_SECONDS,
    EMERGENCY_CONFIDENCE,
    STALE_SECONDS,
    Rules,
)
from osg_ros.commands.table import read_commands
from osg_ros.nodes.managed_node import LATCHED, RESULTS, ManagedNode
from osg_ros.nodes.process import spin
from osg_ros.parameters import Setting
from osg_ros.topics.stamps import NANOSECONDS, to_nanoseconds, to_stamp

LANGUAGE: Final = Setting(
    "language",
    "",
    "Path of the language file, needed where no node publishes the topic `language`.",
)
CONFIRM: Final = Setting(
    "confirm",
    True,
    "Give a command only when its gesture or message is repeated; emergencies at once.",
)
CONFIRM_WITHIN: Final = Setting(
    "confirm_seconds",
    CONFIRM_SECONDS,
    "Seconds from a gesture to the end of its repetition, or to a message's next gesture.",
    1.0,
    300.0,
)
STALE_AFTER: Final = Setting(
    "stale_seconds",
    STALE_SECONDS,
    "A recognition whose stamp is farther from now, back or ahead, is ignored.",
    0.1,
    60.0,
)
LEAST_CONFIDENCE: Final = Setting(
    "least_confidence", 0.0, "Recognitions below it count as rejected.", 0.0, 1.0
)
CANCEL: Final = Setting(
    "cancel", [""], "Labels that cancel a gesture or message that waits for its repetition."
)
EMERGENCY: Final = Setting("emergency", [""], "Labels whose commands need no repetition.")

EMERGENCY_AFTER: Final = Setting(
    "emergency_seconds",
    EMERGENCY_AGE_SECONDS,
    "As stale_seconds, of an emergency.",
    0.1,
    60.0,
)
EMERGENCY_LEAST: Final = Setting(
    "emergency_confidence",
    EMERGENCY_CONFIDENCE,
    "As least_confidence, of an emergency; the larger one counts.",
    0.0,
    1.0,
)

CHECK_SECONDS: Final = 0.2
"""Seconds between two checks of the deadline; a diver notices a delay of 0.5 s on the display."""


class CommandNode(ManagedNode):
    """Node that publishes the commands of the active language; `CommandDialogue` decides."""

    def __init__(self, **options: Any) -> None:
        settings = (
            LANGUAGE,
            CONFIRM,
            CONFIRM_WITHIN,
            STALE_AFTER,
            LEAST_CONFIDENCE,
            CANCEL,
            EMERGENCY,
            EMERGENCY_AFTER,
            EMERGENCY_LEAST,
        )
        # Divers show no gesture most of the time, so silence is not a fault.
        super().__init__("command_node", settings, "recognition", steady=False, **options)
        self._dialogue = CommandDialogue(Rules())
        self._timer: Any = None

    def prepare(self) -> None:
        """Read the rules and the commands, and create the publishers.

        Raises
        ------
        ValueError
            When the rules contradict each other, or the file is not a language.
        OSError
            When the file cannot be read.

        """
        rules = Rules(
            confirmed=self.settings["confirm"],
            confirm_seconds=self.settings["confirm_seconds"],
            stale_seconds=self.settings["stale_seconds"],
            least_confidence=self.settings["least_confidence"],
            cancel=frozenset(self.settings["cancel"]),
            emergency=frozenset(self.settings["emergency"]),
            emergency_seconds=self.settings["emergency_seconds"],
            emergency_confidence=self.settings["emergency_confidence"],
        )
        path = self.settings["language"]
        self._table = read_commands(path) if path else CommandTable()
        self._dialogue = CommandDialogue(rules)
        self._commands = self.add_publisher(Command, "command", RESULTS)
        self._state = self.add_publisher(CommandState, "command_state", LATCHED)
        self._answers = self.add_publisher(Answer, "answer", RESULTS)
        self._answered = 0

    def begin(self) -> None:
        """Subscribe, with an empty dialogue."""
        self._dialogue = CommandDialogue(self._dialogue.rules)
        self._dialogue.set_table(self._table)
        self._tell(Decision("waiting for a gesture"), self._now())
        self.add_subscription(LanguageMessage, "language", self._speak, LATCHED)
        self.add_subscription(GestureRecognition, "recognition", self._hear, RESULTS)
        self.add_subscription(Phrase, "phrase", self._hear_phrase, RESULTS)
        self._timer = self.create_timer(CHECK_SECONDS, self._wait)

    def halt(self) -> None:
        """Stop the timer of the deadline."""
        if self._timer is not None:
            self.destroy_timer(self._timer)
            self._timer = None

    def facts(self) -> Mapping[str, str]:
        """Return the language and its commands for diagnostics."""
        return {
            "language id": self._dialogue.table.language_id,
            "commands": ", ".join(sorted(self._dialogue.table.commands)),
        }

    def _speak(self, language: LanguageMessage) -> None:
        meant = zip(language.labels, language.commands, strict=False)
        commands = {label: command for label, command in meant if command}
        table = CommandTable(language.language_id, commands, frozenset(language.phrase_labels))
        decision = self._dialogue.set_table(table)
        if decision is not None:
            self._tell(decision, self._now())
        rules = self._dialogue.rules
        unknown = sorted((rules.cancel | rules.emergency) - set(language.labels))
        if unknown:
            self.report_problem(
                f"the language {language.name!r} has no gestures {unknown}, which the parameters "
                "cancel or emergency name; correct them or load another language"
            )

    def _hear(self, recognition: GestureRecognition) -> None:
        self.count_input()
        stamp = to_nanoseconds(recognition.header.stamp)
        # `rejected` and `pair` take precedence over a label in the same message.
        is_answered = not recognition.rejected and not recognition.pair
        label = (recognition.label or None) if is_answered else None
        start = to_nanoseconds(recognition.start)
        gesture = RecognizedGesture(
            label,
            recognition.confidence,
            to_seconds(stamp),
            recognition.language_id,
            # Publishers of other projects may leave it out.
            start=start / NANOSECONDS if start else None,
            body_id=recognition.body_id,
            pair=to_pair(recognition.pair),
            novelty=recognition.novelty,
        )
        decision = self._dialogue.decide(gesture, self._now() / NANOSECONDS)
        self._act(decision, recognition)

    def _hear_phrase(self, phrase: Phrase) -> None:
        self.count_input()
        heard = RecognizedPhrase(
            kind=phrase.kind,
            mission=phrase.mission,
            text=phrase.text,
            confidence=phrase.confidence,
            start=to_nanoseconds(phrase.start) / NANOSECONDS,
            stamp=to_seconds(to_nanoseconds(phrase.header.stamp)),
            label=phrase.label or None,
            language_id=phrase.language_id,
            body_id=phrase.body_id,
            pair=to_pair(phrase.pair),
        )
        self._act(self._dialogue.decide_phrase(heard, self._now() / NANOSECONDS), phrase)

    def _act(self, decision: Decision, heard: GestureRecognition | Phrase) -> None:
        """Publish the decision about a message, and its command if there is one."""
        self._tell(decision, to_nanoseconds(heard.header.stamp))
        if decision.command is not None:
            self._commands.publish(
                Command(
                    header=heard.header,
                    command=decision.command,
                    label=decision.label,
                    emergency=decision.emergency,
                    body_id=heard.body_id,
                    language_id=heard.language_id,
                    language_revision=heard.language_revision,
                )
            )

    def _wait(self) -> None:
        now = self._now()
        decision = self._dialogue.check_deadline(now / NANOSECONDS)
        if decision is not None:
            self._tell(decision, now)

    def _tell(self, decision: Decision, stamp: int) -> None:
        self.get_logger().info(decision.reason)
        pending = self._dialogue.pending
        state = CommandState(header=Header(stamp=to_stamp(stamp)), reason=decision.reason)
        if pending is not None:
            state.state = CommandState.CONFIRMING
            state.label = pending.label
            state.deadline = to_stamp(round(pending.deadline * NANOSECONDS))
        self._state.publish(state)
        # One gesture may be decided about twice, alone and as a part of a message.
        if decision.reply is None or stamp == self._answered:
            return
        self._answered = stamp
        self._answers.publish(
            Answer(
                header=state.header,
                answer=decision.reply.value,
                pulses=decision.reply.pulses,
                pulse_seconds=PULSE_SECONDS,
                text=decision.reason,
            )
        )

    def _now(self) -> int:
        return int(self.get_clock().now().nanoseconds)


def to_pair(labels: Sequence[str]) -> tuple[str, str] | None:
    """Convert the labels of a pair; None for a message without one."""
    return (labels[0], labels[1]) if len(labels) == 2 else None


def to_seconds(nanoseconds: int) -> float:
    """Convert a stamp to seconds; NaN for a message without one."""
    return nanoseconds / NANOSECONDS if nanoseconds else math.nan


def main() -> None:
    """Run the node."""
    spin(lambda: [CommandNode()])
