"""Posture: inverse kinematics from hand targets to the rotation of every bone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from languages.render.body import Array, Body, HandAxes, Joints, Rotations, unit


def bend_fingers(*degrees: tuple[float, float, float, float]) -> Array:
    """Return spread and bends of thumb to little finger in radians, ``(5, 4)``."""
    bends: Array = np.radians(np.array(degrees))
    return bends


HAND_SHAPES = {
    "salute": bend_fingers(
        (48, 0, 5, 5), (12, 0, 2, 2), (12, 0, 2, 2), (-15, 0, 2, 2), (-16, 0, 2, 2)
    ),
    "flat": bend_fingers((35, 5, 5, 5), (2, 4, 5, 3), (0, 5, 6, 3), (-2, 6, 7, 3), (-4, 8, 8, 4)),
    "relaxed": bend_fingers(
        (35, 8, 10, 10), (6, 14, 20, 11), (1, 17, 23, 14), (-4, 20, 26, 14), (-9, 20, 26, 17)
    ),
    "pointing": bend_fingers(
        (25, 30, 30, 40), (4, 0, 3, 3), (1, 80, 92, 57), (-3, 83, 92, 57), (-7, 80, 92, 57)
    ),
    "open": bend_fingers((48, 0, 5, 5), (14, 3, 4, 2), (3, 3, 4, 2), (-8, 4, 4, 2), (-20, 5, 5, 2)),
}
"""Spread and the bend of the three joints in radians, ``(5, 4)``, thumb to little finger.

"salute" is the vulcan salute: two fingers and two fingers, apart by more than the knuckles are.
"""


@dataclass(frozen=True)
class ArmTarget:
    """What one arm should do at an instant; made for the right arm, mirrored for the left.

    Parameters
    ----------
    wrist
        ``(3,)`` metres from the shoulder joint, for an arm of `REFERENCE_ARM` metres.
    pointing
        ``(3,)`` direction from the wrist to the knuckles.
    palm
        ``(3,)`` direction out of the palm.
    fingers
        ``(5, 4)`` radians, as in `HAND_SHAPES`.

    """

    wrist: Array
    pointing: Array
    palm: Array
    fingers: Array

    def towards(self, other: ArmTarget, fraction: float) -> ArmTarget:
        """Blend with another target: 0 gives this one, 1 the other."""
        keep = 1 - fraction
        return ArmTarget(
            wrist=keep * self.wrist + fraction * other.wrist,
            pointing=keep * self.pointing + fraction * other.pointing,
            palm=keep * self.palm + fraction * other.palm,
            fingers=keep * self.fingers + fraction * other.fingers,
        )


REFERENCE_ARM = 0.55
"""Metres from shoulder to wrist of the body for which wrist targets are written."""

MIRROR = np.array([-1.0, 1.0, 1.0])
ELBOW_HINT = np.array([-0.6, 0.25, -1.0])
"""The way a raised right arm's elbow hangs: down and a little outwards."""


@dataclass(frozen=True)
class BodyMotion:
    """What the rest of the body does at an instant.

    Parameters
    ----------
    shift
        ``(3,)`` metres of drift.
    yaw, roll
        Radians; positive yaw turns the figure to its left, positive roll leans it to its left.
    kick
        Phase of the flutter kick in radians.
    look
        Radians by which the head turns to its left.

    """

    shift: Array
    yaw: float
    roll: float
    kick: float
    look: float = 0.0


def pose_body(body: Body, motion: BodyMotion, right: ArmTarget, left: ArmTarget) -> Joints:
    """Solve the whole rig: hovering trunk, slow fin strokes, both arms to their targets."""
    trunk = axis_rotation([0, 0, 1], motion.yaw) @ axis_rotation([0, 1, 0], motion.roll)
    rotations: Rotations = {"root": trunk, "head": axis_rotation([0, 0, 1], motion.look) @ trunk}
    for side, phase in (("L", 0.0), ("R", np.pi)):
        swing = 0.12 + 0.12 * np.sin(motion.kick + phase)
        thigh = axis_rotation([1, 0, 0], swing) @ trunk
        bend = 0.3 + 0.15 * np.sin(motion.kick + phase - 1.0)
        rotations[f"upperleg01.{side}"] = thigh
        rotations[f"lowerleg01.{side}"] = thigh @ axis_rotation([1, 0, 0], -bend)
    for side, target in (("R", right), ("L", left)):
        _pose_arm(body, rotations, side, target, motion.shift, trunk)
    return body.solve(rotations, motion.shift)


def hand_points(body: Body, joints: Joints, side: str) -> Array:
    """Give the 21 points of a hand, ``(21, 3)`` metres, in MediaPipe's order."""
    points = [joints.position[body.index[f"wrist.{side}"]]]
    for finger in range(1, 6):
        for joint in (1, 2, 3):
            points.append(joints.position[body.index[f"finger{finger}-{joint}.{side}"]])
        last = body.index[f"finger{finger}-3.{side}"]
        bone = body.bones[last].tail - body.bones[last].head
        points.append(joints.position[last] + joints.rotation[last] @ bone)
    return np.array(points)


