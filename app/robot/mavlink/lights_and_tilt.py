"""Lights and camera tilt: the outputs that show pulses to the diver.

Lights are set as the table's lights action sets them (``DO_SET_SERVO``), the tilt as a gimbal
manager's (``DO_GIMBAL_MANAGER_PITCHYAW``), never by ``MANUAL_CONTROL``, which would take the sticks
from the pilot.
"""

from __future__ import annotations

import math
from typing import Final

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from app.robot.commands.replies import PULSE_SECONDS
from app.robot.mavlink.actions import LEAST_PWM, MOST_PWM, CommandStep, Message, VehicleFacts
from app.robot.mavlink.table import Vehicle

BLINK_PULSE: Final = 1660
"""Pulse length in microseconds of a blink from low lights: 70 % of their brightness."""

NOD_DEGREES: Final = 12.0
"""Angle of a nod: seen from some metres, and done within half a second by slow servos."""

NOD_SECONDS: Final = 1.0
"""Seconds from one nod to the next."""


def build_command(vehicle: Vehicle, command: int, *parameters: float) -> Message:
    """Build a command to the vehicle's autopilot, sent for the first time."""
    return CommandStep(command, parameters, vehicle.system, vehicle.component).build(0)


class LightsOutput:
    """Lights, dimmed by a servo output; values are pulse lengths in microseconds."""

    name: str = "lights"
    pulse_seconds = PULSE_SECONDS
    command: int = mavlink.MAV_CMD_DO_SET_SERVO
    reported_by: int = mavlink.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW
    tolerance = 0.5
    travels = False

    def __init__(self, vehicle: Vehicle, facts: VehicleFacts) -> None:
        self.vehicle = vehicle
        self._facts = facts
        self.key = f"{self.name} {vehicle.system} {vehicle.lights_servo}"
        # A message reports sixteen outputs.
        self._port, self._index = divmod(vehicle.lights_servo - 1, 16)

    @property
    def obstacle(self) -> str:
        """Why the lights must not be set; empty if they may."""
        return self._facts.obstacle

    def read(self, message: Message) -> float | None:
        """Return the pulse length that a message reports. An output that does nothing reports 0."""
        if message.get_type() != "SERVO_OUTPUT_RAW" or message.port != self._port:
            return None
        return float(getattr(message, f"servo{self._index + 1}_raw")) or None

    def find_peak(self, before: float) -> float:
        """Return bright for lights below a third of their brightness, off for others."""
        return BLINK_PULSE if before < LEAST_PWM + (MOST_PWM - LEAST_PWM) / 3 else LEAST_PWM

    def build(self, value: float) -> Message:
        """Build the message that sets a pulse length."""
        return build_command(self.vehicle, self.command, self.vehicle.lights_servo, value)


class TiltOutput:
    """Camera tilt, by the autopilot's gimbal manager; values are degrees, up is positive."""

    name: str = "tilt"
    pulse_seconds = NOD_SECONDS
    command: int = mavlink.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW
    reported_by: int = mavlink.MAVLINK_MSG_ID_GIMBAL_DEVICE_ATTITUDE_STATUS
    tolerance = 2.0
    travels = True
    obstacle = ""

    def __init__(self, vehicle: Vehicle) -> None:
        self.vehicle = vehicle
        self.key = f"{self.name} {vehicle.system}"
        self._yaw = 0.0

    def read(self, message: Message) -> float | None:
        """Return the pitch of the reported attitude, a quaternion w, x, y, z; note its yaw."""
        if message.get_msgId() != self.reported_by or not math.isfinite(sum(message.q)):
            return None
        w, x, y, z = message.q
        ahead, aside = 1 - 2 * (y * y + z * z), 2 * (w * z + x * y)
        self._yaw = math.degrees(math.atan2(aside, ahead))
        return math.degrees(math.atan2(2 * (w * y - z * x), math.hypot(ahead, aside)))

    def find_peak(self, before: float) -> float:
        """Return an angle further down, or up where the camera looks down already."""
        return before + (NOD_DEGREES if before < -30 else -NOD_DEGREES)

    def build(self, value: float) -> Message:
        """Build the message that sets an angle and leaves the yaw as it is.

        ArduPilot refuses a pitch without a yaw, which it takes and reports from the vehicle's bow.
        """
        return build_command(self.vehicle, self.command, value, self._yaw, math.nan, math.nan)


Output = LightsOutput | TiltOutput
"""What shows pulses. `key` names it in the memory, `reported_by` the message that reports its
value, `tolerance` is the largest difference of equal values; `travels`: it moves gradually, so that
a value between two that were set is not the pilot's."""
