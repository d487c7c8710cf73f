"""MAVLink bridge: turns the robot's events into confirmed orders for a vehicle."""

from __future__ import annotations

import json
import math
import time as clock
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import chain, count
from pathlib import Path
from typing import Final

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from app.recognition.errors import VehicleError
from app.recognition.recording.segmentation import TakeState
from app.robot import events
from app.robot.active_language import ActiveLanguage
from app.robot.commands.dialogue import (
    CommandDialogue,
    CommandTable,
    Decision,
    RecognizedGesture,
    RecognizedPhrase,
)
from app.robot.commands.replies import Reply
from app.robot.mavlink.actions import Message, VehicleFacts, build_steps, describe_refusal
from app.robot.mavlink.links import VehicleLink
from app.robot.mavlink.orders import Order, OrderDesk, Outcome, OutcomeKind, is_from_vehicle
from app.robot.mavlink.patterns import ReplyDesk
from app.robot.mavlink.table import Action, VehicleTable, describe_actions
from app.robot.mavlink.talk import VehicleTalk

SIGNATURE_REJECTED: Final = "the vehicle rejects our signature: check the clock"

TOLD: Final[dict[OutcomeKind, tuple[str, int, Reply | None]]] = {
    "done": ("done", mavlink.MAV_SEVERITY_NOTICE, Reply.done),
    "late": ("done after all", mavlink.MAV_SEVERITY_NOTICE, Reply.done),
    "cancelled": ("cancelled", mavlink.MAV_SEVERITY_NOTICE, Reply.done),
    "replaced": ("replaced", mavlink.MAV_SEVERITY_NOTICE, None),
    "refused": ("{}", mavlink.MAV_SEVERITY_WARNING, Reply.refused),
    "unproven": ("NOT DONE, no answer", mavlink.MAV_SEVERITY_WARNING, Reply.refused),
    "stopped": ("NOT DONE, {}", mavlink.MAV_SEVERITY_WARNING, Reply.refused),
    "waits": ("{}", mavlink.MAV_SEVERITY_CRITICAL, None),
}
"""What is told of an order, with its reason; how severe it is; the reply to the diver, None where
it goes on, or is told by the next one."""


