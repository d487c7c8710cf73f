"""The peer: no command goes to anything but the proven vehicle, and nobody else speaks for it."""

from __future__ import annotations

import socket
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from typing import Any

import pytest

pytest.importorskip("pymavlink", reason="needs the extra mavlink")

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from app.robot.mavlink import links, peer, talk
from app.robot.mavlink.actions import OUR_COMPONENT
from app.robot.mavlink.heard import SILENT_SECONDS
from app.robot.mavlink.links import (
    MOST_DATAGRAMS,
    MOST_FAULTS,
    DatagramLink,
)
from app.robot.mavlink.peer import VehiclePeer
from app.robot.mavlink.table import Vehicle, VehicleTable
from tests.ports import free_port
from tests.robot.mavlink.diver import TABLE, Diver, diving, wait_until
from tests.robot.mavlink.mavlink2rest import serving
from tests.robot.mavlink.vehicle import Ardusub, sailing

SUBMARINE, ARDUPILOT = mavlink.MAV_TYPE_SUBMARINE, mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA
ARMED = mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED | mavlink.MAV_MODE_FLAG_SAFETY_ARMED
OTHER_KINDS = [
    (mavlink.MAV_TYPE_SURFACE_BOAT, ARDUPILOT, "ARDUPILOTMEGA, SURFACE_BOAT"),
    (mavlink.MAV_TYPE_GROUND_ROVER, ARDUPILOT, "ARDUPILOTMEGA, GROUND_ROVER"),
    (mavlink.MAV_TYPE_QUADROTOR, ARDUPILOT, "ARDUPILOTMEGA, QUADROTOR"),
    (mavlink.MAV_TYPE_QUADROTOR, mavlink.MAV_AUTOPILOT_PX4, "PX4, QUADROTOR"),
    (SUBMARINE, mavlink.MAV_AUTOPILOT_PX4, "PX4, SUBMARINE"),
    (mavlink.MAV_TYPE_GCS, mavlink.MAV_AUTOPILOT_INVALID, "INVALID, GCS"),
    (250, 251, "MAV_AUTOPILOT 251, MAV_TYPE 250"),
]
QUESTIONS = ("HEARTBEAT", "PARAM_REQUEST_READ", "AUTOPILOT_VERSION_REQUEST")
QUICK: dict[str, Any] = {"vehicle": {"repeat_seconds": 0.02, "give_up_seconds": 0.5}}


def packed(message: Any, system: int = 1, component: int = 1, signing: Any = None) -> bytes:
    """Return a message as it is sent by these ids."""
    codec = mavlink.MAVLink(None, system, component)
    if signing is not None:
        codec.signing = signing
    return bytes(message.pack(codec))


def beat(mode: int = 0, kind: int = SUBMARINE, autopilot: int = ARDUPILOT) -> Any:
    return mavlink.MAVLink_heartbeat_message(kind, autopilot, ARMED, mode, 4, 3)


def acknowledgement(command: int = mavlink.MAV_CMD_DO_SET_MODE) -> Any:
    return mavlink.MAVLink_command_ack_message(command, 0, 0, 0, 1, OUR_COMPONENT)


def test_of_a_vehicle_that_addresses_its_answers_one_without_address_is_anothers() -> None:
    known = VehiclePeer(Vehicle(), 0.0, print, None)
    nobodys = mavlink.MAVLink_command_ack_message(mavlink.MAV_CMD_DO_SET_MODE, 0, 0, 0, 0, 0)
    heard = [beat(), nobodys, acknowledgement(), nobodys, acknowledgement()]
    for message in heard:
        message.pack(mavlink.MAVLink(None, 1, 1))
    assert [known.admit(each, (), 0.0, busy=True) for each in heard] == [
        True,  # the heartbeat
        True,  # an older vehicle addresses none
        True,
        False,
        True,
    ]


def test_another_robot_on_the_vehicle_is_told_once() -> None:
    notices: list[str] = []
    known = VehiclePeer(Vehicle(), 0.0, notices.append, None)
    ours = mavlink.MAVLink_heartbeat_message(18, 8, 0, 0, 4, 3)
    for component, message in ((1, beat()), (OUR_COMPONENT, ours), (OUR_COMPONENT, ours)):
        message.pack(mavlink.MAVLink(None, 1, component))
        known.admit(message, (), 0.0, busy=False)
    assert notices == ["another robot commands this vehicle too"]


