"""Outages: lights and tilt are as before after any silence, unless the pilot has set them."""

from __future__ import annotations

import ast
import math
from itertools import pairwise
from pathlib import Path
from typing import Any, Literal

import pytest

pytest.importorskip("pymavlink", reason="needs the extra mavlink")

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from app.robot import SourceEnded
from app.robot.commands.replies import Reply
from app.robot.mavlink import patterns
from app.robot.mavlink.actions import CommandStep, VehicleFacts
from app.robot.mavlink.bridge import MavlinkBridge
from app.robot.mavlink.links import open_link
from app.robot.mavlink.patterns import ReplyDesk
from app.robot.mavlink.table import Replies, Vehicle, VehicleTable
from tests.robot.mavlink.diver import TABLE, crew, diving, talking
from tests.robot.mavlink.test_patterns import LIGHTS, answering
from tests.robot.mavlink.vehicle import sailing

OUTAGES = (5.0, 12.0, 36.0, 600.0)
STEP = 0.05
Shown = Literal["lights", "tilt"]
BEFORE = {"lights": 1800.0, "tilt": 0.0}
PILOT = {"lights": 1655.0, "tilt": -5.0}


class Dive:
    """A reply desk and what it sets, in simulated time; a link that can be lost.

    Attributes
    ----------
    value
        Present value of lights or tilt.
    linked
        Whether anything arrives, in either direction.

    """

    def __init__(self, shown: Shown) -> None:
        self.shown = shown
        facts = VehicleFacts(Vehicle())
        facts.function = 0
        self.desk = ReplyDesk(Replies(show=(shown,)), Vehicle(), facts, None, print)
        self.now = 0.0
        self.value = BEFORE[shown]
        self.linked = True
        self.wait(3.0)

    def wait(self, seconds: float) -> None:
        """Let time pass."""
        for _ in range(round(seconds / STEP)):
            self.now += STEP
            if self.linked:
                self.desk.hear(self._report(), self.now)
            self.obey(*self.desk.list_due(self.now, may_begin=True))

    def obey(self, *messages: Any) -> None:
        """Set what messages request, if they arrive."""
        for message in messages:
            if self.linked and message.command == mavlink.MAV_CMD_DO_SET_SERVO:
                self.value = message.param2
            if self.linked and message.command == mavlink.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW:
                assert not math.isnan(message.param2), "ArduPilot refuses a pitch without a yaw"
                self.value = message.param1

    def _report(self) -> Any:
        if self.shown == "lights":
            outputs = [*[1500] * 12, round(self.value), *[1500] * 3]
            report = mavlink.MAVLink_servo_output_raw_message(0, 0, *outputs)
        else:
            half = math.radians(self.value) / 2
            attitude = [math.cos(half), 0.0, math.sin(half), 0.0]
            report = mavlink.MAVLink_gimbal_device_attitude_status_message(
                0, 0, 0, 0, attitude, 0, 0, 0, 0
            )
        report.pack(mavlink.MAVLink(None, 1, 1))
        return report

    def begin_pulse(self) -> None:
        """Give an answer, and wait until its first pulse is shown."""
        self.desk.give(Reply.refused, self.now)
        while self.value == BEFORE[self.shown]:
            self.wait(STEP)

    def order(self, value: float = 1400.0) -> int:
        """Give an order for the same output, whose messages are lost; return its command."""
        command: int = {
            "lights": mavlink.MAV_CMD_DO_SET_SERVO,
            "tilt": mavlink.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW,
        }[self.shown]
        self.obey(*self.desk.hand_over(CommandStep(command, (13.0, value), 1, 1), self.now))
        return command


@pytest.mark.parametrize("seconds", OUTAGES)
@pytest.mark.parametrize("state", ["pattern", "restoring", "order", "emergency"])
@pytest.mark.parametrize("shown", ["lights", "tilt"])
def test_what_was_before_a_pattern_is_restored_after_any_outage(
    shown: Shown, state: str, seconds: float
) -> None:
    dive = Dive(shown)
    dive.begin_pulse()
    dive.linked = False
    if state == "restoring":
        dive.desk.stop(dive.now)
    elif state == "order":
        dive.order()
    elif state == "emergency":
        dive.desk.give(Reply.done, dive.now, emergency=True)
    dive.wait(seconds)
    assert dive.value != BEFORE[shown]
    dive.linked = True
    # An order has its ten seconds, heard or not, before the value before it is restored.
    dive.wait(0.5 if state != "order" or seconds > 10 else 6)
    assert dive.value == BEFORE[shown]
    dive.wait(5)
    assert dive.value == BEFORE[shown]
    assert dive.desk.is_idle


