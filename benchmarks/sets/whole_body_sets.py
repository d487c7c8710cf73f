"""Whole bodies recorded by depth cameras, seen as a camera in front sees them.

Only gestures of the arms are kept. Nothing has been tuned on these sets.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from app.recognition import PoseSequence
from app.recognition.poses.sequence import FloatArray
from benchmarks.sets.recorded_sets import FRAME, RATE, RecordedSet

FOCAL = 525.0
"""Pixels: the focal length of a Kinect's colour camera at 640 x 480."""

ARM_CLASSES = {
    "utd_other": (
        "arm_curl",
        "baseball_swing",
        "basketball_shoot",
        "bowling",
        "boxing",
        "catch",
        "pickup_throw",
        "push",
        "tennis_serve",
        "tennis_swing",
    ),
    "utkinect": ("clapHands", "pull", "push", "throw", "waveHands"),
}
"""The classes performed with the arms, by set."""

OUR_NAMES = {"left_hand": "left_index", "right_hand": "right_index", "head": "nose"}
"""Our landmark nearest to a joint, where the names differ."""

UPPER_BODY = tuple(
    f"{side}_{part}"
    for part in ("shoulder", "elbow", "wrist", "hand", "hip")
    for side in ("left", "right")
)
"""Joints that are kept."""


def whole_body_sets(
    folder: Path, turned: float = 0.0, *, depth: float | None = None
) -> Iterator[RecordedSet]:
    """Read the sets.

    Parameters
    ----------
    folder
        It holds ``utd_other.npz`` and ``utkinect.npz``.
    turned
        Degrees by which everybody is turned about the vertical before the camera looks, positive
        to the own left.
    depth
        Standard deviation in metres of the error of known depth; None: depth is not known.

    """
    for name, classes in ARM_CLASSES.items():
        with np.load(folder / f"{name}.npz", allow_pickle=True) as file:
            content: dict[str, npt.NDArray[Any]] = dict(file)
        labels = content["label"].astype(str)
        chosen = np.flatnonzero(np.isin(labels, classes))
        yield RecordedSet(
            name,
            [_seen_by_camera(content, int(index), turned, depth) for index in chosen],
            labels[chosen],
            content["subject"][chosen].astype(str),
        )


def _seen_by_camera(
    content: dict[str, npt.NDArray[Any]], index: int, turned: float, depth: float | None
) -> PoseSequence:
    joints = [str(name) for name in content["joint_names"]]
    places: FloatArray = content["x"][index].astype(np.float64)
    places = places[:, [joints.index(name) for name in UPPER_BODY]]
    seen = _turn(places, -turned)
    frames = content["frame"][index] if "frame" in content else np.arange(len(places))
    away = np.where(seen[..., 2] > 0.1, seen[..., 2], np.nan)
    xy = np.stack([seen[..., 0] / away, -seen[..., 1] / away], axis=2) * FOCAL
    time = np.asarray(frames, dtype=np.float64) / RATE
    first = np.concatenate([[True], np.diff(time) > 0])
    world = None
    if depth is not None:
        error = np.random.default_rng(index).normal(0.0, depth, seen.shape[:2])
        world = np.stack([seen[..., 0], -seen[..., 1], seen[..., 2] + error], axis=2)[first]
    return PoseSequence(
        landmarks=tuple(OUR_NAMES.get(name, name) for name in UPPER_BODY),
        xy=xy[first] + np.array(FRAME) / 2,
        time=time[first] - time[0],
        frame_size=FRAME,
        world=world,
    )


def _turn(places: FloatArray, degrees: float) -> FloatArray:
    """Turn ``(T, K, 3)`` about the vertical through their mean, positive to the right."""
    middle = np.nanmean(places, axis=(0, 1))
    angle = np.radians(degrees)
    cosine, sine = np.cos(angle), np.sin(angle)
    turn = np.array([[cosine, 0, sine], [0, 1, 0], [-sine, 0, cosine]])
    return np.asarray((places - middle) @ turn.T + middle)