class Socket:
    """A sender of datagrams that may be anybody, and counts the commands that it gets."""

    def __init__(self, port: int, host: str = "127.0.0.1") -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind((host, 0))
        self._socket.settimeout(0.01)
        self._port = port
        self._over = threading.Event()
        self._thread: threading.Thread | None = None
        self.commands: list[Any] = []
        self.texts: list[str] = []

    def send(self, *messages: Any) -> None:
        for each in messages:
            data = each if isinstance(each, bytes) else packed(each)
            self._socket.sendto(data, ("127.0.0.1", self._port))

    def send_always(self, messages: Callable[[], list[Any]], seconds: float) -> None:
        """Send again and again, and receive, until it is closed."""

        def work() -> None:
            while not self._over.wait(seconds):
                self.send(*messages())
                self.receive()

        self._thread = threading.Thread(target=work)
        self._thread.start()

    def receive(self) -> None:
        codec = mavlink.MAVLink(None)
        codec.robust_parsing = True
        self._socket.setblocking(False)
        while True:
            try:
                data = self._socket.recv(1000)
            except BlockingIOError:
                return
            for message in codec.parse_buffer(data) or []:
                if message.get_type() == "STATUSTEXT":
                    self.texts.append(message.text)
                elif message.get_type() not in QUESTIONS:
                    self.commands.append(message)

    def close(self) -> None:
        self._over.set()
        if self._thread is not None:
            self._thread.join()
        self.receive()
        self._socket.close()


@contextmanager
def listening_diver(changes: dict[str, Any] | None = None) -> Iterator[tuple[Diver, int]]:
    """Put a diver before a bridge that listens; gives the port as well."""
    port = free_port()
    table = VehicleTable.model_validate({**TABLE, **(changes or {})})
    diver = Diver(None, f"udpin:127.0.0.1:{port}", table)
    with closing(diver.bridge):
        yield diver, port


@pytest.mark.withstands(row="H35")
@pytest.mark.parametrize(("kind", "autopilot", "name"), OTHER_KINDS, ids=lambda value: str(value))
@pytest.mark.parametrize("link", ["simulated", "tcpin"])
def test_a_vehicle_of_another_kind_gets_no_command_and_one_line(
    link: str, kind: int, autopilot: int, name: str
) -> None:
    with diving(link, vehicle_type=kind, autopilot=autopilot) as diver:
        assert diver.wait_for("vehicle is no") == (
            f"vehicle is no ArduSub but {name}; nothing is sent"
        )
        diver.show("help")
        assert diver.wait_for("NOT DONE") == "NOT DONE, no ArduSub: surface"
        diver.confirm("stop")
        assert diver.wait_for("NOT DONE") == "NOT DONE, no ArduSub: hold"
        for label in ("bright", "photo", "deep"):
            diver.confirm(label)
            assert diver.wait_for("NOT DONE")
    assert (diver.vehicle.asked, diver.vehicle.obeyed) == (0, [])
    assert not [line for line in list(diver.lines.queue) if line.startswith("vehicle is no")]


def test_a_vehicle_of_another_kind_behind_mavlink2rest_gets_no_command() -> None:
    with (
        sailing(vehicle_type=mavlink.MAV_TYPE_SURFACE_BOAT) as vehicle,
        serving(vehicle.port) as address,
    ):
        diver = Diver(vehicle, address, VehicleTable.model_validate(TABLE))
        with closing(diver.bridge):
            assert diver.wait_for("vehicle is no ArduSub but ARDUPILOTMEGA, SURFACE_BOAT")
            diver.show("help")
            assert diver.wait_for("NOT DONE, no ArduSub")
    assert vehicle.asked == 0


def test_a_vehicle_that_turns_out_to_be_of_another_kind_ends_the_order() -> None:
    with diving() as diver:
        diver.vehicle.is_slow = True
        diver.confirm("stop")
        diver.wait_for("confirmed")
        diver.vehicle.vehicle_type = mavlink.MAV_TYPE_SURFACE_BOAT
        assert diver.wait_for("NOT DONE", "done") == "NOT DONE, no ArduSub: hold"