@pytest.mark.parametrize("seconds", OUTAGES)
@pytest.mark.parametrize("shown", ["lights", "tilt"])
def test_what_the_pilot_sets_during_an_outage_stays(shown: Shown, seconds: float) -> None:
    dive = Dive(shown)
    dive.begin_pulse()
    dive.linked = False
    dive.wait(seconds)
    dive.value = PILOT[shown]
    dive.linked = True
    dive.wait(40)
    assert dive.value == PILOT[shown]
    assert dive.desk.is_idle


@pytest.mark.parametrize("ends", ["alone", "cancel", "stop"])
def test_what_a_hanging_vehicle_does_late_is_told_and_was_sent_once(ends: str) -> None:
    changes = {"vehicle": {"repeat_seconds": 0.02, "give_up_seconds": 1}}
    sent = "hold; DO_SET_MODE ALT_HOLD was sent once"
    with diving(changes=changes) as diver:
        diver.wait_until(lambda: diver.bridge._desk._mode is not None)
        diver.vehicle.hangs = True
        diver.wait(0.1)
        asked = diver.vehicle.asked
        diver.confirm("stop")
        diver.wait(0.5)
        if ends == "cancel":
            diver.show("no")
            assert diver.wait_for("cancelled") == f"cancelled: {sent}"
        elif ends == "stop":
            diver.bridge.publish(SourceEnded(diver.time, 100, 0, True))
            assert diver.wait_for("NOT DONE") == f"NOT DONE, robot is stopped: {sent}"
        else:
            assert diver.wait_for("NOT DONE") == f"NOT DONE, no answer: {sent}"
        diver.vehicle.hangs = False
        assert diver.wait_for("done") == "done after all: hold"
        assert diver.vehicle.mode == mavlink.SUB_MODE_ALT_HOLD
        assert diver.vehicle.asked == asked + 1


@pytest.mark.parametrize("shown", ["lights", "tilt"])
def test_an_order_in_a_pulse_is_not_proven_by_the_answers_to_the_pulse(shown: Shown) -> None:
    dive = Dive(shown)
    dive.begin_pulse()
    command = dive.order()
    answer = mavlink.MAVLink_command_ack_message(command, mavlink.MAV_RESULT_ACCEPTED)
    answer.pack(mavlink.MAVLink(None, 1, 1))
    # Of the pulse, of what restores the value before it, of the order.
    heard = [dive.desk.hear(answer, dive.now) for _ in range(3)]
    assert heard == [True, True, False]


def test_a_lost_order_for_the_value_of_a_pulse_ends_no_later_pattern() -> None:
    dive = Dive("lights")
    dive.order(1100.0)
    dive.wait(12)
    dive.begin_pulse()
    dive.wait(10)
    assert dive.value == 1800


def test_nothing_is_set_while_nothing_is_reported() -> None:
    dive = Dive("lights")
    dive.begin_pulse()
    dive.linked = False
    dive.wait(3)
    sets = [
        message.command
        for _ in range(600)
        for message in dive.desk.list_due(dive.now, may_begin=True)
    ]
    assert mavlink.MAV_CMD_DO_SET_SERVO not in sets


