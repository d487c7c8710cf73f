"""Triggers: how often poses of the arms are missed, and set off by ordinary movement.

For some poses, by tolerance and hold time: the share of simulated people whose pose is missed, and
the false alarms per hour of simulated ordinary movement; and those per hour of people who give
signals to vehicles (`groundguide`), at 30 frames a second.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from itertools import product
from pathlib import Path
from unittest.mock import patch

import numpy as np

from app.recognition.poses.sequence import FloatArray
from app.recognition.recording.salute import HeldTrigger
from app.recognition.simulation.background_motion import (
    simulate_background_motion,
    simulate_held_poses,
)
from app.recognition.triggers import trigger
from app.recognition.triggers.trigger import HANGING_ARMS, LEAVE_SCORE, ArmPose, locate_joints
from benchmarks.figures import Figure, Measurement, Results, share, table

TOLERANCES = (0.25, 0.3, 0.35)
HOLDS = (0.4, 0.6, 0.8, 1.0)
PEOPLE, EXAMPLES = 100, 12
FRAME_RATE = 30.0

HANGING = HANGING_ARMS[2:]
POSES = {
    "hand-before-the-belly": ArmPose(((0.46, 0.52), (0.29, 0.53), *HANGING)),
    "hand-on-the-head": ArmPose(((0.57, -0.37), (0.17, -0.61), *HANGING)),
    "hand-raised": ArmPose(((0.6, -0.3), (0.55, -0.85), *HANGING)),
    "arms-crossed": ArmPose(((0.5, 0.45), (-0.15, 0.35), (-0.5, 0.45), (0.15, 0.3))),
    "both-hands-on-the-head": ArmPose(((0.7, -0.3), (0.15, -0.7), (-0.7, -0.3), (-0.15, -0.7))),
    "both-arms-stretched-aside": ArmPose(((0.85, 0.0), (1.3, 0.0), (-0.85, 0.0), (-1.3, 0.0))),
}


def count_held(hold: float, time: FloatArray, scores: FloatArray) -> int:
    """Return how many times a pose becomes held in a stream of scores."""
    held = HeldTrigger(hold=hold, leave=LEAVE_SCORE)
    states = [held.update(*each) for each in zip(time.tolist(), scores.tolist(), strict=True)]
    return sum(now and not before for before, now in zip([False, *states], states, strict=False))


def measure_poses(
    tolerances: Sequence[float], holds: Sequence[float], quick: bool
) -> Iterator[Figure]:
    """Yield how often each pose is missed, and set off in an hour of ordinary movement."""
    movements = [each.trajectory for each in simulate_background_motion(4 if quick else EXAMPLES)]
    hours = sum(float(each.time[-1]) for each in movements) / 3600
    for tolerance, hold, (name, pose) in product(tolerances, holds, POSES.items()):
        start = f"{name}/" if len(tolerances) == 1 else f"{tolerance:g}-{hold:g}/{name}/"
        with (
            patch.object(trigger, "TOLERANCE", tolerance),
            patch.object(trigger, "IDLE_TOLERANCE", 2 * tolerance),
        ):
            people = simulate_held_poses(pose, 20 if quick else PEOPLE)
            missed = sum(
                not count_held(hold, each.time, pose.score(each.places)) for each in people
            )
            often = sum(
                count_held(hold, each.time, pose.score(locate_joints(each.landmarks, each.xy)))
                for each in movements
            )
        yield share(f"{start}missed", missed, len(people))
        yield Figure(f"{start}alarms-an-hour", often / hours, len(movements), unit="")


def measure_signals(file: Path, quick: bool) -> Iterator[Figure]:
    """Yield how often each pose is set off in an hour of recorded signals to vehicles."""
    with np.load(file, allow_pickle=True) as recorded:
        names = tuple(str(name) for name in recorded["joint_names"])
        paths = [np.asarray(path, np.float64)[..., :2] for path in recorded["x"]]
    hours = sum(map(len, paths)) / FRAME_RATE / 3600
    for name, pose in POSES.items():
        often = sum(
            count_held(
                trigger.POSE_SECONDS,
                np.arange(len(path)) / FRAME_RATE,
                pose.score(locate_joints(names, path)),
            )
            for path in paths
        )
        yield Figure(f"{name}/alarms-an-hour", often / hours, len(paths), unit="")


def measurements(folder: Path, methods: tuple[str, ...]) -> Iterator[Measurement]:
    """Yield the shipped constants, others, and recorded signals."""
    simulated = f"{PEOPLE} simulated people who hold a pose; simulated ordinary movement"
    for part, tolerances, holds in (
        ("shipped", (trigger.TOLERANCE,), (trigger.POSE_SECONDS,)),
        ("constants", TOLERANCES, HOLDS),
    ):
        yield Measurement(
            f"triggers/{part}",
            partial(measure_poses, tolerances, holds),
            data="simulated poses and movement",
            protocol=simulated,
        )
    file = folder / "trajectories" / "groundguide.npz"
    yield Measurement(
        "triggers/signals",
        partial(measure_signals, file),
        data="groundguide",
        protocol="false alarms while people give signals to vehicles",
        reads=(file,),
    )


def write_triggers(results: Results) -> str:
    """Write a row for each pose."""
    rows = [
        [
            name.replace("-", " "),
            results.show("triggers/shipped", f"{name}/missed", "whole"),
            results.show("triggers/shipped", f"{name}/alarms-an-hour", "whole"),
            results.show("triggers/signals", f"{name}/alarms-an-hour", "whole"),
        ]
        for name in POSES
    ]
    return table(
        ("pose", "missed, %", "false alarms an hour, simulated", "while vehicles are guided"), rows
    )


TABLES = {"triggers": write_triggers}