@pytest.mark.usefixtures("closes_soon")
def test_no_command_goes_out_before_a_heartbeat() -> None:
    with listening_diver(QUICK) as (diver, port), closing(Socket(port)) as stranger:
        uptime = mavlink.MAVLink_system_time_message(0, 60_000)
        stranger.send_always(lambda: [b"x", uptime, acknowledgement()], 0.005)
        diver.show("help")
        diver.confirm("stop")
        assert diver.wait_for("NOT DONE") == "NOT DONE, EMERGENCY goes on: hold"
        time.sleep(0.3)
    assert stranger.commands == []
    assert stranger.texts == []
    assert diver.wait_for("NOT DONE") == "NOT DONE, robot has ended: surface"
    ignored = diver.wait_for("messages", *"123456789")
    assert int(ignored.split()[0]) > 10


@pytest.mark.withstands(row="H35")
@pytest.mark.parametrize(
    "message",
    [b"x", b"\xfd\xff\x00\x00", packed(beat(), 255, 190), packed(beat(), 1, OUR_COMPONENT)],
    ids=["one byte", "half a message", "ground station", "companion"],
)
def test_nobody_else_gets_the_orders_or_keeps_them_from_the_vehicle(message: bytes) -> None:
    with (
        listening_diver() as (diver, port),
        closing(Socket(port)) as stranger,
        sailing_to(port) as vehicle,
    ):
        stranger.send_always(lambda: [message] * 3, 0.001)
        diver.show("help")
        assert diver.wait_for("done", "NOT DONE") == "done: surface"
        diver.confirm("free")
        assert diver.wait_for("done", "NOT DONE") == "done: mode STABILIZE"
    assert vehicle.obeyed == ["SURFACE", "STABILIZE"]
    assert stranger.commands == []


@contextmanager
def sailing_to(port: int) -> Iterator[Ardusub]:
    """Put a vehicle into the water that sends to a port."""
    with sailing(kind=f"udpout:{port}") as vehicle:
        yield vehicle


def test_a_router_that_speaks_for_the_vehicle_and_for_ground_stations_is_obeyed() -> None:
    with listening_diver() as (diver, port), closing(Socket(port)) as router:
        router.send_always(
            lambda: [packed(beat(), 255, 190), beat(mavlink.SUB_MODE_ALT_HOLD), acknowledgement()],
            0.005,
        )
        diver.confirm("stop")
        assert diver.wait_for("done", "NOT DONE") == "done: hold"
    assert len(router.commands) >= 1


def of_second() -> list[Any]:
    """Return what a second vehicle says that seems to obey."""
    return [beat(mavlink.SUB_MODE_ALT_HOLD), acknowledgement()]


def test_a_second_vehicle_with_the_same_ids_proves_nothing_while_the_first_is_mute() -> None:
    with diving("udpin", QUICK) as diver:
        diver.vehicle.loss = 1.0
        with closing(Socket(sender_port(diver))) as second:
            second.send_always(of_second, 0.005)
            assert diver.wait_for("two vehicles").endswith(" is ignored")
            diver.confirm("stop")
            assert diver.wait_for("done", "NOT DONE") == "NOT DONE, no answer: hold"
        diver.close()
        assert second.commands == []
        assert not [line for line in list(diver.lines.queue) if line.startswith("two vehicles")]


@pytest.mark.withstands(row="H35")
def test_a_forged_acknowledgement_of_another_address_proves_nothing() -> None:
    with diving("udpin", QUICK) as diver, closing(Socket(sender_port(diver))) as forger:
        servo = mavlink.MAV_CMD_DO_SET_SERVO
        forger.send_always(lambda: [acknowledgement(servo)], 0.002)
        diver.vehicle.refused = frozenset({int(servo)})
        diver.confirm("bright")
        assert diver.wait_for("done", "refused", "NOT DONE").startswith("refused")


def sender_port(diver: Diver) -> int:
    """Return the port that a bridge sends from, once it has."""
    link: Any = diver.bridge._talk._link
    wait_until(lambda: bool(link._socket.getsockname()[1]))
    return int(link._socket.getsockname()[1])


def heard(vehicle: VehiclePeer, message: Any, sender: tuple[Any, ...], now: float) -> bool:
    message.pack(mavlink.MAVLink(None, 1, 1))
    return vehicle.admit(message, sender, now, busy=False)