@pytest.mark.parametrize("pilot", [None, 1300.0])
def test_a_robot_that_is_killed_in_a_pulse_restores_the_lights_at_its_next_start(
    tmp_path: Path, pilot: float | None
) -> None:
    """A fresh bridge knows nothing but the file that the killed one left."""
    table = VehicleTable.model_validate({**TABLE, **LIGHTS})
    kept, file = b"", tmp_path / "vehicle.toml.before"
    with answering(lights=1800.0, memory=file) as diver:
        diver.show(None)
        diver.wait_until(lambda: diver.vehicle.pulse == 1100)
        kept = file.read_bytes()
    assert not file.exists()
    file.write_bytes(kept)
    with sailing(lights=1100.0 if pilot is None else pilot) as vehicle:
        link = open_link(f"udpout:127.0.0.1:{vehicle.port}", 1, 1)
        lines: list[str] = []
        with talking(MavlinkBridge(table, link, crew, lines.append, memory=file)):
            diver.wait_until(lambda: not file.exists())
            diver.wait(0.5)
            assert vehicle.pulse == (1800 if pilot is None else pilot)


@pytest.mark.parametrize(
    ("function", "reason"),
    [
        (33, "output 1 drives a motor"),
        (84, "output 1 drives a motor"),
        (None, "function of output 1 unknown"),
    ],
)
def test_lights_are_not_set_on_a_motor_or_an_unknown_output(
    monkeypatch: pytest.MonkeyPatch, function: int | None, reason: str
) -> None:
    monkeypatch.setattr(patterns, "LATEST_SECONDS", 1.5)
    changes = {
        **LIGHTS,
        "vehicle": {**TABLE["vehicle"], "lights_servo": 1, "give_up_seconds": 1},
    }
    with answering(changes, function=function, servo=1) as diver:
        diver.wait(1.2)
        diver.show("stop")
        assert diver.wait_for("not shown") == f"not shown to the diver, {reason}: repeat"
        diver.confirm("bright")
        assert diver.wait_for("NOT DONE", "done") == f"NOT DONE, {reason}: lights 50 %"
    assert diver.vehicle.shown == []
    assert diver.vehicle.obeyed == []


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_a_function_that_is_no_number_is_unknown_and_ends_nothing(value: float) -> None:
    facts = VehicleFacts(Vehicle())
    kind = mavlink.MAV_PARAM_TYPE_INT16
    facts.hear(mavlink.MAVLink_param_value_message(b"SERVO13_FUNCTION", value, kind, 900, 77))
    assert facts.obstacle == "function of output 13 unknown"


def test_a_pilot_sets_lights_a_little_less_bright_than_the_pulse() -> None:
    dive = Dive("lights")
    dive.value = 1100.0
    dive.wait(6)
    dive.desk.give(Reply.refused, dive.now)
    while dive.value == 1100:
        dive.wait(STEP)
    dive.wait(STEP)
    assert dive.value == 1660
    dive.value = 1655.0
    dive.wait(40)
    assert dive.value == 1655


@pytest.mark.parametrize(
    "content", [b"", b"[1]", b'{"lights 1 13": [NaN, 1100.0, 1100.0]}', b"\xff"]
)
def test_a_damaged_memory_sets_nothing(tmp_path: Path, content: bytes) -> None:
    file = tmp_path / "vehicle.toml.before"
    file.write_bytes(content)
    with answering(lights=1100.0, memory=file) as diver:
        diver.wait(0.5)
        assert diver.vehicle.shown == []


def test_a_memory_that_cannot_be_written_is_told_at_the_start_and_the_answer_is_shown(
    tmp_path: Path,
) -> None:
    with answering(memory=tmp_path / "no folder" / "before") as diver:
        assert "cannot be written" in diver.wait_for(str(tmp_path))
        diver.show(None)
        diver.wait_until(lambda: len(diver.vehicle.shown) == 2)


def test_every_limit_says_which_seconds_it_counts() -> None:
    limits = {}
    for file in Path(patterns.__file__).parent.glob("*.py"):
        for node in ast.walk(ast.parse(file.read_text())):
            if not isinstance(node, ast.Module | ast.ClassDef):
                continue
            for limit, text in pairwise([*node.body, ast.Pass()]):
                target = limit.target if isinstance(limit, ast.AnnAssign) else None
                if isinstance(target, ast.Name) and target.id.endswith("_SECONDS"):
                    said = ast.unparse(text).lstrip("'\"")
                    limits[target.id] = said.startswith(("Seconds", "Heard seconds"))
    assert len(limits) > 20
    assert [name for name, says in limits.items() if not says] == []
