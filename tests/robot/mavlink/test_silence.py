"""Silence of the vehicle, in simulated time: what is restored, what is told, what is sent."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any, cast

import pytest

pytest.importorskip("pymavlink", reason="needs the extra mavlink")

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from app.robot.mavlink import bridge
from app.robot.mavlink.actions import OUR_COMPONENT
from app.robot.mavlink.links import VehicleLink
from app.robot.mavlink.orders import EMERGENCY_SECONDS
from app.robot.mavlink.table import VehicleTable
from tests.robot.mavlink.test_bridge import TABLE, Diver
from tests.robot.mavlink.vehicle import Ardusub

STEP = 0.05
OUTAGES = (5.0, 12.0, 36.0, 600.0)
VEHICLE = {"repeat_seconds": 0.5, "give_up_seconds": 10}
LIGHTS = 1800.0
ORDER = ("COMMAND_LONG", mavlink.MAV_CMD_DO_SET_MODE)


class SimulatedVehicle(Ardusub):
    """A vehicle without sockets, in simulated time, and the link to it, which can be lost.

    Attributes
    ----------
    now
        Seconds of the simulated clock.
    linked
        Whether anything arrives, in either direction.
    unheard
        Commands of orders that were sent while nothing arrived.

    """

    expected: tuple[Any, ...] = ()
    dropped = 0
    now = 0.0
    linked = True

    def _connect(self) -> None:
        self.unheard: list[Any] = []
        self._sent: list[Any] = []
        self._go, self._done = threading.Semaphore(0), threading.Semaphore(0)
        self._ends = False

    def _now(self) -> float:
        return self.now

    def _send(self, message: Any) -> None:
        message.pack(mavlink.MAVLink(None, 1, 1))
        self._sent.append(message)

    def wait(self, seconds: float) -> None:
        """Let time pass, step by step with the bridge's thread."""
        for number in range(round(seconds / STEP)):
            self._done.acquire()
            self.now += STEP
            if self.linked and number % 2 == 0:
                self._report()
            self._go.release()

    def receive(self, seconds: float) -> list[tuple[Any, tuple[Any, ...]]]:
        """Return what has arrived, for the bridge."""
        if self._ends:
            self.now += STEP
        else:
            self._done.release()
            self._go.acquire()
        found, self._sent = self._sent, []
        return [(message, ()) for message in found]

    def send(self, message: Any, to: Any) -> None:
        """Bring the vehicle what the bridge sends."""
        if self.linked:
            message.pack(mavlink.MAVLink(None, 1, OUR_COMPONENT))
            self._hear(message)
        elif (message.get_type(), getattr(message, "command", None)) == ORDER or (
            getattr(message, "param2", None) == 1500
        ):
            self.unheard.append(message)

    def close(self) -> None:
        """End of the link; there is nothing to close."""

    def end(self) -> None:
        """Let the bridge's thread run freely."""
        self._ends = True
        self._go.release()


