"""Silence of the vehicle, in simulated time: what is restored, what is told, what is sent."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

pytest.importorskip("pymavlink", reason="needs the extra mavlink")

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from app.robot.mavlink.orders import EMERGENCY_SECONDS
from tests.robot.mavlink.diver import Diver, diving
from tests.robot.mavlink.vehicle import SimulatedVehicle

OUTAGES = (5.0, 12.0, 36.0, 600.0)
VEHICLE = {"repeat_seconds": 0.5, "give_up_seconds": 10}
LIGHTS = 1800.0


@pytest.fixture(params=["lights", "tilt"])
def diver(request: pytest.FixtureRequest) -> Iterator[Diver]:
    """Return a diver whose vehicle answers by lights or tilt."""
    shown = {"answers": {"show": [request.param]}, "vehicle": VEHICLE}
    with diving(changes=shown, lights=LIGHTS) as made:
        made.wait(2)
        yield made
    assert not made.bridge._talk._thread.is_alive()


def vehicle_of(diver: Diver) -> SimulatedVehicle:
    assert isinstance(diver.vehicle, SimulatedVehicle)
    return diver.vehicle


def pass_silence(vehicle: SimulatedVehicle, seconds: float) -> None:
    """Let a silence pass, in long steps once every time limit is over."""
    vehicle.linked = False
    vehicle.wait(min(seconds, 40))
    vehicle.wait(max(seconds - 40, 0), step=2.0)


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
    pass_silence(vehicle, seconds)
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
    assert diver.bridge.has_replied


def test_an_emergency_lasts_a_minute_in_which_the_vehicle_is_heard(diver: Diver) -> None:
    vehicle = vehicle_of(diver)
    vehicle.refused = frozenset({int(mavlink.MAV_CMD_DO_SET_MODE)})
    diver.show("help")
    for _ in range(2):
        vehicle.wait(EMERGENCY_SECONDS / 3)
        pass_silence(vehicle, 600)
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
