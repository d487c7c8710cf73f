"""Vehicle actions as MAVLink: the messages that request each, and the proof that it is done.

The actions are listed in `table`. A mode counts as set when it is acknowledged, also as in
progress, and the heartbeat shows it: an acknowledgement alone could belong to an earlier command, a
heartbeat alone could date from before a restart. The mode is never asked for: each heartbeat tells
it. ArduSub does not acknowledge a depth, which counts as set when the reported target is that
depth. Lights and camera are only acknowledged.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, Final

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from app.robot.mavlink import table
from app.robot.mavlink.table import Action, SlotName, Vehicle

Message = Any
"""A message of pymavlink, which has no types."""

OUR_COMPONENT: Final = mavlink.MAV_COMP_ID_ONBOARD_COMPUTER
"""MAVLink component id of this computer, which is a part of the vehicle's system."""

GO_ON: Final = (
    mavlink.MAV_RESULT_ACCEPTED,
    mavlink.MAV_RESULT_IN_PROGRESS,
    mavlink.MAV_RESULT_TEMPORARILY_REJECTED,
)
"""Results after which a command is repeated until it is done; all others refuse it."""

LEAST_PWM, MOST_PWM = 1100, 1900
"""Pulse lengths in microseconds at which the lights are off, and brightest."""

MOTORS: Final = (range(33, 41), range(70, 71), range(73, 75), range(81, 86), range(160, 180))
"""Functions of outputs that drive motors: motors 1 to 8, throttles, boost and motors 9 to 12,
13 to 32 (ArduPilot, `SRV_Channel.h`)."""

TARGET_TOLERANCE: Final = 0.3
"""Largest difference in metres between the requested depth and the target that the vehicle reports.
The target is computed from the measured depth, which pressure and waves change by about as much."""

IGNORE_ALL_BUT_DEPTH: Final = 0b1101_1111_1011
"""All bits of ``POSITION_TARGET_TYPEMASK`` but ``Z_IGNORE`` (4) and ``FORCE_SET`` (512)."""

IGNORE_ALL_BUT_POSITION: Final = 0b1101_1111_1000
"""The same without ``X_IGNORE`` and ``Y_IGNORE``, which ArduSub before 4.5 takes for no depth."""

VERSION_4_5, VERSION_4_7 = 4 << 24 | 5 << 16, 4 << 24 | 7 << 16
"""Versions 4.5.0 and 4.7.0 as ``AUTOPILOT_VERSION`` gives them."""

NEEDS_POSITION: Final = ("AUTO", "GUIDED", "CIRCLE", "POSHOLD")
"""Modes that ArduSub takes only with a position; from 4.5 to 4.6 ``SURFACE`` too."""

NOWHERE: Final = 2**31 - 1
"""A latitude and longitude that there is not: beside ``ALT_HOLD`` ArduSub drops such a target."""


@dataclass
class Reported:
    """Last reported state of the vehicle.

    Attributes
    ----------
    acknowledged
        Whether the vehicle accepted a command, or has only begun it, by the component that
        acknowledged it and the command's number. A refusal takes it back.
    mode
        Number of the vehicle's mode.
    altitude
        Metres, negative below the surface.
    altitude_error
        Metres from its altitude up to its target.

    """

    acknowledged: dict[tuple[int, int], bool] = field(default_factory=dict)
    mode: int | None = None
    altitude: float | None = None
    altitude_error: float | None = None

    def hear(self, message: Message) -> None:
        """Update the state from a message of the vehicle."""
        match message.get_type():
            case "COMMAND_ACK":
                command = (message.get_srcComponent(), message.command)
                if message.result == mavlink.MAV_RESULT_ACCEPTED:
                    self.acknowledged[command] = True
                elif message.result == mavlink.MAV_RESULT_IN_PROGRESS:
                    self.acknowledged.setdefault(command, False)
                elif message.result not in GO_ON:
                    self.acknowledged.pop(command, None)
            case "HEARTBEAT":
                self.mode = message.custom_mode
            case "VFR_HUD":
                self.altitude = message.alt
            case "NAV_CONTROLLER_OUTPUT":
                self.altitude_error = message.alt_error


