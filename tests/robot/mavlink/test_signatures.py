"""Signatures: only who has the key is heard, and no restart makes the vehicle deaf to the robot."""

from __future__ import annotations

import json
import socket
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("pymavlink", reason="needs the extra mavlink")

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from app.cli.robots.robot_options import RobotOptions
from app.cli.robots.run import open_bridge
from app.recognition.errors import VehicleError
from app.robot import TriggerListener
from app.robot.mavlink import bridge, links, talk
from app.robot.mavlink.links import Reader, SigningTime, open_link
from app.robot.mavlink.table import VehicleTable
from tests.ports import free_port
from tests.robot.languages import spoken
from tests.robot.mavlink.diver import TABLE, Diver, talking, wait_until
from tests.robot.mavlink.test_peer import QUICK, Socket, beat, packed
from tests.robot.mavlink.vehicle import sailing

KEY = bytes(range(32))


def test_a_signed_vehicle_is_obeyed_and_an_unsigned_one_is_not_heard(tmp_path: Any) -> None:
    signed = VehicleTable.model_validate({**TABLE, **QUICK})
    for key, answer in [(KEY, "done: hold"), (None, "NOT DONE"), (bytes(32), "NOT DONE")]:
        with sailing(key=key) as vehicle:
            link = open_link(f"udpout:127.0.0.1:{vehicle.port}", 1, 1, KEY)
            diver = Diver(vehicle, "", signed, link)
            with closing(diver.bridge):
                diver.confirm("stop")
                assert diver.wait_for("done", "NOT DONE").startswith(answer)
            assert vehicle.obeyed == (["ALT_HOLD"] if key == KEY else [])
            assert (link.dropped > 0) == (key != KEY)


@pytest.mark.parametrize("seconds", [3600, -3600])
def test_a_clock_that_is_set_an_hour_during_the_dive_changes_nothing(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, seconds: float
) -> None:
    """The system's clock of robot and vehicle steps between an order, and during an emergency."""
    table, real = VehicleTable.model_validate(TABLE), time.time
    with sailing(key=KEY) as vehicle:
        address = f"udpout:127.0.0.1:{vehicle.port}"
        diver = Diver(vehicle, "", table, open_link(address, 1, 1, KEY, tmp_path / "time"))
        with closing(diver.bridge):
            diver.confirm("stop")
            assert diver.wait_for("done", "NOT DONE") == "done: hold"
            vehicle.is_slow = True
            diver.show("help")
            wait_until(lambda: vehicle.asked > 1)
            monkeypatch.setattr(time, "time", lambda: real() + seconds)
            time.sleep(0.2)
            vehicle.is_slow = False
            assert diver.wait_for("done", "NOT DONE") == "done: surface"
            diver.confirm("free")
            assert diver.wait_for("done", "NOT DONE") == "done: mode STABILIZE"
            assert not [line for line in list(diver.lines.queue) if "silent" in line]
    assert vehicle.obeyed == ["ALT_HOLD", "SURFACE", "STABILIZE"]


@pytest.mark.parametrize("seconds", [3600, 40 * 86400])
def test_a_vehicle_hears_a_signed_robot_that_starts_again_with_an_earlier_clock(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, seconds: float
) -> None:
    """The vehicle is pymavlink's check of signatures, which rejects what goes back in time."""
    monkeypatch.setattr(talk, "HEARTBEAT_SECONDS", 0.02)
    file = tmp_path / "vehicle.json"
    changes = {"vehicle": {"key_file": "key"}, "cancel": [], "emergency": {}}
    gestures = {"circle": {"do": "hold"}}
    file.write_text(json.dumps({**TABLE, **changes, "gestures": gestures}))
    (tmp_path / "key").write_bytes(KEY)
    reader, real, accepted = Reader(SigningTime(KEY, None).signing), time.time, []
    with closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as vehicle:
        vehicle.bind(("127.0.0.1", 0))
        vehicle.settimeout(20)
        address = f"udpout:127.0.0.1:{vehicle.getsockname()[1]}"
        for starts in range(3):
            monkeypatch.setattr(time, "time", lambda starts=starts: real() - starts * seconds)
            listener = TriggerListener(spoken("circle"))
            options = RobotOptions(file, mavlink=address)
            robot = open_bridge(options, file, listener, None, print, lambda *said: None)
            with talking(robot):
                accepted.append(len(reader.read(vehicle.recv(1000))[0]))
    assert accepted == [1, 1, 1]


