"""Simulated divers: arm movements that are no gestures, and poses that other people hold.

`simulate_background_motion`: hands also reach for things, adjust the mask or scull for balance, and
a gesture that resembles such a movement causes false alarms. The movements are not recorded:
positions in front of a body of average proportions (Winter 2009, table 4.1) are joined by
minimum-jerk strokes (Flash and Hogan 1985), with position, size, tempo and hand drawn at random for
each example.

`simulate_held_poses`: other people hold a pose of the arms in front of a camera at another angle.
Their limbs are longer or shorter against the torso, the hands are not held in quite the same place,
the diver stands turned and leans, and holds the pose for longer or shorter.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

import numpy as np

from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.triggers.trigger import ArmPose

RATE = 25.0
"""Moments per second, a usual camera's frame rate."""

SHOULDER = np.array([0.33, -0.5])
HIP = np.array([0.2, 0.5])
NOSE = np.array([0.0, -0.85])
UPPER_ARM = 0.65
FOREARM = 0.51
"""A body of average proportions, in torso lengths: x outward, y down from the torso's centre
(Winter 2009, table 4.1: trunk 0.288 of stature, upper arm 0.186, forearm 0.146)."""

BENT_TOWARDS_CAMERA = 0.7
"""Visible share of an elbow's bend: arms in front of the body also bend towards the camera."""

HAND = {"pinky": (0.19, -0.05), "index": (0.2, 0.03), "thumb": (0.12, 0.07)}
"""Landmarks of the hand relative to the wrist: along the forearm, and across it towards the thumb,
in torso lengths, as the pose model places them on a flat hand."""

REST = (0.43, 0.6)
"""Position of the wrist when the arm hangs beside the body."""

PLACE_SPREAD = 0.07
"""Standard deviation of a position, in torso lengths: 3 to 4 cm."""

TEMPO_SPREAD = 0.25
"""Standard deviation of the logarithm of the tempo: two people's takes of one movement differ by
about a quarter in their duration."""

TREMOR = 0.004
"""Standard deviation of a landmark's jitter in torso lengths, about a pixel of a diver who fills
half of a 480-pixel frame."""

Place = tuple[float, float]


@dataclass(frozen=True)
class Manner:
    """A kind of background motion: positions of the hand, and the duration of each stroke.

    Attributes
    ----------
    kind
        In words, such as "adjusting the mask".
    places
        The wrist's positions in torso lengths: x outward from the body's middle on the hand's own
        side (negative: across), y down from the torso's centre.
    seconds
        Duration of each stroke to the next position.
    repeated
        Least and most repetitions of the positions.
    both
        Whether both hands move, mirrored.
    hold
        Least and most seconds of rest at the last position.
    alternating
        With `both`: the other hand is half a round behind.

    """

    kind: str
    places: tuple[Place, ...]
    seconds: float
    repeated: tuple[int, int] = (1, 1)
    both: bool = False
    hold: tuple[float, float] = (0.0, 0.0)
    alternating: bool = False


MANNERS = (
    Manner("reaching ahead", ((0.25, -0.45),), 0.8, hold=(0.2, 0.8)),
    Manner("reaching aside", ((1.15, -0.35),), 0.9, hold=(0.2, 0.8)),
    Manner("reaching across", ((-0.4, -0.15),), 0.8, hold=(0.1, 0.6)),
    Manner("pointing at something", ((0.9, -0.7),), 0.8, hold=(0.6, 1.5)),
    Manner("adjusting the mask", ((0.1, -0.85), (0.02, -0.95)), 0.5, (1, 3), hold=(0.1, 0.5)),
    Manner("clearing the ears", ((0.03, -0.78),), 0.7, hold=(0.5, 1.5)),
    Manner("checking a gauge", ((0.05, -0.12),), 0.8, hold=(0.6, 1.5)),
    Manner("tugging a strap", ((0.28, -0.3), (0.36, -0.1)), 0.35, (2, 4)),
    Manner("venting the vest", ((0.4, -1.4),), 0.9, hold=(0.6, 1.5)),
    Manner(
        "finding the regulator",
        ((0.75, 0.45), (1.15, -0.2), (0.75, -0.85), (0.08, -0.75)),
        0.45,
        hold=(0.2, 0.6),
    ),
    Manner("waving", ((0.45, -1.0), (0.85, -0.95)), 0.4, (2, 4)),
    Manner("sculling", ((0.6, 0.3), (0.75, 0.4), (0.6, 0.48)), 0.3, (2, 4), both=True),
    Manner("spreading the arms for balance", ((1.1, -0.15),), 0.7, both=True, hold=(0.2, 0.8)),
    Manner("folding the arms", ((-0.15, -0.1),), 0.9, both=True, hold=(0.4, 1.0)),
    Manner("swimming breaststroke", ((0.1, -0.7), (0.95, -0.6), (0.5, -0.1)), 0.5, (1, 3), True),
    Manner(
        "swimming crawl",
        ((0.5, -1.3), (0.4, -0.3), (0.45, 0.5), (0.7, -0.4)),
        0.4,
        (1, 3),
        both=True,
        alternating=True,
    ),
)
"""All kinds. Positions and durations were estimated by eye from people in front of a camera; the
spreads are so wide that exact values matter little."""


@dataclass(frozen=True, eq=False)
class BackgroundMovement:
    """One example of background motion.

    Attributes
    ----------
    kind
        In words, such as "adjusting the mask".
    trajectory
        Of the upper body's 15 landmarks, in torso lengths. Half of the examples begin and end with
        the arm at rest, the others are the movement alone, like a trimmed take.

    """

    kind: str
    trajectory: Trajectory