class VehicleFacts:
    """What the vehicle is asked about itself, until it answers.

    Attributes
    ----------
    function
        Number of the function of its output for the lights, ``SERVOn_FUNCTION``: that of a motor
        must never be set. None: not known.
    version
        Of its ArduSub, as ``AUTOPILOT_VERSION`` gives it; 0: not known.

    """

    def __init__(self, vehicle: Vehicle) -> None:
        self._vehicle = vehicle
        self._name = f"SERVO{vehicle.lights_servo}_FUNCTION"
        self.function: int | None = None
        self.version = 0
        self._asked = -math.inf

    @property
    def obstacle(self) -> str:
        """Why the lights must not be set, in few words; empty if they may."""
        if self.function is None:
            return f"function of output {self._vehicle.lights_servo} unknown"
        is_motor = any(self.function in motors for motors in MOTORS)
        return f"output {self._vehicle.lights_servo} drives a motor" if is_motor else ""

    def hear(self, message: Message) -> None:
        """Note the vehicle's answer to a question."""
        match message.get_type():
            case "AUTOPILOT_VERSION":
                self.version = message.flight_sw_version
            case "PARAM_VALUE" if message.param_id == self._name:
                if math.isfinite(message.param_value):
                    self.function = round(message.param_value)

    def list_due(self, now: float) -> Iterator[Message]:
        """Yield the questions that are not answered, each again in the time of a repetition."""
        if now - self._asked < self._vehicle.repeat_seconds:
            return
        self._asked = now
        address = (self._vehicle.system, self._vehicle.component)
        if self.function is None:
            yield mavlink.MAVLink_param_request_read_message(*address, self._name.encode(), -1)
        if not self.version:
            yield mavlink.MAVLink_autopilot_version_request_message(*address)


@dataclass(frozen=True)
class CommandStep:
    """A command with at most seven parameters, which the vehicle acknowledges.

    That of a mode is repeated until the vehicle acknowledges and shows it.

    Attributes
    ----------
    command
        Number of the command.
    parameters
        Its parameters; those left out are 0.
    system, component
        Who should obey.
    mode
        Number of the mode that it sets; None: it sets none.

    """

    command: int
    parameters: tuple[float, ...]
    system: int
    component: int
    mode: int | None = None

    @property
    def moves(self) -> bool:
        """Whether it moves the vehicle, as every mode may."""
        return self.mode is not None

    def build(self, repetition: int) -> Message:
        """Build the message."""
        padded = (*self.parameters, *(0.0,) * (7 - len(self.parameters)))
        return mavlink.MAVLink_command_long_message(
            self.system, self.component, self.command, min(repetition, 255), *padded
        )

    def is_done(self, reported: Reported) -> bool:
        """Return whether the vehicle accepted it, or acknowledged it and is in the mode."""
        is_accepted = reported.acknowledged.get((self.component, self.command))
        if self.mode is None:
            return is_accepted or False
        return is_accepted is not None and reported.mode == self.mode


@dataclass(frozen=True)
class DepthStep:
    """A target depth in metres, repeated until the vehicle's target is that depth."""

    metres: float
    system: int
    component: int

    command = None
    mode = None
    moves = True

    def build(self, version: int) -> Message:
        """Build the message for a version of ArduSub; 0: not known, as the newest takes it."""
        is_old = 0 < version < VERSION_4_5
        return mavlink.MAVLink_set_position_target_global_int_message(
            0,
            self.system,
            self.component,
            mavlink.MAV_FRAME_GLOBAL_INT,
            IGNORE_ALL_BUT_POSITION if is_old else IGNORE_ALL_BUT_DEPTH,
            NOWHERE,
            NOWHERE,
            -self.metres,
            *(0.0,) * 8,
        )

    def is_done(self, reported: Reported) -> bool:
        """Return whether the vehicle's target is the depth."""
        if reported.altitude is None or reported.altitude_error is None:
            return False
        target = reported.altitude + reported.altitude_error
        return abs(target + self.metres) <= TARGET_TOLERANCE


