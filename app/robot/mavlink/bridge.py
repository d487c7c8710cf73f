"""MAVLink bridge: turns the robot's events into confirmed orders for a vehicle."""

from __future__ import annotations

import json
import math
import threading
import time as clock
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from app.recognition.errors import OsgError, VehicleError
from app.recognition.recording.segmentation import TakeState
from app.robot import events
from app.robot.active_language import ActiveLanguage
from app.robot.commands.answers import Answer
from app.robot.commands.dialogue import (
    CommandDialogue,
    CommandTable,
    Decision,
    RecognizedGesture,
    RecognizedPhrase,
)
from app.robot.mavlink.actions import (
    Message,
    Step,
    VehicleFacts,
    build_steps,
    describe_refusal,
)
from app.robot.mavlink.links import Packet, VehicleLink
from app.robot.mavlink.memory import Memory
from app.robot.mavlink.orders import Order, OrderDesk, Outcome, OutcomeKind, is_from_vehicle
from app.robot.mavlink.patterns import AnswerDesk
from app.robot.mavlink.peer import Sender, VehiclePeer
from app.robot.mavlink.table import Action, VehicleTable, describe_actions

TEXT_BYTES: Final = 50
"""Bytes of a STATUSTEXT; many displays cut longer messages to this length."""

TICK_SECONDS: Final = 0.05
"""Seconds to wait for a message: shorter than what a diver or a vehicle notices."""

HEARTBEAT_SECONDS: Final = 1.0
"""Seconds between two of our heartbeats, as MAVLink requires."""

CLOSE_SECONDS: Final = 3.5
"""Seconds that closing waits at most for the active order and the last texts, heard or not: a
service that is stopped must let go of its vehicle."""

HANG_SECONDS: Final = 1.0
"""Seconds more after which a link hangs, which must not keep the process from ending; a loaded
machine tells in them what was not done."""

SIGNATURE_REJECTED: Final = "the vehicle rejects our signature: check the clock"

TOLD: Final[dict[OutcomeKind, tuple[str, int, Answer | None]]] = {
    "done": ("done", mavlink.MAV_SEVERITY_NOTICE, Answer.done),
    "late": ("done after all", mavlink.MAV_SEVERITY_NOTICE, Answer.done),
    "cancelled": ("cancelled", mavlink.MAV_SEVERITY_NOTICE, Answer.done),
    "replaced": ("replaced", mavlink.MAV_SEVERITY_NOTICE, None),
    "refused": ("{}", mavlink.MAV_SEVERITY_WARNING, Answer.refused),
    "unanswered": ("NOT DONE, no answer", mavlink.MAV_SEVERITY_WARNING, Answer.refused),
    "stopped": ("NOT DONE, {}", mavlink.MAV_SEVERITY_WARNING, Answer.refused),
    "waits": ("{}", mavlink.MAV_SEVERITY_CRITICAL, None),
}
"""What is told of an order, with its reason; how severe it is; the answer to the diver, None where
it goes on, or is told by the next one."""


