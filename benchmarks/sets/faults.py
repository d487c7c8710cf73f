"""Faults that recordings of whole bodies are given: of movement, of frames, and of keypoints."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from app.recognition import PoseSequence
from app.recognition.features.motion import parse_body_part
from app.recognition.poses.landmarks import WRISTS, other_side
from app.recognition.poses.sequence import FloatArray

CUT = 0.35
"""Share of a take's path that is missing."""

HOOK = 0.12
"""Share of a demonstration's frames that each way from and to the salute lasts."""

ARMS = ("elbow", "wrist", "hand", "index", "pinky", "thumb")

Fault = Callable[[PoseSequence, np.random.Generator], PoseSequence]


def of_arms(poses: PoseSequence) -> npt.NDArray[np.bool_]:
    """Return a mask ``(K,)`` of the landmarks of the arms."""
    return np.array([parse_body_part(name).split("_", 1)[-1] in ARMS for name in poses.landmarks])


def flipped(way: tuple[float, float]) -> Fault:
    """Return the fault of arms that are mirrored where they are."""

    def spoil(poses: PoseSequence, _random: np.random.Generator) -> PoseSequence:
        arms, xy = of_arms(poses), poses.xy.copy()
        mean = np.nanmean(xy[:, arms], axis=0)
        xy[:, arms] = mean + (xy[:, arms] - mean) * np.array(way)
        return replace(poses, xy=xy)

    return spoil


def turn_round(poses: PoseSequence, _random: np.random.Generator) -> PoseSequence:
    """Show it the other way round."""
    return replace(poses, xy=poses.xy[::-1].copy())


def exchange_arms(poses: PoseSequence, _random: np.random.Generator) -> PoseSequence:
    """Show it with the other arm, as a mirror does."""
    others = [poses.landmarks.index(other_side(name)) for name in poses.landmarks]
    xy = poses.xy[:, others] * (-1.0, 1.0) + (poses.frame_size[0], 0.0)
    return replace(poses, xy=xy)


def find_way(poses: PoseSequence) -> FloatArray:
    """Return ``(T,)`` the share of the wrists' path that is done at every frame."""
    names = [name for name in WRISTS if name in poses.landmarks]
    steps = np.nan_to_num(np.diff(poses.select(names).xy, axis=0))
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(steps, axis=2).sum(axis=1))])
    return np.asarray(way / max(float(way[-1]), 1e-9))


def keep(poses: PoseSequence, kept: npt.NDArray[np.bool_]) -> PoseSequence:
    """Keep some frames; a gap in time is closed."""
    world = None if poses.world is None else poses.world[kept]
    time = at_rate_of(poses, int(np.count_nonzero(kept)))
    return replace(poses, xy=poses.xy[kept], time=time, confidence=None, world=world)


def at_rate_of(poses: PoseSequence, count: int) -> FloatArray:
    """Return ``(count,)`` times at the frame rate of some poses."""
    return np.asarray(np.arange(count) * float(np.median(np.diff(poses.time))), dtype=np.float64)


def begin_late(poses: PoseSequence, _random: np.random.Generator) -> PoseSequence:
    """Begin late."""
    return keep(poses, find_way(poses) >= CUT)


def end_early(poses: PoseSequence, _random: np.random.Generator) -> PoseSequence:
    """End early."""
    return keep(poses, find_way(poses) <= 1 - CUT)


def leave_out(poses: PoseSequence, _random: np.random.Generator) -> PoseSequence:
    """Leave out the middle; the hand goes on where it is."""
    way = find_way(poses)
    before, after = way <= 0.5 - CUT / 2, way >= 0.5 + CUT / 2
    if not before.any() or not after.any():
        return poses
    arms, xy = of_arms(poses), poses.xy.copy()
    gap = xy[np.flatnonzero(after)[0]] - xy[np.flatnonzero(before)[-1]]
    xy[np.ix_(after, arms)] -= np.nan_to_num(gap[arms])
    return keep(replace(poses, xy=xy), before | after)


def add_part(poses: PoseSequence, random: np.random.Generator) -> PoseSequence:
    """Add a swing of the arm before, after or in the middle of the movement."""
    way = find_way(poses)
    at = {0: 0.04, 1: 0.5, 2: 0.96}[int(random.integers(3))]
    place = int(np.argmin(np.abs(way - at)))
    size = 0.5 * float(np.nanmax(np.ptp(poses.xy[:, of_arms(poses)], axis=0)))
    step = float(np.median(np.diff(poses.time)))
    # As quick as a hand that hurries: five torso lengths a second.
    hurried = int(2 * np.pi * size / (5 * (poses.torso_length() or 100.0) * step))
    count = max(8, hurried, int(0.35 * np.count_nonzero((way > 0.03) & (way < 0.97))))
    phase = np.linspace(0, 2 * np.pi, count)
    side = random.choice((-1.0, 1.0))
    swing = size * np.stack([side * np.sin(phase), 0.4 * (np.cos(phase) - 1)], axis=1)
    added = np.repeat(poses.xy[place][None], count, axis=0)
    moving = find_moving_arm(poses)
    added[:, moving] += swing[:, None]
    xy = np.concatenate([poses.xy[:place], added, poses.xy[place:]])
    time = at_rate_of(poses, len(xy))
    return replace(poses, xy=xy, time=time, confidence=None, world=None)