@pytest.fixture(params=["lights", "tilt"])
def diver(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[Diver]:
    """Return a diver whose vehicle answers by lights or tilt."""
    vehicle = SimulatedVehicle(lights=LIGHTS)
    monkeypatch.setattr(bridge, "clock", SimpleNamespace(monotonic=lambda: vehicle.now))
    shown = {"answers": {"show": [request.param]}, "vehicle": VEHICLE}
    table = VehicleTable.model_validate({**TABLE, **shown})
    made = Diver(vehicle, "", table, cast("VehicleLink", vehicle))
    vehicle.wait(2)
    yield made
    vehicle.end()
    made.bridge.close()
    assert not made.bridge._thread.is_alive()


def vehicle_of(diver: Diver) -> SimulatedVehicle:
    assert isinstance(diver.vehicle, SimulatedVehicle)
    return diver.vehicle


def take_lines(diver: Diver) -> list[str]:
    return [diver.lines.get() for _ in range(diver.lines.qsize())]


ASKED = {"stop": "hold", "deep": "depth 5 m", "bright": "lights 50 %", "help": "surface"}


@pytest.mark.parametrize("seconds", OUTAGES)
@pytest.mark.parametrize("state", ["pattern", "unsent", "unanswered", "accepted"])
@pytest.mark.parametrize("label", ASKED)
def test_an_outage_in_any_state_restores_the_output_and_is_told_truly(
    diver: Diver, label: str, state: str, seconds: float
) -> None:
    vehicle = vehicle_of(diver)
    vehicle.is_slow = state == "accepted"
    is_emergency = label == "help"
    if state in ("pattern", "unanswered") and not is_emergency:
        diver.show(label)  # the answer is shown when the link is lost
        vehicle.wait(0.6)
    if state == "unsent":
        vehicle.linked = False
    if state != "pattern" or is_emergency:
        diver.show(label)
        if not is_emergency and state != "unanswered":
            diver.show(label)
    if state == "accepted":
        vehicle.wait(0.2)
    vehicle.linked = False
    vehicle.wait(seconds)
    assert len(vehicle.unheard) <= (10 if is_emergency else 1)
    vehicle.linked, vehicle.is_slow = True, False
    vehicle.wait(1.0)
    told = [line for line in take_lines(diver) if line.startswith(("done", "NOT DONE", "refused"))]
    vehicle.wait(24.0)
    told += [line for line in take_lines(diver) if line.startswith(("done", "NOT DONE", "refused"))]
    is_done = vehicle.mode != mavlink.SUB_MODE_MANUAL or "servo 13 1500" in vehicle.obeyed
    if is_emergency:
        assert told[-1] == "done: surface"
    elif state != "pattern":
        assert told[-1].startswith(("done", f"NOT DONE, no answer: {ASKED[label]}"))
        # Of a depth the mode may be set alone.
        assert is_done == told[-1].startswith("done") or label == "deep"
    assert vehicle.pulse == (1500 if "servo 13 1500" in vehicle.obeyed else LIGHTS)
    assert vehicle.pitch == 0
    assert diver.bridge.has_answered


def test_an_emergency_lasts_a_minute_in_which_the_vehicle_is_heard(diver: Diver) -> None:
    vehicle = vehicle_of(diver)
    vehicle.refused = frozenset({int(mavlink.MAV_CMD_DO_SET_MODE)})
    diver.show("help")
    for _ in range(2):
        vehicle.wait(EMERGENCY_SECONDS / 3)
        vehicle.linked = False
        vehicle.wait(600)
        vehicle.linked = True
        assert diver.bridge.in_emergency
    vehicle.wait(EMERGENCY_SECONDS / 3 + 5)
    assert not diver.bridge.in_emergency
    assert take_lines(diver)[-1].startswith(
        "NOT DONE, no answer: surface; DO_SET_MODE SURFACE was sent "
    )


def test_a_pilot_who_takes_over_during_an_outage_ends_the_emergency(diver: Diver) -> None:
    vehicle = vehicle_of(diver)
    vehicle.is_slow = True
    diver.show("help")
    vehicle.wait(3)
    vehicle.linked = False
    vehicle.wait(36)
    vehicle.mode, vehicle._accepted = mavlink.SUB_MODE_STABILIZE, None
    vehicle.linked, vehicle.is_slow = True, False
    vehicle.wait(5)
    assert "NOT DONE, the pilot changed the mode: surface" in take_lines(diver)
    assert vehicle.mode == mavlink.SUB_MODE_STABILIZE


def test_an_emergency_that_is_first_shown_in_an_outage_is_sent_whatever_the_mode_is(
    diver: Diver,
) -> None:
    """Nobody knows whether the pilot changed the mode before it or after it."""
    vehicle = vehicle_of(diver)
    vehicle.linked = False
    diver.show("help")
    vehicle.wait(36)
    vehicle.mode = mavlink.SUB_MODE_STABILIZE
    vehicle.linked = True
    vehicle.wait(5)
    assert take_lines(diver)[-1] == "done: surface"
    assert vehicle.mode == mavlink.SUB_MODE_SURFACE
