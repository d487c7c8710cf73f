"""Whole bodies recorded by depth cameras, seen as a camera in front sees them.

Only gestures of the arms are kept. Nothing has been tuned on these sets. Other movements are *far*:
what people do when they do not sign.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from app.recognition import PoseSequence
from app.recognition.poses.sequence import FloatArray
from benchmarks.sets.recorded_sets import FRAME, RATE, RecordedSet, read_arrays

FOCAL = 525.0
"""Pixels: the focal length of a Kinect's colour camera at 640 x 480."""

FIGURES = (
    "draw_circle_ccw",
    "draw_circle_cw",
    "draw_triangle",
    "draw_x",
    "swipe_left",
    "swipe_right",
)
"""The drawn figures and swipes of UTD-MHAD."""

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
    "utd_signals": ("arm_cross", "clap", *FIGURES, "knock", "throw", "wave"),
    "utd_figures": FIGURES,
}
"""The classes performed with the arms, by set."""

FILES = {"utd_figures": "utd_signals"}
"""Names of the files of sets that have none of their own."""

LIKE_SIGNALS = ("Throw", "Punch", "Push", "Wave", "Swipe", "Draw")
"""How the names of movements begin that the other sets have, or that are signals."""

OUR_NAMES = {"left_hand": "left_index", "right_hand": "right_index", "head": "nose"}
"""Our landmark nearest to a joint, where the names differ."""

UPPER_BODY = tuple(
    f"{side}_{part}"
    for part in ("shoulder", "elbow", "wrist", "hand", "hip")
    for side in ("left", "right")
)
"""Joints that are kept."""


def whole_body_sets(
    folder: Path,
    names: Collection[str] | None = None,
    turned: float = 0.0,
    *,
    depth: float | None = None,
) -> Iterator[RecordedSet]:
    """Read the sets.

    Parameters
    ----------
    folder
        It holds ``utd_other.npz``, ``utkinect.npz`` and ``utd_signals.npz``.
    names
        Only these of `ARM_CLASSES`; None: all.
    turned
        Degrees by which everybody is turned about the vertical before the camera looks, positive
        to the own left.
    depth
        Standard deviation in metres of the error of known depth; None: depth is not known.

    """
    for name in ARM_CLASSES if names is None else names:
        content = read_arrays(folder / f"{FILES.get(name, name)}.npz")
        chosen = np.flatnonzero(np.isin(content["label"], ARM_CLASSES[name]))
        yield _whole_body_set(name, content, chosen, turned, depth)


def far_movements(folder: Path) -> RecordedSet:
    """Read the movements of Kinder-Gator that are no signals, such as bows, kicks and lunges.

    Ten people, adults and children, once each; `folder` holds ``kindergator.npz``.
    """
    content = read_arrays(folder / "kindergator.npz")
    signals = [str(label).startswith(LIKE_SIGNALS) for label in content["label"]]
    return _whole_body_set("kindergator", content, np.flatnonzero(~np.array(signals)), 0.0, None)


def _whole_body_set(
    name: str,
    content: dict[str, npt.NDArray[Any]],
    chosen: npt.NDArray[np.intp],
    turned: float,
    depth: float | None,
) -> RecordedSet:
    return RecordedSet(
        name,
        [_seen_by_camera(content, int(index), turned, depth) for index in chosen],
        content["label"][chosen].astype(str),
        content["subject"][chosen].astype(str),
    )


def _seen_by_camera(
    content: dict[str, npt.NDArray[Any]], index: int, turned: float, depth: float | None
) -> PoseSequence:
    joints = [str(name) for name in content["joint_names"]]
    places: FloatArray = content["x"][index].astype(np.float64)
    places = places[:, [joints.index(name) for name in UPPER_BODY]]
    seen = _turn(places, -turned)
    away = np.where(seen[..., 2] > 0.1, seen[..., 2], np.nan)
    xy = np.stack([seen[..., 0] / away, -seen[..., 1] / away], axis=2) * FOCAL
    time = _seconds(content, index)
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


def _seconds(content: dict[str, npt.NDArray[Any]], index: int) -> FloatArray:
    """Return ``(T,)`` times of a recording: its own, or of its frames at `RATE`."""
    if "t" in content:
        return np.asarray(content["t"][index], dtype=np.float64)
    frames = content["frame"][index] if "frame" in content else range(len(content["x"][index]))
    return np.asarray(frames, dtype=np.float64) / RATE


def _turn(places: FloatArray, degrees: float) -> FloatArray:
    """Turn ``(T, K, 3)`` about the vertical through their mean, positive to the right."""
    middle = np.nanmean(places, axis=(0, 1))
    angle = np.radians(degrees)
    cosine, sine = np.cos(angle), np.sin(angle)
    turn = np.array([[cosine, 0, sine], [0, 1, 0], [-sine, 0, cosine]])
    return np.asarray((places - middle) @ turn.T + middle)