def test_one_late_packet_is_no_second_vehicle() -> None:
    notices: list[str] = []
    found = VehiclePeer(Vehicle(), 0.0, notices.append, None)
    assert heard(found, beat(), ("h", 1), 0.0)
    for now, uptime in [(0.1, 60_000), (0.2, 57_000), (0.3, 60_200), (1.3, 61_200)]:
        heard(found, mavlink.MAVLink_system_time_message(0, uptime), ("h", 1), now)
    assert found.is_proven(2.0)
    assert notices == []


def test_the_peer_changes_when_it_is_silent_and_in_an_order_on_its_host_alone() -> None:
    found = VehiclePeer(Vehicle(), 0.0, print, None)
    heartbeat = beat()
    assert heard(found, heartbeat, ("boat", 1), 0.0)
    assert not heard(found, heartbeat, ("boat", 2), 1.0)
    assert found.dropped == 1
    later = SILENT_SECONDS + 1
    assert not found.admit(heartbeat, ("other", 1), later, busy=True)
    assert found.admit(heartbeat, ("boat", 2), later, busy=True)
    assert found.sender == ("boat", 2)
    assert found.admit(heartbeat, ("other", 1), 2 * later + 1, busy=False)
    assert found.sender == ("other", 1)


def test_a_vehicle_of_another_kind_is_not_commanded_when_its_heartbeats_are_rare() -> None:
    found = VehiclePeer(Vehicle(), 0.0, print, None)
    assert heard(found, beat(), ("h", 1), 0.0)
    heard(found, beat(kind=mavlink.MAV_TYPE_SURFACE_BOAT), ("h", 1), 1.0)
    assert not found.is_proven(1.0)
    assert not found.is_proven(2 + SILENT_SECONDS)
    assert heard(found, beat(), ("h", 1), 3 + SILENT_SECONDS)
    assert found.is_proven(3 + SILENT_SECONDS)


@pytest.mark.parametrize("known", [False, True], ids=["first", "after silence"])
def test_a_vehicle_of_another_kind_at_another_address_does_not_keep_orders_from_an_ardusub(
    known: bool,
) -> None:
    found = VehiclePeer(Vehicle(), 0.0, print, None)
    if known:
        heard(found, beat(), ("sub", 1), 0.0)
    began = 2 * SILENT_SECONDS
    heard(found, beat(kind=mavlink.MAV_TYPE_SURFACE_BOAT), ("boat", 1), began)
    assert found.find_fault(began) == ("" if known else peer.NO_ARDUSUB)
    assert heard(found, beat(), ("sub", 1), began + 1)
    assert not heard(found, beat(kind=mavlink.MAV_TYPE_SURFACE_BOAT), ("boat", 1), began + 2)
    assert found.sender == ("sub", 1)
    assert found.is_proven(began + 2)


@pytest.mark.usefixtures("closes_soon")
def test_a_new_connection_gets_no_command_before_a_heartbeat(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(links, "RECONNECT_SECONDS", 0.0)
    monkeypatch.setattr(talk, "HEARTBEAT_SECONDS", 0.05)
    codec = mavlink.MAVLink(None)

    def receive(connection: socket.socket) -> list[str]:
        return [each.get_type() for each in codec.parse_buffer(connection.recv(1000)) or []]

    with socket.create_server(("127.0.0.1", 0)) as server:
        address = f"tcp:127.0.0.1:{server.getsockname()[1]}"
        diver = Diver(None, address, VehicleTable.model_validate(TABLE))
        with closing(diver.bridge):
            with server.accept()[0] as first:
                first.sendall(packed(beat()))
                diver.show("help")
                while "COMMAND_LONG" not in receive(first):
                    pass
            with server.accept()[0] as second:
                before = [name for _ in range(5) for name in receive(second)]
                assert set(before) == {"HEARTBEAT"}
                second.sendall(packed(beat()))
                while "COMMAND_LONG" not in receive(second):
                    pass


def test_a_flood_leaves_time_to_send() -> None:
    link = DatagramLink("127.0.0.1", 0, 1, listens=True)
    port = link._socket.getsockname()[1]
    with closing(link), closing(Socket(port)) as flood:
        flood.send(*[b"x"] * 200)
        assert link.receive(1.0) == []
        assert 0 < link.dropped <= MOST_DATAGRAMS
        flood.send(b"\xfd\x00\x00" * 1000)
        for _ in range(200 // MOST_DATAGRAMS + 1):
            link.receive(0.1)
        assert link.dropped <= 200 + MOST_FAULTS