def test_the_kept_time_of_signatures_is_ahead_of_all_that_was_sent(tmp_path: Path) -> None:
    file = tmp_path / "key.time"
    signing_time = links.SigningTime(KEY, file)
    for passed in (0, 59, 61, 600):
        signing_time._began = time.monotonic() - passed
        signing_time.go_on()
        assert int(file.read_bytes()) > signing_time.signing.timestamp
    signing_time.signing.timestamp += 10**12
    signing_time.go_on()
    assert int(file.read_bytes()) > signing_time.signing.timestamp
    assert links.SigningTime(KEY, file).signing.timestamp >= int(file.read_bytes())


@pytest.mark.parametrize("content", [b"", b"later", b"-1", b"9" * 20])
def test_a_file_that_holds_no_time_of_signatures_is_named(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "key.time").write_bytes(content)
    with pytest.raises(VehicleError, match=r"key\.time holds no signature time"):
        open_link("udpout:127.0.0.1:9", 1, 1, KEY, tmp_path / "key.time")
    with pytest.raises(VehicleError, match="cannot be written"):
        open_link("udpout:127.0.0.1:9", 1, 1, KEY, tmp_path / "no folder" / "key.time")


def test_a_vehicle_that_waits_for_its_first_message_is_heard_after_a_restart(
    tmp_path: Path,
) -> None:
    """The robot's time is ahead of the vehicle's, which nobody has told."""
    for _ in range(2):
        port = free_port()
        link = open_link(f"udpin:127.0.0.1:{port}", 1, 1, KEY, tmp_path / "key.time")
        diver = Diver(None, "", VehicleTable.model_validate(TABLE), link)
        with closing(diver.bridge), sailing(kind=f"udpout:{port}", key=KEY) as vehicle:
            diver.confirm("stop")
            assert diver.wait_for("done", "NOT DONE") == "done: hold"
        assert vehicle.obeyed == ["ALT_HOLD"]


@pytest.mark.usefixtures("closes_soon")
def test_a_vehicle_that_rejects_our_signature_is_named() -> None:
    """The vehicle is heard, signed as it should be, and answers a ground station alone."""
    accepted = mavlink.MAVLink_command_ack_message(mavlink.MAV_CMD_DO_SET_MODE, 0, 0, 0, 255, 190)
    signed = VehicleTable.model_validate(
        {**TABLE, "vehicle": {**QUICK["vehicle"], "key_file": "key"}}
    )
    with listening_diver_of(KEY, signed) as (diver, port), closing(Socket(port)) as vehicle:
        signing = SigningTime(KEY, None).signing
        vehicle.send_always(
            lambda: [packed(each, signing=signing) for each in (beat(), accepted)], 0.02
        )
        diver.confirm("stop")
        assert diver.wait_for("NOT DONE").startswith("NOT DONE, no answer: hold; ")
        assert diver.wait_for("the vehicle rejects our signature") == bridge.SIGNATURE_REJECTED
        wait_until(lambda: bridge.SIGNATURE_REJECTED in vehicle.texts)


def test_a_forged_signature_from_the_future_does_not_deafen_the_bridge() -> None:
    signing = mavlink.MAVLinkSigning()
    signing.secret_key, signing.sign_outgoing = bytes(32), True
    signing.timestamp = 2**47
    with (
        listening_diver_of(KEY) as (diver, port),
        closing(Socket(port)) as forger,
        sailing(kind=f"udpout:{port}", key=KEY) as vehicle,
    ):
        forger.send_always(lambda: [packed(beat(), signing=signing)], 0.005)
        diver.confirm("stop")
        assert diver.wait_for("done", "NOT DONE") == "done: hold"
    assert vehicle.obeyed == ["ALT_HOLD"]


def test_a_signed_message_counts_once_also_beside_a_forged_one() -> None:
    def signing(key: bytes) -> Any:
        made = SigningTime(key, None).signing
        made.link_id = 7
        return made

    ours = SigningTime(KEY, None).signing
    once = packed(beat(), signing=signing(KEY))
    forged = packed(beat(), signing=signing(bytes(32)))
    counts = [len(Reader(ours).read(data)[0]) for data in (once + forged, once + forged, once)]
    assert counts == [1, 0, 0]


@contextmanager
def listening_diver_of(
    key: bytes, table: VehicleTable | None = None
) -> Iterator[tuple[Diver, int]]:
    port = free_port()
    table = table or VehicleTable.model_validate(TABLE)
    link = open_link(f"udpin:127.0.0.1:{port}", 1, 1, key)
    diver = Diver(None, "", table, link)
    with closing(diver.bridge):
        yield diver, port
