"""mavlink2rest: the same messages as JSON, and the vehicle obeys over HTTP."""

from __future__ import annotations

import json
import threading
from contextlib import closing
from http.server import BaseHTTPRequestHandler, HTTPServer, ThreadingHTTPServer
from typing import Any

import pytest

pytest.importorskip("pymavlink", reason="needs the extra mavlink")

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from app.recognition.errors import VehicleError
from app.robot.mavlink import rest_link
from app.robot.mavlink.actions import DepthStep, VehicleFacts, build_steps
from app.robot.mavlink.lights_and_tilt import LightsOutput, TiltOutput
from app.robot.mavlink.links import open_link
from app.robot.mavlink.rest_link import from_json, to_json
from app.robot.mavlink.table import Camera, Lights, Surface, Vehicle, VehicleTable
from app.robot.mavlink.talk import build_heartbeat
from tests.robot.mavlink.diver import DOES, DONE, TABLE, Diver, wait_until
from tests.robot.mavlink.mavlink2rest import as_json, as_message, serving
from tests.robot.mavlink.vehicle import sailing

SENT = [
    build_heartbeat(),
    *(step.build(2) for step in build_steps(Surface(), Vehicle(), 1)),
    DepthStep(5, 1, 1).build(0),
    mavlink.MAVLink_statustext_message(mavlink.MAV_SEVERITY_INFO, b"hold"),
    LightsOutput(Vehicle(), VehicleFacts(Vehicle())).build(1660),
    TiltOutput(Vehicle()).build(-12.0),
    *(
        step.build(0)
        for action in (Lights(do="lights", percent=10), Camera(do="camera"))
        for step in build_steps(action, Vehicle(), 1)
    ),
]
HEARD = [
    mavlink.MAVLink_command_ack_message(mavlink.MAV_CMD_DO_SET_MODE, mavlink.MAV_RESULT_DENIED),
    mavlink.MAVLink_vfr_hud_message(0, 0, 10, 0, -3.5, 0),
    mavlink.MAVLink_servo_output_raw_message(0, 0, *[1500] * 12, 1660, 0, 0, 0),
    mavlink.MAVLink_gimbal_device_attitude_status_message(
        0, 0, 5, 0, [0.5, 0.0, 0.5, 0.0], 0, 0, 0, 0
    ),
]


@pytest.mark.parametrize("message", SENT, ids=lambda message: message.get_type())
def test_what_is_posted_is_the_message(message: mavlink.MAVLink_message) -> None:
    posted, codec = as_message(to_json(message)), mavlink.MAVLink(None)
    assert posted.pack(codec) == message.pack(codec)


def test_a_text_is_one_character_a_byte() -> None:
    text = mavlink.MAVLink_statustext_message(mavlink.MAV_SEVERITY_INFO, "né".encode())
    assert to_json(text)["text"] == [*"n??", *("\0",) * 47]


@pytest.mark.parametrize("message", HEARD, ids=lambda message: message.get_type())
def test_what_is_fetched_is_the_message(message: mavlink.MAVLink_message) -> None:
    assert from_json(as_json(message)).to_dict() == message.to_dict()


def test_a_vehicle_obeys_over_http(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rest_link, "POLL_SECONDS", 0.005)
    table = VehicleTable.model_validate(TABLE)
    with sailing(loss=0.2, seed=2) as vehicle, serving(vehicle.port) as address:
        diver = Diver(vehicle, address, table)
        with closing(diver.bridge):
            for label in DONE:
                vehicle.obeyed.clear()
                diver.confirm(label)
                assert diver.wait_for("done", "refused", "NOT DONE").startswith("done")
                assert DOES[label](vehicle)
    assert [text for text in vehicle.texts if text.startswith("confirmed: ")]


@pytest.mark.parametrize("show", ["lights", "tilt"])
def test_a_vehicle_answers_the_diver_over_http(monkeypatch: pytest.MonkeyPatch, show: str) -> None:
    monkeypatch.setattr(rest_link, "POLL_SECONDS", 0.005)
    table = VehicleTable.model_validate({**TABLE, "answers": {"show": [show]}})
    with sailing() as vehicle, serving(vehicle.port) as address:
        diver = Diver(vehicle, address, table)
        with closing(diver.bridge):
            diver.show("stop")
            wait_until(lambda: len(vehicle.shown) == 4)
            wait_until(lambda: diver.bridge.has_replied)
    before, peak = (1100, 1660) if show == "lights" else (0, -12)
    assert [value for _, _, value in vehicle.shown] == [peak, before] * 2


