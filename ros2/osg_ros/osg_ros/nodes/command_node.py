"""Gestures and phrases in, commands out: after confirmation, never of what is rejected or stale.

It needs no OSG Studio, only the messages, so it runs wherever ROS 2 does.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from osg_interfaces.msg import ActiveLanguage, Command, CommandState, GestureRecognition, Phrase
from std_msgs.msg import Header

from osg_ros.commands.dialogue import (
    CONFIRM_SECONDS,
    STALE_SECONDS,
    CommandDialogue,
    CommandTable,
    Decision,
    HeardGesture,
    HeardPhrase,
    Rules,
)
from osg_ros.commands.table import read_commands
from osg_ros.nodes.managed_node import LATCHED, RESULTS, ManagedNode
from osg_ros.nodes.process import spin
from osg_ros.parameters import Setting
from osg_ros.topics.stamps import NANOSECONDS, nanoseconds_of, stamp_of

LANGUAGE: Final = Setting(
    "language", "", "Path of the language file, for where nobody tells the topic `language`."
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
CANCEL: Final = Setting("cancel", [""], "Labels that take back what waits for its repetition.")
EMERGENCY: Final = Setting("emergency", [""], "Labels whose commands need no repetition.")

CHECK_SECONDS: Final = 0.2
"""Between two looks at the deadline: a diver notices half a second on the display."""


class CommandNode(ManagedNode):
    """Gives the commands of the active language; `CommandDialogue` decides."""

    def __init__(self, **options: Any) -> None:
        settings = (
            LANGUAGE,
            CONFIRM,
            CONFIRM_WITHIN,
            STALE_AFTER,
            LEAST_CONFIDENCE,
            CANCEL,
            EMERGENCY,
        )
        # Divers are silent most of the time.
        super().__init__("command_node", settings, "recognition", steady=False, **options)
        self._dialogue = CommandDialogue(Rules())
        self._timer: Any = None

    def prepare(self) -> None:
        """Read the rules and the commands, and make the publishers.

        Raises
        ------
        ValueError
            When the rules contradict each other, or the file is no language.
        OSError
            When it cannot be read.

        """
        rules = Rules(
            confirmed=self.settings["confirm"],
            confirm_seconds=self.settings["confirm_seconds"],
            stale_seconds=self.settings["stale_seconds"],
            least_confidence=self.settings["least_confidence"],
            cancel=frozenset(self.settings["cancel"]),
            emergency=frozenset(self.settings["emergency"]),
        )
        path = self.settings["language"]
        self._table = read_commands(path) if path else CommandTable()
        self._dialogue = CommandDialogue(rules)
        self._commands = self.publisher(Command, "command", RESULTS)
        self._state = self.publisher(CommandState, "command_state", LATCHED)

    def begin(self) -> None:
        """Listen from now on; nothing of before counts."""
        self._dialogue = CommandDialogue(self._dialogue.rules)
        self._dialogue.speak(self._table)
        self._tell(Decision("waiting for a gesture"), self._now())
        self.subscription(ActiveLanguage, "language", self._speak, LATCHED)
        self.subscription(GestureRecognition, "recognition", self._hear, RESULTS)
        self.subscription(Phrase, "phrase", self._hear_phrase, RESULTS)
        self._timer = self.create_timer(CHECK_SECONDS, self._wait)

    def halt(self) -> None:
        """Forget what waits for its repetition."""
        if self._timer is not None:
            self.destroy_timer(self._timer)
            self._timer = None

    def facts(self) -> Mapping[str, str]:
        """Tell which commands can be given."""
        return {
            "language id": self._dialogue.table.language_id,
            "commands": ", ".join(sorted(self._dialogue.table.commands)),
        }

    def _speak(self, language: ActiveLanguage) -> None:
        meant = zip(language.labels, language.commands, strict=False)
        commands = {label: command for label, command in meant if command}
        table = CommandTable(language.language_id, commands, frozenset(language.phrase_labels))
        decision = self._dialogue.speak(table)
        if decision is not None:
            self._tell(decision, self._now())
        rules = self._dialogue.rules
        unknown = sorted((rules.cancel | rules.emergency) - set(language.labels))
        if unknown:
            self.complain(
                f"the language {language.name!r} has no {unknown}, which shall cancel or be an "
                "emergency; correct the parameters or load the language meant"
            )

    def _hear(self, recognition: GestureRecognition) -> None:
        self.count_input()
        stamp = nanoseconds_of(recognition.header.stamp)
        # A message that contradicts itself is a rejection.
        label = None if recognition.rejected else recognition.label or None
        gesture = HeardGesture(
            label, recognition.confidence, stamp / NANOSECONDS, recognition.language_id
        )
        decision = self._dialogue.hear(gesture, self._now() / NANOSECONDS)
        self._act(decision, recognition)

    def _hear_phrase(self, phrase: Phrase) -> None:
        self.count_input()
        heard = HeardPhrase(
            kind=phrase.kind,
            mission=phrase.mission,
            text=phrase.text,
            confidence=phrase.confidence,
            start=nanoseconds_of(phrase.start) / NANOSECONDS,
            stamp=nanoseconds_of(phrase.header.stamp) / NANOSECONDS,
            label=phrase.label or None,
            language_id=phrase.language_id,
        )
        self._act(self._dialogue.hear_phrase(heard, self._now() / NANOSECONDS), phrase)

    def _act(self, decision: Decision, heard: GestureRecognition | Phrase) -> None:
        """Tell what was decided about a message, and give the command if there is one."""
        self._tell(decision, nanoseconds_of(heard.header.stamp))
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
        decision = self._dialogue.wait(now / NANOSECONDS)
        if decision is not None:
            self._tell(decision, now)

    def _tell(self, decision: Decision, stamp: int) -> None:
        self.get_logger().info(decision.reason)
        pending = self._dialogue.pending
        state = CommandState(header=Header(stamp=stamp_of(stamp)), reason=decision.reason)
        if pending is not None:
            state.state = CommandState.CONFIRMING
            state.label = pending.label
            state.deadline = stamp_of(round(pending.deadline * NANOSECONDS))
        self._state.publish(state)

    def _now(self) -> int:
        return int(self.get_clock().now().nanoseconds)


def main() -> None:
    """Run the node."""
    spin(lambda: [CommandNode()])