def axis_rotation(axis: Array | list[int], angle: float) -> Array:
    """Rotate by `angle` radians about `axis` (Rodrigues' formula), ``(3, 3)``."""
    x, y, z = unit(np.asarray(axis, dtype=float))
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    rotation: Array = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    return rotation


def _pose_arm(
    body: Body, rotations: Rotations, side: str, target: ArmTarget, shift: Array, trunk: Array
) -> None:
    """Add the rotations of one arm: two-bone inverse kinematics, then the hand, then fingers."""
    side_axes = MIRROR if side == "L" else np.ones(3)
    upper, lower, hand = f"upperarm01.{side}", f"lowerarm01.{side}", f"wrist.{side}"
    shoulder_rest, elbow_rest, wrist_rest = (body.head_of(name) for name in (upper, lower, hand))
    shoulder = body.solve(rotations, shift).position[body.index[upper]]
    scale = body.arm_length() / REFERENCE_ARM
    reach = trunk @ (target.wrist * side_axes * scale)
    hint = trunk @ (ELBOW_HINT * side_axes)
    lengths = (
        float(np.linalg.norm(elbow_rest - shoulder_rest)),
        float(np.linalg.norm(wrist_rest - elbow_rest)),
    )
    elbow, wrist = _two_bones(shoulder, reach, lengths, hint)
    rest_normal = np.cross(elbow_rest - shoulder_rest, wrist_rest - elbow_rest)
    normal = np.cross(elbow - shoulder, wrist - elbow)
    rotations[upper] = (
        _axes(elbow - shoulder, normal) @ _axes(elbow_rest - shoulder_rest, rest_normal).T
    )
    forearm = _axes(wrist - elbow, normal) @ _axes(wrist_rest - elbow_rest, rest_normal).T
    rotations[lower] = forearm
    axes = body.hands[side]
    pointing = trunk @ (target.pointing * side_axes)
    palm = trunk @ (target.palm * side_axes)
    turn = _axes(pointing, palm) @ _axes(axes.pointing, axes.palm).T
    # The forearm's two bones share the hand's twist, as radius and ulna do.
    twist = _twist(turn @ forearm.T, unit(wrist - elbow))
    rotations[f"lowerarm02.{side}"] = axis_rotation(unit(wrist - elbow), twist / 2) @ forearm
    rotations[hand] = turn
    _pose_fingers(body, rotations, side, HandAxes(*_turn(axes, turn)), target.fingers)


def _two_bones(
    shoulder: Array, reach: Array, lengths: tuple[float, float], hint: Array
) -> tuple[Array, Array]:
    """Place elbow and wrist by the law of cosines; a target out of reach is pulled in."""
    upper, lower = lengths
    distance = min(float(np.linalg.norm(reach)), 0.995 * (upper + lower))
    forward = unit(reach)
    cosine = np.clip((upper**2 + distance**2 - lower**2) / (2 * upper * distance), -1, 1)
    sideways = unit(hint - forward * (forward @ hint))
    elbow = shoulder + upper * (cosine * forward + np.sqrt(1 - cosine**2) * sideways)
    return elbow, shoulder + distance * forward


def _pose_fingers(
    body: Body, rotations: Rotations, side: str, hand: HandAxes, fingers: Array
) -> None:
    turn = rotations[f"wrist.{side}"]
    for number, (spread, *bends) in enumerate(fingers, start=1):
        thumb = number == 1
        # Fingers close towards the palm, the thumb across it.
        closing = unit(0.6 * hand.palm - 0.8 * hand.index_side) if thumb else hand.palm
        straight = np.cos(spread) * hand.pointing + np.sin(spread) * hand.index_side
        bend = 0.0
        for joint in (1, 2, 3):
            name = f"finger{number}-{joint}.{side}"
            bend += bends[joint - 1]
            direction = np.cos(bend) * straight + np.sin(bend) * closing
            if thumb:
                direction = direction + 0.25 * hand.palm
            bone = body.bones[body.index[name]]
            end = bone.tail if joint == 3 else body.head_of(f"finger{number}-{joint + 1}.{side}")
            rotations[name] = _shortest(turn @ (end - bone.head), direction) @ turn


def _turn(axes: HandAxes, turn: Array) -> tuple[Array, Array, Array]:
    return turn @ axes.pointing, turn @ axes.index_side, turn @ axes.palm


def _axes(along: Array, beside: Array) -> Array:
    """Build a right-handed frame whose first column is `along`; columns are its axes."""
    first = unit(along)
    second = unit(beside - first * (first @ beside))
    return np.stack([first, second, np.cross(first, second)], axis=1)


def _shortest(start: Array, end: Array) -> Array:
    """Rotate one direction onto another by the smallest angle."""
    start, end = unit(start), unit(end)
    x, y, z = np.cross(start, end)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    rotation: Array = np.eye(3) + cross + cross @ cross / (1 + start @ end + 1e-9)
    return rotation


def _twist(rotation: Array, axis: Array) -> float:
    """Return the part of a rotation about `axis`, radians."""
    across = unit(np.cross(axis, [0.3, 0.5, 0.8]))
    moved = rotation @ across
    turned = unit(moved - axis * (axis @ moved))
    return float(np.arctan2(np.cross(across, turned) @ axis, across @ turned))
