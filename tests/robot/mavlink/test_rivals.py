"""Two vehicles with the same ids: nothing counts as done while nobody knows which one is meant."""

from __future__ import annotations

import time
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("pymavlink", reason="needs the extra mavlink")

from pydantic import ValidationError
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from app.robot.mavlink.links import SigningTime, open_link
from app.robot.mavlink.peer import MOST_RIVALS, VehiclePeer
from app.robot.mavlink.table import Vehicle, VehicleTable
from tests.ports import free_port
from tests.robot.mavlink.diver import TABLE, Diver, wait_until
from tests.robot.mavlink.test_peer import (
    QUICK,
    Socket,
    acknowledgement,
    beat,
    heard,
    listening_diver,
    packed,
)

HOLD, SURFACE = mavlink.SUB_MODE_ALT_HOLD, mavlink.SUB_MODE_SURFACE


def obedient() -> list[Any]:
    """Return what a vehicle says that seems to obey everything."""
    return [beat(HOLD), beat(SURFACE), acknowledgement()]


def modes_of(received: list[Any]) -> set[float]:
    return {each.param2 for each in received if each.get_type() == "COMMAND_LONG"}


@pytest.mark.usefixtures("closes_soon")
def test_with_two_claimants_orders_wait_and_an_emergency_goes_to_both_and_is_never_done() -> None:
    with (
        listening_diver(QUICK) as (diver, port),
        closing(Socket(port)) as first,
        closing(Socket(port)) as second,
    ):
        first.send_always(obedient, 0.005)
        wait_until(lambda: diver.bridge._talk.peer.sender is not None)
        second.send_always(obedient, 0.005)
        assert diver.wait_for("two vehicles").startswith(
            "two vehicles with system 1, orders wait: 127.0.0.1:"
        )
        diver.confirm("stop")
        assert diver.wait_for("waits") == "waits, two vehicles with system 1: hold"
        said = diver.wait_for("done", "NOT DONE")
        assert said == "NOT DONE, two vehicles with system 1: hold"
        assert (first.commands, second.commands) == ([], [])
        diver.show("help")
        assert diver.wait_for("to both") == "to both, two vehicles with system 1: surface"
        wait_until(lambda: bool(first.commands and second.commands))
        time.sleep(0.3)
        diver.bridge.close()
        said = diver.wait_for("done", "NOT DONE")
        assert said.startswith("NOT DONE, robot has ended: surface; DO_SET_MODE SURFACE was sent")
    for each in (first, second):
        assert modes_of(each.commands) == {SURFACE}
        assert "waits, two vehicles with system 1: hold" in each.texts


@pytest.mark.parametrize("is_first", [True, False])
def test_the_address_that_the_table_names_wins(is_first: bool) -> None:
    vehicle = {**TABLE["vehicle"], "address": "127.0.0.1"}
    with (
        listening_diver({"vehicle": vehicle}) as (diver, port),
        closing(Socket(port, "127.0.0.2")) as rival,
        closing(Socket(port)) as named,
    ):
        for each in (named, rival) if is_first else (rival, named):
            each.send_always(obedient, 0.005)
            time.sleep(0.05)
        wait_until(lambda: diver.bridge._talk.peer.sender is not None)
        said = diver.wait_for("two vehicles")
        assert said.startswith("two vehicles with system 1: 127.0.0.2:")
        assert said.endswith(" is ignored")
        diver.show("help")
        assert diver.wait_for("done", "NOT DONE") == "done: surface"
    assert modes_of(named.commands) == {SURFACE}
    assert rival.commands == []