def find_moving_arm(poses: PoseSequence) -> npt.NDArray[np.bool_]:
    """Return a mask of the landmarks of the arm whose wrist moves more."""
    moved = {
        name: float(np.nanmax(np.ptp(poses.column(name), axis=0)))
        for name in WRISTS
        if name in poses.landmarks
    }
    side = max(moved, key=moved.__getitem__).split("_")[0]
    of_side = np.array([name.startswith(side) for name in poses.landmarks])
    return np.asarray(of_arms(poses) & of_side)


def shrink(poses: PoseSequence, _random: np.random.Generator) -> PoseSequence:
    """Show it at a quarter of its size."""
    arms, xy = of_arms(poses), poses.xy.copy()
    mean = np.nanmean(xy[:, arms], axis=0)
    xy[:, arms] = mean + (xy[:, arms] - mean) / 4
    return replace(poses, xy=xy)


def jump(poses: PoseSequence, _random: np.random.Generator) -> PoseSequence:
    """Let the moving wrist jump to the other arm's elbow, or hip if farther, twice for 0.35 s."""
    xy, way = poses.xy.copy(), find_way(poses)
    arm = find_moving_arm(poses)
    outer = arm & np.array(["elbow" not in name for name in poses.landmarks])
    moving = poses.landmarks[int(np.flatnonzero(arm)[0])]
    other = "left" if moving.startswith("right") else "right"
    targets = [poses.landmarks.index(f"{other}_{part}") for part in ("elbow", "hip")]
    count = max(3, round(0.35 / float(np.median(np.diff(poses.time)))))
    for at in (0.35, 0.65):
        first = int(np.argmin(np.abs(way - at)))
        span = slice(first, min(first + count, len(xy) - 1))
        wrist = np.nanmean(poses.xy[first][outer], axis=0)
        target = max(targets, key=lambda each: float(np.linalg.norm(xy[first, each] - wrist)))
        xy[span, outer] = xy[span, target][:, None]
    return replace(poses, xy=xy)


def change_body(poses: PoseSequence, random: np.random.Generator) -> PoseSequence:
    """Show a buddy's body, who is farther away and at rest, for a quarter of the movement."""
    xy, way = poses.xy.copy(), find_way(poses)
    first = int(np.argmin(np.abs(way - 0.4)))
    span = slice(first, first + max(4, int(0.25 * np.count_nonzero((way > 0.02) & (way < 0.98)))))
    torso = poses.torso_length() or 100.0
    rest = xy[0] + np.array([random.choice((-1.6, 1.6)) * torso, 0.2 * torso])
    middle = np.nanmean(rest, axis=0)
    xy[span] = middle + 0.65 * (rest - middle)
    return replace(poses, xy=xy)


def add_ways(poses: PoseSequence, _random: np.random.Generator) -> PoseSequence:
    """Put a straight way from and to a salute beside the head around the movement."""
    way = find_way(poses)
    inside = (way >= 0.02) & (way <= 0.98)
    first, last = np.flatnonzero(inside)[[0, -1]]
    arm = find_moving_arm(poses)
    torso = poses.torso_length() or 100.0
    count = max(6, int(HOOK * (last - first)))
    salute = poses.xy[first].copy()
    shoulders = [name for name in poses.landmarks if name.endswith("shoulder")]
    side = "left" if poses.landmarks[int(np.flatnonzero(arm)[0])].startswith("left") else "right"
    corner = poses.column(next(name for name in shoulders if name.startswith(side)))[first]
    outer = arm & np.array(["elbow" not in name for name in poses.landmarks])
    salute[outer] = corner + np.array([0.1, -0.35]) * torso
    share = (1 - np.cos(np.linspace(0, np.pi, count)))[:, None, None] / 2
    come = salute * (1 - share) + poses.xy[first] * share
    go = poses.xy[last] * (1 - share) + salute * share
    xy = np.concatenate([come, poses.xy[first : last + 1], go])
    time = at_rate_of(poses, len(xy))
    return replace(poses, xy=xy, time=time, confidence=None, world=None)


TAKE_FAULTS: dict[str, Fault] = {
    "mirrored": flipped((-1, 1)),
    "upside_down": flipped((1, -1)),
    "reversed": turn_round,
    "other_arm": exchange_arms,
    "begun_late": begin_late,
    "ended_early": end_early,
    "part_missing": leave_out,
    "part_added": add_part,
    "too_small": shrink,
    "keypoints_jumped": jump,
    "other_person": change_body,
}
"""Faults of takes, by the kind of cause that they are."""

DEMONSTRATION_FAULTS: dict[str, Fault] = {
    "ways": add_ways,
    "jump": jump,
    "begun-late": begin_late,
    "ended-early": end_early,
    "part-missing": leave_out,
    "another-body": change_body,
}
"""Faults of demonstrations."""
