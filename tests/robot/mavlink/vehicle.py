"""A vehicle like ArduSub, by pymavlink's connections: obeys, refuses, loses packets, restarts.

It obeys what ArduSub's source obeys and nothing else. Each rule names its commit, file and lines in
https://github.com/ArduPilot/ardupilot. Losses, hangs and restarts are no rules.
"""

from __future__ import annotations

import math
import os
import random
import threading
import time as clock
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

os.environ.setdefault("MAVLINK20", "1")  # read when mavutil is imported

from pymavlink import mavutil
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from app.robot.mavlink.actions import OUR_COMPONENT

SYSTEM, COMPONENT = 1, 1
BEAT_SECONDS = 0.01
STEP = 0.05
"""Seconds of a step of simulated time, like the bridge's own."""

DEPTH = 1.0
MODES: dict[int, str] = {
    **mavutil.mode_mapping_sub,
    mavlink.SUB_MODE_MOTORDETECT: "MOTOR_DETECT",
    mavlink.SUB_MODE_SURFTRAK: "SURFTRAK",
}
"""Modes that there are: 00d5b0f84fc2 ArduSub/mode.cpp 28-62; SURFTRAK since 4.5."""

NEEDS_POSITION = ("AUTO", "GUIDED", "CIRCLE", "POSHOLD")
"""Modes that need a position: de0002527a77 ArduSub/mode.h 260, 314, 355, 382. The others need none:
132, 155, 178, 201, 404, 427. Before pull request 29996 SURFACE did: 025df2550ac0, 468."""

FREE_OUTPUTS = (0, 1, 22, 23, 28, *range(51, 67))
"""Functions of outputs that a command may set: none, manual, and the 16 inputs passed through, by
13c39969d86c libraries/AP_ServoRelayEvents/AP_ServoRelayEvents.cpp 35-44; sprayer and gripper since
pull request 13481. `Lights1` (181) is none of them."""

X_OR_Y_OR_Z_IGNORED, Z_IGNORED = 0b111, 0b100
VELOCITY_IGNORED, ACCELERATION_IGNORED = 0b111000, 0b111000000
"""Bits of a target's mask: 92e0e66054d3 ArduSub/defines.h 189-192."""

LOWEST, HIGHEST = -90.0, 20.0
"""Limits of the camera's pitch in degrees, unless a parameter sets others: 058b1c50232a
libraries/AP_Mount/AP_Mount_Params.cpp 59, 68."""

REPORTED = (
    mavlink.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW,
    mavlink.MAVLINK_MSG_ID_GIMBAL_DEVICE_ATTITUDE_STATUS,
)
"""Messages that it reports on request, and simulates."""