Step = CommandStep | DepthStep
"""A request: the `command` whose acknowledgement answers it, the `mode` that it sets, whether it
`moves` the vehicle."""


def name_entry(enum: str, number: int) -> str:
    """Return the name of a number in one of MAVLink's enumerations; empty for no name."""
    known = mavlink.enums[enum]
    return str(known[number].name.removeprefix(f"{enum}_")) if number in known else ""


def describe_refusal(mode: str, version: int) -> str:
    """Describe when a version of ArduSub refuses a mode; empty if it takes it always."""
    named = f"ArduSub {version >> 24}.{version >> 16 & 255}"
    if mode == "SURFTRAK" and version < VERSION_4_5:
        return f"{named} has no {mode}"
    needs = mode in NEEDS_POSITION or (mode == "SURFACE" and VERSION_4_5 <= version < VERSION_4_7)
    return f"{named} takes {mode} only with a position" if needs else ""


def describe_sent(action: Action, vehicle: Vehicle) -> str:
    """Describe the messages that request an action, such as ``DO_SET_MODE SURFACE``."""
    if isinstance(action, table.Depth) and isinstance(action.metres, SlotName):
        slot, deepest = action.metres.slot, vehicle.deepest
        shown = describe_sent(table.Depth(do="depth", metres=deepest), vehicle)
        return shown.replace(f"{deepest:g} m", f"{slot} m, at most {deepest:g}")
    return ", then ".join(describe_step(step) for step in build_steps(action, vehicle, 1))


def describe_step(step: Step) -> str:
    """Describe the message of a step, such as ``DO_SET_MODE SURFACE``."""
    match step:
        case CommandStep(mode=int(mode)):
            return f"DO_SET_MODE {name_entry('SUB_MODE', mode)}"
        case DepthStep(metres=metres):
            return f"SET_POSITION_TARGET_GLOBAL_INT depth {metres:g} m"
        case CommandStep(command=command, parameters=parameters):
            shown = ", ".join(f"{each:g}" for each in parameters)
            return f"{name_entry('MAV_CMD', command)} {shown}"


def build_steps(action: Action, vehicle: Vehicle, picture: int) -> tuple[Step, ...]:
    """Build the steps of an action, in order.

    Parameters
    ----------
    action
        The action, without an open slot.
    vehicle
        Who should obey.
    picture
        Number of the next picture: a camera takes no second one for a repeated request, but
        ArduPilot's own driver takes one for each.

    """
    address = (vehicle.system, vehicle.component)
    match action:
        case table.Hold() | table.Surface() | table.Mode():
            mode = getattr(mavlink, f"SUB_MODE_{action.mode}")
            chosen = (mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED, mode)
            return (CommandStep(mavlink.MAV_CMD_DO_SET_MODE, chosen, *address, mode),)
        case table.Lights(percent=percent):
            pulse = round(LEAST_PWM + (MOST_PWM - LEAST_PWM) * percent / 100)
            command = mavlink.MAV_CMD_DO_SET_SERVO
            return (CommandStep(command, (vehicle.lights_servo, pulse), *address),)
        case table.Camera():
            command = mavlink.MAV_CMD_IMAGE_START_CAPTURE
            camera = (vehicle.system, vehicle.camera_component)
            return (CommandStep(command, (0.0, 0.0, 1.0, float(picture)), *camera),)
        case table.Depth(metres=float() as metres):
            # ArduSub accepts a target depth only in ALT_HOLD.
            return (*build_steps(table.Hold(), vehicle, picture), DepthStep(metres, *address))
    raise ValueError(f"{action!r} has an open slot: resolve it first")