def test_the_robot_goes_on_when_the_server_falls_silent_and_says_so() -> None:
    with sailing() as vehicle:
        with serving(vehicle.port) as address:
            diver = Diver(vehicle, address, VehicleTable.model_validate(TABLE))
        with closing(diver.bridge):
            assert diver.wait_for("no connection to the vehicle")
            diver.show("stop")
            assert diver.wait_for("repeat 'stop'")
    assert diver.lines.empty()


class Mavlink2rest:
    """A server whose answers the test chooses: those to GET by the message's name."""

    def __init__(self) -> None:
        self.answers: dict[str, str] = {}
        self.posted: list[dict[str, Any]] = []
        self.fails = False
        ours = self

        class Handler(BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                found = ours.answers.get(self.path.rpartition("/")[2])
                self.send_response(500 if ours.fails else 404 if found is None else 200)
                self.end_headers()
                self.wfile.write((found or "").encode())

            def do_POST(self) -> None:
                body = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
                ours.posted.append(body["message"])
                self.send_response(200)
                self.end_headers()

            def log_message(self, format: str, *args: object) -> None:
                """Print nothing."""

        self.server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.thread = threading.Thread(target=self.server.serve_forever, args=(0.01,))
        self.thread.start()
        self.address = f"http://127.0.0.1:{self.server.server_port}"

    def say(self, message: Any, counter: int, **changes: Any) -> None:
        content = {**as_json(message), **changes}
        answer = {"message": content, "status": {"time": {"counter": counter}}}
        self.answers[message.get_type()] = json.dumps(answer)

    def count_commands(self) -> int:
        return sum(each["type"] == "COMMAND_LONG" for each in self.posted)

    def close(self) -> None:
        self.server.shutdown()
        self.thread.join()
        self.server.server_close()


HEARTBEAT = mavlink.MAVLink_heartbeat_message(
    mavlink.MAV_TYPE_SUBMARINE, mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA, 129, 0, 4, 3
)


@pytest.mark.usefixtures("closes_soon")
@pytest.mark.parametrize(
    "changes",
    [
        {"alt": None, "airspeed": None},
        {"heading": -100_000},
        {"heading": "north"},
        {"alt": [1]},
        {"type": 5},
    ],
    ids=str,
)
def test_a_message_with_bad_values_does_not_end_the_robot_or_keep_an_emergency_back(
    changes: dict[str, Any],
) -> None:
    with closing(Mavlink2rest()) as server:
        hud = mavlink.MAVLink_vfr_hud_message(0, 0, 0, 0, 0, 0)
        server.say(hud, 1, **changes)
        diver = Diver(None, server.address, VehicleTable.model_validate(TABLE))
        with closing(diver.bridge):
            server.say(HEARTBEAT, 1)
            wait_until(lambda: diver.bridge._talk.peer.sender is not None)
            server.say(hud, 2, **changes)
            diver.show("help")
            wait_until(lambda: server.count_commands() > 1)
            diver.show("other")


@pytest.mark.usefixtures("closes_soon")
def test_an_emergency_is_sent_though_nothing_can_be_fetched_any_more() -> None:
    with closing(Mavlink2rest()) as server:
        diver = Diver(None, server.address, VehicleTable.model_validate(TABLE))
        with closing(diver.bridge):
            server.say(HEARTBEAT, 1)
            wait_until(lambda: diver.bridge._talk.peer.sender is not None)
            server.fails = True
            assert diver.wait_for("no connection to the vehicle")
            diver.show("help")
            wait_until(lambda: server.count_commands() > 1)
    assert not [line for line in list(diver.lines.queue) if line.startswith("no connection")]


def test_a_server_of_another_kind_is_refused() -> None:
    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(200)
            self.end_headers()
            self.wfile.write(b"<html>")

        def log_message(self, format: str, *args: object) -> None:
            """Print nothing."""

    with HTTPServer(("127.0.0.1", 0), Handler) as server:
        threading.Thread(target=server.handle_request).start()
        with pytest.raises(VehicleError, match="not answered as mavlink2rest does"):
            open_link(f"http://127.0.0.1:{server.server_port}", 1, 1)