@dataclass
class Ardusub:
    """Simulated vehicle.

    Attributes
    ----------
    kind
        Its connection: ``udpin`` or ``tcpin``, or ``udpout:PORT``.
    loss
        Share of messages that are lost, in each direction.
    refused
        Commands that it denies.
    obeyed
        What it did, in order: one entry for each change.
    asked
        Number of requests received.
    texts
        Texts that it was shown.
    version
        Of its ArduSub: major, minor, patch.
    has_position
        Whether it knows its position, as by a DVL.
    restarts_at_next
        Whether the next command makes it restart instead of being answered.
    vehicle_type, autopilot
        What its heartbeat says that it is.
    armed
        Whether it is armed.
    is_slow
        Whether it accepts modes, and stays in the old one until this is False.
    pilot
        Mode that a pilot sets again before every heartbeat; None: there is no pilot.
    hangs
        Whether it does nothing, and what it is sent waits.
    lights, brightest
        Pulse length of its lights at the start, and the largest that it reports, in microseconds:
        ArduSub has no limit (00757fb77fa3 libraries/SRV_Channel/SRV_Channel.cpp 132-138), an
        output board may have one.
    yaw
        Of its camera, in degrees from the bow.
    key
        Key of its signatures; None: it signs nothing.
    function
        What the lights' output does, as its parameter says; None: the question is not answered.
    servo
        Output of the lights.
    reports
        Messages that it was asked to report, by number: the lights' output, the gimbal's attitude.
    pictures
        Numbers in the requests for pictures, one for each picture.
    shown
        Every change of lights or tilt, with its time: what a diver sees.

    """

    kind: str = "udpin"
    loss: float = 0.0
    seed: int = 0
    refused: frozenset[int] = frozenset()
    obeyed: list[str] = field(default_factory=list)
    asked: int = 0
    texts: list[str] = field(default_factory=list)
    version: tuple[int, int, int] = (4, 7, 0)
    has_position: bool = False
    restarts_at_next: bool = False
    vehicle_type: int = mavlink.MAV_TYPE_SUBMARINE
    autopilot: int = mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA
    armed: bool = True
    is_slow: bool = False
    pilot: int | None = None
    hangs: bool = False
    lights: float = 1100.0
    brightest: float = math.inf
    yaw: float = 0.0
    key: bytes | None = None
    function: int | None = 0
    servo: int = 13
    reports: set[int] = field(default_factory=set)
    pictures: list[float] = field(default_factory=list)
    shown: list[tuple[float, str, float]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._chance = random.Random(self.seed)
        self._accepted: int | None = None
        self._boot()
        self._connect()

    def _connect(self) -> None:
        kind, _, port = self.kind.partition(":")
        self._connection: Any = mavutil.mavlink_connection(
            f"{kind}:127.0.0.1:{port or 0}", source_system=SYSTEM, source_component=COMPONENT
        )
        listening = self._connection.listen if kind == "tcpin" else self._connection.port
        self.port: int = listening.getsockname()[1]
        if self.key is not None:
            self._connection.setup_signing(self.key, sign_outgoing=True)
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Switch it off, after it has received all messages sent before."""
        self._closing.set()
        self._thread.join()
        self._connection.close()

    @property
    def uptime(self) -> float:
        """Seconds since its start."""
        return self._now() - self._began

    def _now(self) -> float:
        return clock.monotonic()

    def _boot(self) -> None:
        self.mode: int = mavlink.SUB_MODE_MANUAL
        self.target = -DEPTH
        self.pulse = self.lights
        self.pitch = 0.0
        self._began = self._now() - 10

    def _run(self) -> None:
        beat = 0.0
        while True:
            while self.hangs and not self._closing.is_set():
                clock.sleep(BEAT_SECONDS)
            message = self._connection.recv_msg()
            if message is None:
                if self._closing.is_set():
                    return
                self._connection.select(BEAT_SECONDS / 2)
            elif self._chance.random() >= self.loss:
                self._hear(message)
            if clock.monotonic() - beat > BEAT_SECONDS:
                beat = clock.monotonic()
                self._report()

    def _send(self, message: Any) -> None:
        if self._chance.random() >= self.loss:
            self._connection.mav.send(message)

    def _report(self) -> None:
        if self._accepted is not None and not self.is_slow:
            self._take_mode(self._accepted)
        if self.pilot is not None:
            self.mode = self.pilot
        flags = mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
        if self.armed:
            flags |= mavlink.MAV_MODE_FLAG_SAFETY_ARMED
        uptime = round(self.uptime * 1000)
        heartbeat = (self.vehicle_type, self.autopilot, flags)
        active = mavlink.MAV_STATE_ACTIVE
        self._send(mavlink.MAVLink_heartbeat_message(*heartbeat, self.mode, active, 3))
        self._send(mavlink.MAVLink_system_time_message(0, uptime))
        self._send(mavlink.MAVLink_vfr_hud_message(0, 0, 0, 0, -DEPTH, 0))
        # 04b429a5076f ArduSub/GCS_MAVLink_Sub.cpp 91: metres from the height up to the target.
        error = self.target + DEPTH
        self._send(mavlink.MAVLink_nav_controller_output_message(0, 0, 0, 0, 0, error, 0, 0))

        if mavlink.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW in self.reports:
            outputs = [*[1500] * 12, round(self.pulse), *[1500] * 3]
            self._send(mavlink.MAVLink_servo_output_raw_message(0, 0, *outputs))
        if mavlink.MAVLINK_MSG_ID_GIMBAL_DEVICE_ATTITUDE_STATUS in self.reports:
            # 00e292165190 libraries/AP_Mount/AP_Mount_Backend.cpp 468: w, x, y, z.
            pitch, yaw = math.radians(self.pitch) / 2, math.radians(self.yaw) / 2
            attitude = [
                math.cos(pitch) * math.cos(yaw),
                -math.sin(pitch) * math.sin(yaw),
                math.sin(pitch) * math.cos(yaw),
                math.cos(pitch) * math.sin(yaw),
            ]
            self._send(
                mavlink.MAVLink_gimbal_device_attitude_status_message(
                    0, 0, uptime, 0, attitude, 0, 0, 0, 0
                )
            )

    def turn_lights(self, pulse: float) -> None:
        """Set the lights, as a pilot does too."""
        pulse = min(pulse, self.brightest)
        if self.pulse != pulse:
            self.pulse = pulse
            self.shown.append((self._now(), "lights", pulse))

    def _hear(self, message: Any) -> None:
        match message.get_type():
            case "STATUSTEXT":
                self.texts.append(message.text)
            case "COMMAND_LONG":
                self.asked += 1
                self._hear_command(message)
            case "PARAM_REQUEST_READ" if self.function is not None:
                # 049a7b207c7c libraries/GCS_MAVLink/GCS_Param.cpp 354-366: an unknown name has no
                # answer, and an answer repeats the requested index.
                if message.param_id == f"SERVO{self.servo}_FUNCTION":
                    told = (self.function, mavlink.MAV_PARAM_TYPE_INT16, 900, 65535)
                    name = message.param_id.encode()
                    self._send(mavlink.MAVLink_param_value_message(name, *told))
            case "SET_POSITION_TARGET_GLOBAL_INT":
                self.asked += 1
                self._hear_target(message)
            case "AUTOPILOT_VERSION_REQUEST":
                # c332c6474657 libraries/GCS_MAVLink/GCS_config.h 31-36, and 92e0e66054d3
                # libraries/GCS_MAVLink/GCS_Common.cpp 2484-2487.
                major, minor, patch = self.version
                number = major << 24 | minor << 16 | patch << 8 | 255
                rest = ([0] * 8, [0] * 8, [0] * 8, 0, 0, 0)
                self._send(mavlink.MAVLink_autopilot_version_message(0, number, 0, 0, 0, *rest))

    def _hear_target(self, message: Any) -> None:
        """Take a depth in ALT_HOLD; in GUIDED swim to a place on Earth, or with a velocity.

        Sub-4.0 ArduSub/GCS_Mavlink.cpp 657-717: none of X, Y and Z may be ignored for a depth. From
        4.5 on, 04b429a5076f ArduSub/GCS_MAVLink_Sub.cpp 682-772, only Z counts; the newest drops a
        place with an absolute height too (764-767), which this vehicle takes like the others.
        """
        refusing = X_OR_Y_OR_Z_IGNORED if self.version < (4, 5, 0) else Z_IGNORED
        if self.mode == mavlink.SUB_MODE_ALT_HOLD:
            if not message.type_mask & refusing and self.target != message.alt:
                self.target = message.alt
                self.obeyed.append(f"depth {-message.alt:g}")
            return
        if self.mode != mavlink.SUB_MODE_GUIDED or not message.type_mask & ACCELERATION_IGNORED:
            return
        # 01874b1df9fe libraries/AP_Math/location.cpp 324-339.
        is_place = abs(message.lat_int) <= 90e7 and abs(message.lon_int) <= 180e7
        if not message.type_mask & X_OR_Y_OR_Z_IGNORED and is_place:
            self.obeyed.append(f"swims to {message.lat_int}, {message.lon_int}")
        elif message.type_mask & X_OR_Y_OR_Z_IGNORED and not message.type_mask & VELOCITY_IGNORED:
            self.obeyed.append("swims with a velocity")

    def _hear_command(self, message: Any) -> None:
        if self.restarts_at_next:
            self.restarts_at_next = False
            self._boot()
            self._began = self._now()
            return
        if message.command in self.refused:
            result = mavlink.MAV_RESULT_DENIED
        else:
            result = self._obey(message)
        # Somebody else has asked for the same and is refused; and the asker is answered.
        denied = mavlink.MAV_RESULT_DENIED
        self._send(mavlink.MAVLink_command_ack_message(message.command, denied, 0, 0, 255, 190))
        asker = (message.get_srcSystem(), message.get_srcComponent())
        self._send(mavlink.MAVLink_command_ack_message(message.command, result, 0, 0, *asker))

    def _set_mode(self, message: Any) -> int:
        # 92e0e66054d3 libraries/GCS_MAVLink/GCS_Common.cpp 2380-2412: custom modes alone.
        if not int(message.param1) & mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED:
            return int(mavlink.MAV_RESULT_DENIED)
        # 00d5b0f84fc2 ArduSub/mode.cpp 82-93.
        name = MODES.get(int(message.param2))
        needs = needs_position(name, self.version)
        is_missing = name is None or (name == "SURFTRAK" and self.version < (4, 5, 0))
        if is_missing or (needs and not self.has_position):
            # In 4.0: 000f342b5f12 libraries/GCS_MAVLink/GCS_Common.cpp 1363-1386.
            old, new = mavlink.MAV_RESULT_UNSUPPORTED, mavlink.MAV_RESULT_FAILED
            return int(old if self.version < (4, 1, 0) else new)
        self._accepted = int(message.param2)
        if not self.is_slow:
            self._take_mode(self._accepted)
        return int(mavlink.MAV_RESULT_ACCEPTED)

    def _obey(self, message: Any) -> int:
        done = ""
        if message.command == mavlink.MAV_CMD_DO_SET_MODE:
            return self._set_mode(message)
        if message.command == mavlink.MAV_CMD_DO_SET_SERVO:
            # 0a9d1f1fb365 libraries/GCS_MAVLink/GCS_ServoRelay.cpp 12-19.
            if message.param1 != self.servo or self.function not in (None, *FREE_OUTPUTS):
                return int(mavlink.MAV_RESULT_FAILED)
            done = f"servo {message.param1:g} {message.param2:g}"
            done = "" if self.pulse == message.param2 else done
            self.turn_lights(message.param2)
        elif message.command == mavlink.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW:
            return self._point(message)
        elif message.command == mavlink.MAV_CMD_SET_MESSAGE_INTERVAL:
            # 92e0e66054d3 libraries/GCS_MAVLink/GCS_Common.cpp 2665-2702.
            if message.param1 not in REPORTED:
                return int(mavlink.MAV_RESULT_DENIED)
            self.reports.add(int(message.param1))
        elif message.command == mavlink.MAV_CMD_IMAGE_START_CAPTURE:
            # 2f0cf65f4117 libraries/AP_Camera/AP_Camera.cpp 334-351: a picture for each request,
            # whatever its number.
            if message.param1 < 0 or message.param3 != 1:
                return int(mavlink.MAV_RESULT_UNSUPPORTED)
            done = "picture"
            self.pictures.append(message.param4)
        else:
            # 000f342b5f12 libraries/GCS_MAVLink/GCS_Common.cpp 2493-2495.
            return int(mavlink.MAV_RESULT_UNSUPPORTED)
        if done:
            self.obeyed.append(done)
        return int(mavlink.MAV_RESULT_ACCEPTED)

    def _point(self, message: Any) -> int:
        """Point the camera, whose pitch has limits; rates and locks are not simulated.

        00e292165190 libraries/AP_Mount/AP_Mount.cpp 399-423, AP_Mount_Backend.cpp 200: pitch and
        yaw, neither without the other.
        """
        if math.isnan(message.param1) or math.isnan(message.param2):
            return int(mavlink.MAV_RESULT_FAILED)
        pitch = min(max(message.param1, LOWEST), HIGHEST)
        if self.pitch != pitch:
            self.pitch = pitch
            self.shown.append((self._now(), "tilt", pitch))
        self.yaw = message.param2
        return int(mavlink.MAV_RESULT_ACCEPTED)

    def _take_mode(self, mode: int) -> None:
        """Take a mode that was accepted."""
        self._accepted = None
        if self.mode != mode:
            self.mode = mode
            self.obeyed.append(MODES[mode])


ORDER = ("COMMAND_LONG", mavlink.MAV_CMD_DO_SET_MODE)


class SimulatedVehicle(Ardusub):
    """A vehicle without sockets, in simulated time, and the link to it, which can be lost.

    Time passes in `wait` alone. When it returns, the bridge has done all that it does until then.

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
        self._steps = 0
        self._sent: list[Any] = []
        self._waiting: list[Any] = []
        self._ours = mavlink.MAVLink(None, SYSTEM, OUR_COMPONENT)
        self._own = mavlink.MAVLink(None, SYSTEM, COMPONENT)
        self._go, self._done = threading.Semaphore(0), threading.Semaphore(0)
        self._is_over = False

    def _now(self) -> float:
        return self.now

    def _send(self, message: Any) -> None:
        if self._chance.random() >= self.loss:
            self._sent += self._own.parse_buffer(message.pack(self._own))

    def wait(self, seconds: float, step: float = STEP) -> None:
        """Let time pass, step by step with the bridge's thread."""
        for _ in range(math.ceil(round(seconds / step, 6))):
            self._done.acquire()
            if not self._is_over:
                self._pass(step)
                self._go.release()
                self._done.acquire()
            self._done.release()

    def _pass(self, step: float) -> None:
        self.now += step
        self._steps += 1
        self._hear_waiting()
        if self.linked and not self.hangs and self._steps % 2 == 0:
            self._report()

    def _hear_waiting(self) -> None:
        while self._waiting and not self.hangs:
            message = self._waiting.pop(0)
            if self._chance.random() >= self.loss:
                self._hear(message)

    def receive(self, seconds: float) -> list[tuple[Any, tuple[Any, ...]]]:
        """Return what has arrived, for the bridge."""
        self._done.release()
        self._go.acquire()
        found, self._sent = self._sent, []
        return [(message, ()) for message in found]

    def send(self, message: Any, to: Any) -> None:
        """Bring the vehicle what the bridge sends."""
        if self.linked:
            self._waiting += self._ours.parse_buffer(message.pack(self._ours))
        elif (message.get_type(), getattr(message, "command", None)) == ORDER or (
            getattr(message, "param2", None) == 1500
        ):
            self.unheard.append(message)

    def close(self) -> None:
        """End of the link: the bridge's thread is over, and what it sent arrives."""
        self._hear_waiting()
        self._is_over = True
        self._done.release()


def needs_position(mode: str | None, version: tuple[int, int, int]) -> bool:
    """Return whether a version takes a mode only with a position."""
    older = (4, 5, 0) <= version < (4, 7, 0)
    return mode in NEEDS_POSITION or (mode == "SURFACE" and older)


@contextmanager
def sailing(**settings: Any) -> Iterator[Ardusub]:
    """Switch a vehicle on, and off at the end."""
    vehicle = Ardusub(**settings)
    try:
        yield vehicle
    finally:
        vehicle.close()