class MavlinkBridge:
    """Bridge from a robot's events to a vehicle; a `Publisher`, and what its talk is decided by.

    `publish` decides in the caller's thread, by the same dialogue as the ROS 2 command node. The
    vehicle's acknowledgements are heard, and messages sent, in the thread of a `VehicleTalk`.

    Parameters
    ----------
    table
        Actions of the gestures and phrases.
    link
        Connection to the vehicle; closed with the bridge.
    language
        Returns the active language.
    tell
        Called with every line for people, from either thread.
    now
        Returns the current time in seconds of the source's clock; None takes the time of the last
        event, for recordings.
    tell_reply
        Called with every reply that the table lets the diver see, its number of pulses, and its
        words.
    without_salutes
        Whether gestures are spotted without triggers, whatever the language's.
    memory
        File that keeps what lights and tilt were before a pattern; None: a restart forgets it.

    """

    def __init__(
        self,
        table: VehicleTable,
        link: VehicleLink,
        language: Callable[[], ActiveLanguage],
        tell: Callable[[str], None],
        now: Callable[[], float] | None = None,
        tell_reply: Callable[[Reply, int, str], None] = lambda reply, pulses, text: None,
        *,
        without_salutes: bool = False,
        memory: Path | None = None,
    ) -> None:
        self._table = table
        self._language = language
        self._now = now
        self._tell_reply = tell_reply
        self._facts = VehicleFacts(table.vehicle)
        self._replies = ReplyDesk(table.answers, table.vehicle, self._facts, memory, tell)
        self._without_salutes = without_salutes
        self._time, self._decided = 0.0, -math.inf
        self._dialogue = CommandDialogue(table.rules)
        self._desk = OrderDesk(table.vehicle, self._facts)
        self._handed: list[Message] = []
        self._pictures = count(1)
        self._has_acknowledged = False
        self._talk = VehicleTalk(link, table.vehicle, self, tell)

    def start(self) -> None:
        """Start to talk with the vehicle."""
        self._talk.start()

    def close(self) -> None:
        """Wait for the last order and texts, a few seconds at most, and disconnect."""
        self._talk.close()

    @property
    def in_emergency(self) -> bool:
        """Whether an emergency is in progress."""
        order = self._desk.order
        return order is not None and order.emergency

    def publish(self, event: events.Event) -> None:
        """Decide about one event.

        Raises
        ------
        Exception
            The error that ended the vehicle's thread: a robot that only seems to obey must not go
            on.

        """
        self._talk.check()
        with self._talk.lock:
            self._time = event.time
            match event:
                case events.LanguageChanged():
                    self._set_language()
                case events.TakeRecognized() | events.TakeRejected():
                    self._decide_take(event)
                case events.PhraseHeard():
                    self._decide_phrase(event)
                case events.FrameRateChanged():
                    self._talk.say(event.words, mavlink.MAV_SEVERITY_WARNING)
                case events.RecognitionReady():
                    self._talk.say("ready for gestures", mavlink.MAV_SEVERITY_NOTICE)
                    self.reply(Reply.listening, "ready for gestures")
                case events.StateChanged(state=state):
                    self._replies.is_take_open = state is TakeState.recording
                case events.OutputFailed(output=output):
                    self._talk.say(f"{output} cannot be written", mavlink.MAV_SEVERITY_WARNING)
                case events.SourceEnded(stopped=True):
                    self._report(self._desk.stop("robot is stopped"))

    @property
    def has_replied(self) -> bool:
        """Whether nothing is shown to the diver, or waits to be shown."""
        return self._replies.is_idle

    def reply(self, reply: Reply | None, text: str, *, emergency: bool = False) -> None:
        """Show a reply to the diver, if the table says how; None: there is none."""
        if reply is None:
            return
        with self._talk.lock:
            pulses = self._replies.give(reply, clock.monotonic(), emergency=emergency)
        if pulses:
            self._tell_reply(reply, pulses, text)

    def _set_language(self) -> None:
        active = self._language()
        language = active.recognizer.language
        actions = {label: self._table.find_actions(label) for label in language.labels}
        words = {label: describe_actions(each) for label, each in actions.items() if each}
        grammar = language.grammar
        used = grammar.uses() if grammar is not None and grammar.phrases else ()
        labels = frozenset(use.label for use in used)
        faults = self._table.list_faults(language, without_salutes=self._without_salutes)
        for is_danger, fault in faults:
            words = {} if is_danger else words
            severity = mavlink.MAV_SEVERITY_ALERT if is_danger else mavlink.MAV_SEVERITY_WARNING
            self._talk.say(fault, severity)
        decision = self._dialogue.set_table(CommandTable(active.sha256, words, labels))
        if decision is not None:
            self._talk.say(decision.reason)

    def _decide_take(self, event: events.TakeEvent) -> None:
        gesture = RecognizedGesture(
            event.label,
            event.confidence or 0.0,
            event.time,
            event.sha256,
            start=event.start,
            pair=event.pair if isinstance(event, events.TakeRejected) else None,
            novelty=math.nan if event.recognition is None else event.recognition.nearest_novelty,
        )
        decision = self._dialogue.decide(gesture, self._source_time())
        self._act(
            decision, self._table.find_actions(decision.label or "") if decision.command else ()
        )

    def _decide_phrase(self, event: events.PhraseHeard) -> None:
        phrase, mission, text = event.phrase, "", event.phrase.text
        if phrase.mission is not None:
            listed = phrase.mission.to_list()
            try:
                self._table.resolve_mission(listed)
                mission = json.dumps(listed, allow_nan=False)
            except VehicleError as error:
                text = str(error)
        heard = RecognizedPhrase(
            kind=phrase.kind,
            mission=mission,
            text=text,
            confidence=event.confidence,
            start=phrase.start,
            stamp=event.time,
            label=phrase.label,
            language_id=event.sha256,
            pair=phrase.pair,
        )
        decision = self._dialogue.decide_phrase(heard, self._source_time())
        grammar = self._language().recognizer.language.grammar
        # The same gesture may be an emergency of the table, which has been obeyed already.
        if grammar is not None and heard.label is not None and heard.label == grammar.cancel:
            decision = replace(decision, cancels=heard.label not in self._table.emergency)
        meant = [] if decision.command is None else json.loads(decision.command)
        self._act(decision, self._table.resolve_mission(meant))

    def _act(self, decision: Decision, actions: Sequence[Action]) -> None:
        """Announce the decision and send its actions to the vehicle."""
        # One gesture may be decided about twice, alone and as a part of a message.
        is_first = self._time > self._decided
        if actions or decision.reply is not None:
            self._decided = self._time
        if decision.cancels and (outcome := self._desk.cancel()):
            self._report(outcome)
        elif actions:
            self._order(actions, emergency=decision.emergency)
        else:
            self._talk.say(decision.reason)
            self.reply(decision.reply if is_first else None, decision.reason)

    def _order(self, actions: Sequence[Action], *, emergency: bool) -> None:
        """Begin an order, or report why it must not be sent."""
        choices = [(action,) for action in actions] if emergency else [actions]
        order, *others = (self._build_order(each, emergency=emergency) for each in choices)
        order = replace(order, others=tuple(others))
        words = (
            f"EMERGENCY: {describe_actions(actions)}" if emergency else f"confirmed: {order.words}"
        )
        severity = mavlink.MAV_SEVERITY_CRITICAL if emergency else mavlink.MAV_SEVERITY_NOTICE
        self._talk.say(words, severity)
        now, contest = clock.monotonic(), self._talk.peer.contest
        is_known = self._facts.function is not None
        obstacle = self._find_obstacle(order) if is_known and not contest else ""
        if fault := self._talk.peer.find_fault(now) or obstacle:
            self._report(Outcome(order, "stopped", fault))
            return
        for step in order.steps:
            self._handed += self._replies.hand_over(step, now)
        self._report(self._desk.give(order, now))
        if contest and self._desk.order is order:
            where = "to both" if order.emergency else "waits"
            self._report(Outcome(order, "waits", f"{where}, {contest}"))

    def _build_order(self, actions: Sequence[Action], *, emergency: bool) -> Order:
        vehicle, words = self._table.vehicle, ", ".join(action.words for action in actions)
        built = (build_steps(action, vehicle, next(self._pictures)) for action in actions)
        return Order(words, tuple(chain.from_iterable(built)), emergency)

    def _source_time(self) -> float:
        return self._time if self._now is None else self._now()

    @property
    def is_busy(self) -> bool:
        """Whether an order is in progress."""
        return self._desk.order is not None

    @property
    def is_open(self) -> bool:
        """Whether closing has to wait."""
        # What was stopped may be done already: the next heartbeat tells.
        return self.is_busy or self._desk.is_watched or self._replies.is_active

    def give_up(self) -> None:
        """Drop the order: the time for closing is over."""
        self._report(self._desk.stop("robot has ended"))

    def hear(self, message: Message, now: float) -> None:
        """Process a message of the vehicle."""
        version, reboots = self._facts.version, self._desk.reboots
        self._facts.hear(message)
        if self._facts.version != version:
            for mode in self._table.list_modes():
                if refusal := describe_refusal(mode, self._facts.version):
                    self._talk.say(refusal, mavlink.MAV_SEVERITY_WARNING)
        acknowledges = message.get_type() == "COMMAND_ACK"
        self._has_acknowledged |= acknowledges and is_from_vehicle(message, self._table.vehicle)
        if not self._replies.hear(message, now):
            self._report(self._desk.hear(message, now, proves=not self._talk.peer.contest))
        if self._desk.reboots != reboots:
            self._talk.say("vehicle has started again", mavlink.MAV_SEVERITY_ALERT)
            self._replies.forget()

    def list_due(self, now: float) -> Iterator[tuple[Message, bool]]:
        """Yield the messages to send now, and whether a rival of the vehicle gets them too."""
        self._report(self._desk.check_deadline(now))
        decision = self._dialogue.check_deadline(self._source_time())
        if decision is not None:
            self._talk.say(decision.reason)
            self.reply(decision.reply, decision.reason)
        if fault := self._talk.peer.find_fault(now):
            self._report(self._desk.stop(fault))
        is_proven = self._talk.peer.is_proven(now)
        if is_proven:
            yield from ((each, False) for each in (*self._handed, *self._facts.list_due(now)))
            if self._desk.order is not None and not self._find_obstacle(self._desk.order):
                yield from ((each, True) for each in self._desk.list_due(now))
        self._handed.clear()
        may_begin = not self._talk.closing.is_set()
        if not (may_begin and is_proven):
            self._replies.stop(now)
        if is_proven:
            for each in self._replies.list_due(now, may_begin=may_begin):
                yield each, False

    def _find_obstacle(self, order: Order) -> str:
        """Return why an order must not be sent; empty if it may."""
        if contest := self._talk.peer.contest:
            return "" if order.emergency else contest
        sets = any(step.command == mavlink.MAV_CMD_DO_SET_SERVO for step in order.steps)
        return self._facts.obstacle if sets else ""

    def _report(self, outcome: Outcome | None) -> None:
        """Announce what became of an order; None: nothing new."""
        if outcome is None:
            return
        if outcome.kind == "unproven" and (obstacle := self._find_obstacle(outcome.order)):
            outcome = replace(outcome, kind="stopped", reason=obstacle)
        told, severity, reply = TOLD[outcome.kind]
        sent = f"; {outcome.sent}" if outcome.sent else ""
        text = f"{told.format(outcome.reason)}: {outcome.order.words}{sent}"
        self._talk.say(text, severity)
        self.reply(reply, text, emergency=outcome.order.emergency)
        # A vehicle drops without a word what is signed wrongly, or with a time before the last.
        is_heard = not (self._talk.is_silent or self._talk.peer.sender is None)
        is_deaf = is_heard and not self._has_acknowledged
        if outcome.kind == "unproven" and is_deaf and self._table.vehicle.key_file:
            self._talk.say(SIGNATURE_REJECTED, mavlink.MAV_SEVERITY_ALERT)