class MavlinkBridge:
    """Bridge from a robot's events to a vehicle; a `Publisher`.

    `publish` decides in the caller's thread, by the same dialogue as the ROS 2 command node. A
    separate thread communicates with the vehicle, so that no picture waits for it.

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
    tell_answer
        Called with every answer that the table lets the diver see, its number of pulses, and its
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
        tell_answer: Callable[[Answer, int, str], None] = lambda answer, pulses, text: None,
        *,
        without_salutes: bool = False,
        memory: Path | None = None,
    ) -> None:
        self._table = table
        self._link = link
        self._language = language
        self._tell_people = tell
        self._now = now
        self._tell_answer = tell_answer
        self._facts = VehicleFacts(table.vehicle)
        kept = Memory(None if table.answers is None else memory, tell)
        self._answers = AnswerDesk(table.answers, table.vehicle, kept, self._facts)
        self._answered = -math.inf
        self._without_salutes = without_salutes
        self._time = 0.0
        self._dialogue = CommandDialogue(table.rules)
        self._desk = OrderDesk(table.vehicle, self._facts)
        self._texts: list[Message] = []
        self._handed: list[Message] = []
        self._pictures = 0
        self._beaten = clock.monotonic()
        self._peer = VehiclePeer(table.vehicle, self._beaten, link.expected)
        self._silent = self._broken = self._is_answered = False
        self._reboots = self._version = 0
        self._fault: Exception | None = None
        # Reentrant, because a line for people may cause an event: that it cannot be printed.
        self._lock = threading.RLock()
        self._closing = threading.Event()
        self._close_by = float("inf")
        self._thread = threading.Thread(target=self._work, name="mavlink", daemon=True)
        self._thread.start()

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
        if self._fault is not None:
            raise self._fault
        with self._lock:
            self._time = event.time
            match event:
                case events.LanguageChanged():
                    self._set_language()
                case events.TakeRecognized() | events.TakeRejected():
                    self._decide_take(event)
                case events.PhraseHeard():
                    self._decide_phrase(event)
                case events.FrameRateChanged():
                    self._say(event.words, mavlink.MAV_SEVERITY_WARNING)
                case events.RecognitionReady():
                    self._say("ready for gestures", mavlink.MAV_SEVERITY_NOTICE)
                    self.answer(Answer.listening, "ready for gestures")
                case events.StateChanged(state=state):
                    self._answers.is_take_open = state is TakeState.recording
                case events.OutputFailed(output=output):
                    self._say(f"{output} cannot be written", mavlink.MAV_SEVERITY_WARNING)
                case events.SourceEnded(stopped=True):
                    self._report(self._desk.stop("robot is stopped"))

    @property
    def has_answered(self) -> bool:
        """Whether nothing is shown to the diver, or waits to be shown."""
        return self._answers.is_idle

    def answer(self, answer: Answer | None, text: str, *, emergency: bool = False) -> None:
        """Show an answer to the diver, if the table says how; None: there is none."""
        if answer is None:
            return
        with self._lock:
            pulses = self._answers.give(answer, clock.monotonic(), emergency=emergency)
        if pulses:
            self._tell_answer(answer, pulses, text)

    def close(self) -> None:
        """Wait for the last order, at most `CLOSE_SECONDS`, and disconnect.

        Texts that were announced before are sent to the vehicle's displays first.
        """
        self._close_by = clock.monotonic() + CLOSE_SECONDS
        self._closing.set()
        self._thread.join(CLOSE_SECONDS + HANG_SECONDS)

    def _set_language(self) -> None:
        active = self._language()
        language = active.recognizer.language
        actions = {label: self._table.find_actions(label) for label in language.labels}
        words = {label: describe_actions(each) for label, each in actions.items() if each}
        grammar = language.grammar
        used = grammar.uses() if grammar is not None and grammar.phrases else ()
        labels = frozenset(use.label for use in used)

        spots = self._without_salutes or active.trigger.spots
        for is_danger, fault in self._table.list_faults(language, spots=spots):
            words = {} if is_danger else words
            severity = mavlink.MAV_SEVERITY_ALERT if is_danger else mavlink.MAV_SEVERITY_WARNING
            self._say(fault, severity)
        decision = self._dialogue.set_table(CommandTable(active.sha256, words, labels))
        if decision is not None:
            self._say(decision.reason)

    def _decide_take(self, event: events.TakeEvent) -> None:
        recognized = isinstance(event, events.TakeRecognized)
        gesture = RecognizedGesture(
            event.label if isinstance(event, events.TakeRecognized) else None,
            event.confidence if recognized and event.confidence is not None else 0.0,
            event.time,
            event.sha256,
            start=event.start,
            pair=event.pair if isinstance(event, events.TakeRejected) else None,
            novelty=math.nan if event.recognition is None else event.recognition.nearest_novelty,
        )
        decision = self._dialogue.decide(gesture, self._source_time())
        is_command = decision.command is not None
        self._act(decision, self._table.find_actions(decision.label or "") if is_command else ())

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
        is_first = self._time > self._answered
        if actions or decision.answer is not None:
            self._answered = self._time
        if decision.cancels and (outcome := self._desk.cancel()):
            self._report(outcome)
            return
        if not actions:
            self._say(decision.reason)
            if is_first:
                self.answer(decision.answer, decision.reason)
            return
        choices = [(action,) for action in actions] if decision.emergency else [actions]
        order, *others = (self._build_order(each, emergency=decision.emergency) for each in choices)
        order = replace(order, others=tuple(others))
        words = describe_actions(actions) if decision.emergency else order.words
        severity = mavlink.MAV_SEVERITY_CRITICAL if order.emergency else mavlink.MAV_SEVERITY_NOTICE
        self._say(f"{'EMERGENCY' if order.emergency else 'confirmed'}: {words}", severity)
        now = clock.monotonic()
        is_known = self._facts.function is not None
        contest = self._peer.contest
        obstacle = self._find_obstacle(order) if is_known and not contest else ""
        if fault := self._peer.find_fault(now) or obstacle:
            self._report(Outcome(order, "stopped", fault))
            return
        self._handed += (
            each for step in order.steps for each in self._answers.hand_over(step, now)
        )
        self._report(self._desk.give(order, now))
        if contest and self._desk.order is order:
            where = "to both" if order.emergency else "waits"
            self._report(Outcome(order, "waits", f"{where}, {contest}"))

    def _build_order(self, actions: Sequence[Action], *, emergency: bool) -> Order:
        steps: list[Step] = []
        for action in actions:
            self._pictures += 1
            steps += build_steps(action, self._table.vehicle, self._pictures)
        return Order(", ".join(action.words for action in actions), tuple(steps), emergency)

    def _source_time(self) -> float:
        return self._time if self._now is None else self._now()

    def _work(self) -> None:
        """Exchange messages with the vehicle until the bridge is closed; runs in the thread."""
        try:
            self._talk()
        except Exception as error:  # passed on to the thread that publishes
            self._fault = error
        finally:
            self._link.close()

    def _talk(self) -> None:
        while self._is_needed():
            packets: Sequence[Packet] = ()
            fault = ""
            try:
                packets = self._link.receive(TICK_SECONDS)
            except (OSError, OsgError) as error:
                fault = str(error)
                self._closing.wait(TICK_SECONDS)
            with self._lock:
                due = self._step(packets)
            # Though nothing can be heard, what is sent may arrive.
            try:
                for message, receiver in due:
                    self._link.send(message, receiver)
            except (OSError, OsgError) as error:
                fault = str(error)
            if fault:
                self._tell_broken(fault)
            elif due:
                self._broken = False
        ignored = self._peer.dropped + self._link.dropped
        if ignored:
            self._tell_people(f"{ignored} messages that are not the vehicle's were ignored")

    def _is_needed(self) -> bool:
        """Return whether the thread goes on: not after the time for closing is over."""
        if not self._closing.is_set():
            return True
        if clock.monotonic() > self._close_by:
            with self._lock:
                self._report(self._desk.stop("robot has ended"))
            return False
        # What was stopped may be done already: the next heartbeat tells.
        is_open = self._desk.order is not None or self._desk.is_watched
        return is_open or bool(self._texts) or self._answers.is_active

    def _step(self, packets: Sequence[Packet]) -> list[tuple[Message, Sender | None]]:
        """Process the received messages and return the messages to send, and to whom."""
        now = clock.monotonic()
        self._peer.expect(self._link.expected)
        for message, sender in packets:
            if not self._peer.admit(message, sender, now, busy=self._desk.order is not None):
                continue
            self._facts.hear(message)
            is_answer = message.get_type() == "COMMAND_ACK"
            self._is_answered |= is_answer and is_from_vehicle(message, self._table.vehicle)
            if not self._answers.hear(message, now):
                self._report(self._desk.hear(message, now, proves=not self._peer.contest))
        self._report(self._desk.check_deadline(now))
        decision = self._dialogue.check_deadline(self._source_time())
        if decision is not None:
            self._say(decision.reason)
            self.answer(decision.answer, decision.reason)
        self._watch_vehicle(now)
        # Orders first: an emergency does not wait for texts, of which each may take its time.
        own: list[Message] = []
        shared: list[Message] = []
        if self._peer.is_proven(now):
            own += [*self._handed, *self._facts.list_due(now)]
            if self._desk.order is not None and not self._find_obstacle(self._desk.order):
                shared += self._desk.list_due(now)
        self._handed.clear()
        shared += self._texts
        self._texts.clear()
        if now - self._beaten >= HEARTBEAT_SECONDS:
            self._beaten = now
            shared.append(build_heartbeat())
        due = [(message, self._peer.sender) for message in own]
        due += [(message, each) for message in shared for each in self._peer.claimants]
        return [*due, *((message, self._peer.sender) for message in self._list_answers(now))]

    def _find_obstacle(self, order: Order) -> str:
        """Return why an order must not be sent; empty if it may."""
        if contest := self._peer.contest:
            return "" if order.emergency else contest
        sets = any(step.command == mavlink.MAV_CMD_DO_SET_SERVO for step in order.steps)
        return self._facts.obstacle if sets else ""

    def _list_answers(self, now: float) -> Iterator[Message]:
        """Yield the messages that show answers to the diver."""
        is_proven = self._peer.is_proven(now)
        if self._closing.is_set() or not is_proven:
            self._answers.stop(now)
        if is_proven:
            yield from self._answers.list_due(now, may_begin=not self._closing.is_set())
        for notice in self._answers.notices:
            self._tell_people(notice)
        self._answers.notices.clear()

    def _watch_vehicle(self, now: float) -> None:
        """Announce that the vehicle is silent, is back, has restarted, or must not be commanded."""
        for notice in self._peer.take_notices():
            self._say(notice, mavlink.MAV_SEVERITY_ALERT)
        if fault := self._peer.find_fault(now):
            self._report(self._desk.stop(fault))
        silent = self._peer.is_silent(now)
        if silent != self._silent:
            self._silent = silent
            words = "vehicle is silent" if silent else "vehicle is back"
            self._say(words, mavlink.MAV_SEVERITY_ALERT)
        if self._facts.version != self._version:
            self._version = self._facts.version
            for mode in self._table.list_modes():
                if refusal := describe_refusal(mode, self._version):
                    self._say(refusal, mavlink.MAV_SEVERITY_WARNING)
        if self._desk.reboots != self._reboots:
            self._reboots = self._desk.reboots
            self._say("vehicle has started again", mavlink.MAV_SEVERITY_ALERT)
            self._answers.forget()

    def _report(self, outcome: Outcome | None) -> None:
        """Announce what became of an order; None: nothing new."""
        if outcome is None:
            return
        if outcome.kind == "unanswered" and (obstacle := self._find_obstacle(outcome.order)):
            outcome = replace(outcome, kind="stopped", answer=obstacle)
        told, severity, answer = TOLD[outcome.kind]
        sent = f"; {outcome.sent}" if outcome.sent else ""
        text = f"{told.format(outcome.answer)}: {outcome.order.words}{sent}"
        self._say(text, severity)
        self.answer(answer, text, emergency=outcome.order.emergency)
        # A vehicle drops without a word what is signed wrongly, or with a time before the last.
        is_deaf = not (self._silent or self._is_answered or self._peer.sender is None)
        if outcome.kind == "unanswered" and is_deaf and self._table.vehicle.key_file:
            self._say(SIGNATURE_REJECTED, mavlink.MAV_SEVERITY_ALERT)

    def _say(self, text: str, severity: int = mavlink.MAV_SEVERITY_INFO) -> None:
        """Announce a text here and on the displays of the vehicle's network."""
        self._tell_people(text)
        self._texts.append(mavlink.MAVLink_statustext_message(severity, fit_text(text)))

    def _tell_broken(self, reason: str) -> None:
        if not self._broken:
            self._broken = True
            self._tell_people(f"no connection to the vehicle: {reason}")


def build_heartbeat() -> Message:
    """Build our heartbeat: that of an on-board computer, not of an autopilot."""
    return mavlink.MAVLink_heartbeat_message(
        mavlink.MAV_TYPE_ONBOARD_CONTROLLER,
        mavlink.MAV_AUTOPILOT_INVALID,
        0,
        0,
        mavlink.MAV_STATE_ACTIVE,
        3,  # version of MAVLink's heartbeat
    )


def fit_text(text: str) -> bytes:
    """Return a text in UTF-8, cut after the last whole character that fits a STATUSTEXT."""
    return text.encode()[:TEXT_BYTES].decode("utf-8", "ignore").encode()
