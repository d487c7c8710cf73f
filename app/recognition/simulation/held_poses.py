"""Held poses: a pose of the arms as other people hold it, in front of a camera at another angle.

A person's limbs are longer or shorter against the torso, the hands are not held in quite the same
place, the diver stands turned and leans, and holds the pose for longer or shorter.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from app.recognition.poses.sequence import FloatArray
from app.recognition.simulation.background_motion import (
    PLACE_SPREAD,
    RATE,
    SHOULDER,
    TEMPO_SPREAD,
    TREMOR,
)
from app.recognition.triggers.arm_pose import ArmPose

LIMB_SPREAD: Final = 0.08
"""Standard deviation of the logarithm of a limb's length over the torso's, including the pose
model's errors on both (people's own differ by 0.05; Winter 2009)."""

TURN_SPREAD: Final = 15.0
"""Standard deviation in degrees by which a diver is turned away from the camera."""

LEAN_SPREAD: Final = 6.0
"""Standard deviation in degrees by which a diver leans to a side."""

HOLD: Final = 1.2
"""Median of the seconds for which a pose is held: longer than any hold time, as people are told."""


@dataclass(frozen=True, eq=False)
class HeldPose:
    """One person's holding of a pose.

    Attributes
    ----------
    time
        ``(T,)`` seconds from 0.
    places
        ``(T, 4, 2)``, as of `arm_pose.locate_arms`.

    """

    time: FloatArray
    places: FloatArray


def simulate_held_poses(pose: ArmPose, count: int, *, seed: int = 0) -> tuple[HeldPose, ...]:
    """Simulate how other people hold a pose.

    Parameters
    ----------
    pose
        As demonstrated.
    count
        How many; a larger count begins with the same ones.
    seed
        The same seed gives the same ones.

    """
    return tuple(
        _hold(pose, np.random.default_rng([seed, number])) for number in range(max(count, 0))
    )


def _hold(pose: ArmPose, random: np.random.Generator) -> HeldPose:
    places = np.array(pose.places).reshape(2, 2, 2)  # left and right; elbow and wrist; x and y
    shoulders = np.array([[SHOULDER[0], 0.0], [-SHOULDER[0], 0.0]])
    upper, lower, width = np.exp(random.normal(0, LIMB_SPREAD, 3))
    own = width * shoulders
    elbows = own + upper * (places[:, 0] - shoulders)
    # Hands go to a place (head, belly) rather than keep an angle: half of each.
    reached = elbows + lower * (places[:, 1] - places[:, 0])
    wrists = (reached + places[:, 1]) / 2 + random.normal(0, PLACE_SPREAD, (2, 2))
    elbows = elbows + random.normal(0, PLACE_SPREAD, (2, 2))
    turn, lean = np.radians(random.normal(0, (TURN_SPREAD, LEAN_SPREAD)))
    held = np.stack([elbows, wrists], axis=1).reshape(4, 2) * (np.cos(turn), 1.0)
    held = held @ np.array([[np.cos(lean), np.sin(lean)], [-np.sin(lean), np.cos(lean)]])
    seconds = HOLD * float(np.exp(random.normal(0, TEMPO_SPREAD)))
    time = np.arange(0, seconds, 1 / RATE)
    return HeldPose(time, held + random.normal(0, TREMOR, (len(time), 4, 2)))
