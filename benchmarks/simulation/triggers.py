"""Triggers: how often poses of the arms are missed, and set off by ordinary movement.

For some poses, by tolerance and hold time: the share of simulated people whose pose is missed, and
the false alarms per hour of simulated ordinary movement. With a folder of recorded sets also the
false alarms per hour of people who give signals to vehicles (`groundguide`), at 30 frames a second.

    python -m benchmarks.simulation.triggers [../shared/data]
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
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

TOLERANCES = (0.25, 0.3, 0.35)
HOLDS = (0.4, 0.6, 0.8, 1.0)
PEOPLE, EXAMPLES = 100, 12
FRAME_RATE = 30.0

HANGING = HANGING_ARMS[2:]
POSES = {
    "hand before the belly": ArmPose(((0.46, 0.52), (0.29, 0.53), *HANGING)),
    "hand on the head": ArmPose(((0.57, -0.37), (0.17, -0.61), *HANGING)),
    "hand raised": ArmPose(((0.6, -0.3), (0.55, -0.85), *HANGING)),
    "arms crossed": ArmPose(((0.5, 0.45), (-0.15, 0.35), (-0.5, 0.45), (0.15, 0.3))),
    "both hands on the head": ArmPose(((0.7, -0.3), (0.15, -0.7), (-0.7, -0.3), (-0.15, -0.7))),
    "both arms stretched aside": ArmPose(((0.85, 0.0), (1.3, 0.0), (-0.85, 0.0), (-1.3, 0.0))),
}


def count_held(hold: float, time: FloatArray, scores: FloatArray) -> int:
    """Return how many times a pose becomes held in a stream of scores."""
    held = HeldTrigger(hold=hold, leave=LEAVE_SCORE)
    states = [held.update(*each) for each in zip(time.tolist(), scores.tolist(), strict=True)]
    return sum(now and not before for before, now in zip([False, *states], states, strict=False))


def compare_constants() -> Iterator[str]:
    """Yield a row of Markdown for each tolerance and hold time."""
    movements = [each.trajectory for each in simulate_background_motion(EXAMPLES)]
    hours = sum(float(each.time[-1]) for each in movements) / 3600
    for tolerance in TOLERANCES:
        with (
            patch.object(trigger, "TOLERANCE", tolerance),
            patch.object(trigger, "IDLE_TOLERANCE", 2 * tolerance),
        ):
            for hold in HOLDS:
                row = [f"{tolerance:g}", f"{hold:g}"]
                for pose in POSES.values():
                    people = simulate_held_poses(pose, PEOPLE)
                    missed = sum(
                        not count_held(hold, each.time, pose.score(each.places)) for each in people
                    )
                    often = sum(
                        count_held(
                            hold, each.time, pose.score(locate_joints(each.landmarks, each.xy))
                        )
                        for each in movements
                    )
                    row.append(f"{missed / PEOPLE:.0%} / {often / hours:.0f}")
                yield f"| {' | '.join(row)} |"


def count_in_signals(data: Path) -> Iterator[str]:
    """Yield a line for each pose: false alarms per hour of recorded signals to vehicles."""
    with np.load(data / "trajectories" / "groundguide.npz", allow_pickle=True) as recorded:
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
        yield f"{name}: {often / hours:.0f} in an hour"


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("data", type=Path, nargs="?", help="the folder that holds trajectories/")
    data = parser.parse_args().data
    print(f"| tolerance | hold | {' | '.join(POSES)} |")
    print("| --- " * (2 + len(POSES)) + "|")
    for line in compare_constants():
        print(line, flush=True)
    if data is not None:
        for line in count_in_signals(data):
            print(line)


if __name__ == "__main__":
    main()