@pytest.mark.usefixtures("closes_soon")
def test_the_claimant_whose_link_is_signed_wins(tmp_path: Path) -> None:
    key, port = bytes(range(32)), free_port()
    table = VehicleTable.model_validate(TABLE)
    link = open_link(f"udpin:127.0.0.1:{port}", 1, 1, key, tmp_path / "time")
    diver, signing = Diver(None, "", table, link), SigningTime(key, None).signing
    with (
        closing(diver.bridge),
        closing(Socket(port)) as unsigned,
        closing(Socket(port)) as signed,
    ):
        unsigned.send_always(obedient, 0.005)
        time.sleep(0.1)
        signed.send_always(lambda: [packed(each, signing=signing) for each in obedient()], 0.005)
        wait_until(lambda: diver.bridge._talk.peer.sender is not None)
        diver.show("help")
        assert diver.wait_for("done", "NOT DONE", "two vehicles") == "done: surface"
    assert modes_of(signed.commands) == {SURFACE}
    assert unsigned.commands == []


def test_an_order_that_waited_is_sent_and_done_when_the_rival_is_gone() -> None:
    with (
        listening_diver() as (diver, port),
        closing(Socket(port)) as first,
        closing(Socket(port)) as second,
    ):
        first.send_always(obedient, 0.005)
        wait_until(lambda: diver.bridge._talk.peer.sender is not None)
        second.send(beat())
        diver.wait_for("two vehicles")
        diver.confirm("stop")
        diver.wait_for("waits")
        # Ten heard seconds later, without waiting for them.
        diver.bridge._talk.peer._heard_clock.seconds += 10.0
        assert diver.wait_for("done", "NOT DONE") == "done: hold"
    assert second.commands == []


def test_the_block_ends_ten_heard_seconds_after_the_rivals_last_heartbeat() -> None:
    notices: list[str] = []
    found = VehiclePeer(Vehicle(), 0.0, notices.append, None)
    for second in range(4):
        heard(found, beat(), ("h", 1), second)
    heard(found, beat(), ("h", 2), 3.5)
    assert notices == ["two vehicles with system 1, orders wait: h:2"]
    assert found.claimants == [("h", 1), ("h", 2)]
    # Ten minutes in which nobody is heard end no block.
    for second in range(604, 613):
        assert heard(found, beat(), ("h", 1), second)
        assert found.contest
    heard(found, beat(), ("h", 1), 614)
    assert not found.contest
    heard(found, beat(), ("h", 2), 615)
    assert len(notices) == 2


def test_a_rival_that_takes_the_place_of_a_silent_vehicle_is_still_one_of_two() -> None:
    found = VehiclePeer(Vehicle(), 0.0, print, None)
    heard(found, beat(), ("h", 1), 0.0)
    for second in range(1, 16):
        heard(found, beat(), ("h", 2), second)
        assert bool(found.contest) == (second < 15)
    assert found.sender == ("h", 2)


def test_a_flood_of_addresses_is_no_flood_of_commands() -> None:
    notices: list[str] = []
    found = VehiclePeer(Vehicle(), 0.0, notices.append, None)
    for port in range(100):
        heard(found, beat(), ("h", port), 0.0)
    assert len(found.claimants) == 1 + MOST_RIVALS
    assert len(notices) == MOST_RIVALS


@pytest.mark.usefixtures("closes_soon")
def test_of_two_vehicles_behind_one_router_an_emergency_reaches_both() -> None:
    began = time.monotonic()

    def both() -> list[Any]:
        passed = round((time.monotonic() - began) * 1000)
        clocks = [mavlink.MAVLink_system_time_message(0, each + passed) for each in (60_000, 9_000)]
        return [beat(), clocks[0], beat(), clocks[1]]

    with listening_diver(QUICK) as (diver, port), closing(Socket(port)) as router:
        router.send_always(both, 0.01)
        assert diver.wait_for("two vehicles") == "two vehicles with system 1, orders wait"
        diver.confirm("stop")
        said = diver.wait_for("NOT DONE", "done")
        assert said == "NOT DONE, two vehicles with system 1: hold"
        assert router.commands == []
        diver.show("help")
        wait_until(lambda: bool(router.commands))
    assert modes_of(router.commands) == {SURFACE}


@pytest.mark.parametrize("address", ["vehicle.local", "192.168.2.2:14550", ""])
def test_a_table_names_an_ip_address_or_none(address: str) -> None:
    with pytest.raises(ValidationError):
        VehicleTable.model_validate({**TABLE, "vehicle": {"address": address}})