def simulate_background_motion(count: int = 3, *, seed: int = 0) -> tuple[BackgroundMovement, ...]:
    """Simulate background motion.

    Parameters
    ----------
    count
        Examples of each kind in `MANNERS`; a larger count begins with the same examples.
    seed
        The same seed gives the same movements.

    """
    return tuple(
        BackgroundMovement(manner.kind, _draw(manner, np.random.default_rng([seed, *which])))
        for which in np.ndindex(len(MANNERS), count)
        for manner in [MANNERS[which[0]]]
    )


def _draw(manner: Manner, generator: np.random.Generator) -> Trajectory:
    """Draw one example, with the right or the left hand."""
    places, seconds = _draw_path(manner, generator)
    active = _join_strokes(places, seconds)
    idle = np.broadcast_to(np.array(REST), active.shape)
    other = idle
    if manner.both:
        lag = len(active) // (2 * manner.repeated[1]) if manner.alternating else 0
        other = np.concatenate([np.repeat(active[:1], lag, axis=0), active])[: len(active)]
    body = _build_body(right=active, left=other)
    jitter = generator.normal(0, TREMOR, body.xy.shape)
    shaky = replace(body, xy=body.xy + jitter)
    return shaky.mirror() if generator.random() < 0.5 else shaky


def _draw_path(
    manner: Manner, generator: np.random.Generator
) -> tuple[list[FloatArray], list[float]]:
    """Draw the positions of one example, and the durations of the strokes between them."""
    rounds = int(generator.integers(manner.repeated[0], manner.repeated[1] + 1))
    pace = float(np.exp(generator.normal(0, TEMPO_SPREAD)))
    visited = list(manner.places) * rounds
    from_rest = bool(generator.random() < 0.5) or len(visited) == 1
    if from_rest:
        visited = [REST, *visited, REST]
    places = [np.array(place) + generator.normal(0, PLACE_SPREAD, 2) for place in visited]
    ways = [manner.seconds * pace * float(generator.uniform(0.8, 1.25)) for _ in visited[1:]]
    if manner.hold[1] > 0:
        last = len(places) - 1 - from_rest
        places.insert(last + 1, places[last] + generator.normal(0, PLACE_SPREAD / 5, 2))
        ways.insert(last, float(generator.uniform(*manner.hold)))
    return places, ways


def _join_strokes(places: Sequence[FloatArray], seconds: Sequence[float]) -> FloatArray:
    """Join positions by minimum-jerk strokes: ``(T, 2)`` at `RATE`.

    A stroke lasts a third longer than its interval and overlaps the next one, so that the hand
    rounds the corners as in one movement (Flash and Hogan 1985, via points).
    """
    time = np.arange(0, sum(seconds) + seconds[-1] / 3, 1 / RATE)
    path = np.repeat(places[0][None], len(time), axis=0)
    begin = 0.0
    for (before, after), way in zip(pairwise(places), seconds, strict=True):
        share = np.clip((time - begin) / (way * 4 / 3), 0, 1)
        path = path + _minimum_jerk(share)[:, None] * (after - before)
        begin += way
    return path


def _minimum_jerk(share: FloatArray) -> FloatArray:
    """Return the share of a stroke's distance at a share of its time."""
    return np.asarray(share**3 * (10 - 15 * share + 6 * share**2))


def _build_body(right: FloatArray, left: FloatArray) -> Trajectory:
    """Build the upper body's landmarks for two wrists' paths ``(T, 2)``, x outward each."""
    paths = {"nose": np.broadcast_to(NOSE, right.shape)}
    # The diver faces the camera: the right hand's outside is the image's left.
    for side, outward, wrist in (("right", (-1.0, 1.0), right), ("left", (1.0, 1.0), left)):
        for part, path in _build_arm(wrist).items():
            paths[f"{side}_{part}"] = path * outward
    # Depth 0 says that the diver faces the camera, so that one view is compared.
    return Trajectory(
        landmarks=tuple(paths),
        xy=np.stack(list(paths.values()), axis=1),
        time=np.arange(len(right)) / RATE,
        unit="torso_length",
        depth=np.zeros((len(right), len(paths))),
    )


def _build_arm(wrist: FloatArray) -> dict[str, FloatArray]:
    """Return an arm whose hand is at the wrist's position; stretched if that is too far away."""
    reach = wrist - SHOULDER
    distance = np.maximum(np.linalg.norm(reach, axis=1, keepdims=True), 1e-9)
    along = reach / distance
    bounded = np.minimum(distance, UPPER_ARM + FOREARM)
    foot = np.clip((UPPER_ARM**2 - FOREARM**2 + bounded**2) / (2 * bounded), -UPPER_ARM, UPPER_ARM)
    bend = BENT_TOWARDS_CAMERA * np.sqrt(UPPER_ARM**2 - foot**2)
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    # Of the two possible bends the lower one, or the outer one where both are level.
    downward = np.where(across @ (0.3, 1.0) >= 0, 1.0, -1.0)[:, None]
    elbow = SHOULDER + foot * along + bend * downward * across
    reached = SHOULDER + bounded * along
    forearm = reached - elbow
    forearm = forearm / np.maximum(np.linalg.norm(forearm, axis=1, keepdims=True), 1e-9)
    thumbwards = np.stack([forearm[:, 1], -forearm[:, 0]], axis=1)
    hand = {
        name: reached + ahead * forearm + over * thumbwards for name, (ahead, over) in HAND.items()
    }
    still = {
        name: np.broadcast_to(place, wrist.shape)
        for name, place in (("shoulder", SHOULDER), ("hip", HIP))
    }
    return {**still, "elbow": elbow, "wrist": reached, **hand}


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
        ``(T, 4, 2)``, as of `trigger.locate_arms`.

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
