"""A movement: what the trajectory voters see of a recording.

Gestures are compared step by step, so all recordings are brought to the same number of steps and
the same landmarks: those that are salient in any gesture of the language, and the limbs of the
arms they belong to.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from app.recognition.landmarks import other_side
from app.recognition.poses import FloatArray
from app.recognition.trajectory import Trajectory

STEPS = 32
"""Steps that a movement is resampled to.

A figure of ten strokes still has three points a stroke. 64 steps cost four times as much and
changed no result by more than sampling error; $1 uses 64 for single strokes, Jackknife 16.
"""

SMOOTHING_SECONDS = 0.065
"""Standard deviation of the Gaussian that smooths paths: two frames of a 30 Hz camera.

Strokes of an arm last several tenths of a second; a pose model's jitter lives from frame to frame.
"""

SMOOTHING_SHARE = 0.03
"""Most of the duration that the smoothing's standard deviation may be: a quick gesture, or a clock
that does not run in seconds, keeps its shape."""

LIMBS = (
    ("shoulder", "elbow"),
    ("elbow", "wrist"),
    ("wrist", "hand"),
    ("wrist", "hand_tip"),
    ("wrist", "index"),
    ("wrist", "thumb"),
    ("wrist", "pinky"),
)
"""Bones of an arm, from the trunk outwards, by the names of their ends without the side."""

SIDES = ("left_", "right_")


@dataclass(frozen=True, eq=False, kw_only=True)
class Movement:
    """Paths and limbs in `STEPS` steps of equal length along the joint path.

    Attributes
    ----------
    paths
        ``(N, L, 2)``: the followed landmarks, each relative to its own mean place. A landmark
        that was never seen stays at its place: what is not seen does not move.
    limbs
        ``(N, B, 2)``: vectors along the arms' bones; NaN where an end was not seen.
    reached
        ``(N,)`` seconds after the start at which each step was reached.

    """

    paths: FloatArray
    limbs: FloatArray
    reached: FloatArray

    @property
    def duration(self) -> float:
        """Seconds from the first to the last step."""
        return float(self.reached[-1] - self.reached[0])

    def reordered(self, order: npt.NDArray[np.intp]) -> Movement:
        """Take the steps in another order, each as long as before."""
        return replace(self, paths=self.paths[order], limbs=self.limbs[order])

    def with_sides_exchanged(self, landmarks: Sequence[str]) -> Movement:
        """Take what each landmark and limb of the left does for the right one's, and vice versa.

        Parameters
        ----------
        landmarks
            Names of the paths; one whose counterpart is not among them stays as it is.

        """
        parts = tuple(part_of(name) for name in landmarks)
        sides = _sides_of(parts)
        by_side = self.limbs.reshape(len(self.limbs), len(sides), len(LIMBS), 2)
        return replace(
            self,
            paths=self.paths[:, [_index_across(parts, part) for part in parts]],
            limbs=by_side[:, [_index_across(sides, side) for side in sides]].reshape(
                self.limbs.shape
            ),
        )


def followed_landmarks(salient: Sequence[Sequence[str]]) -> tuple[str, ...]:
    """Return the landmarks that are salient in any gesture of a language, in alphabetical order."""
    return tuple(sorted({name for names in salient for name in names}))


def limbs_of(landmarks: Sequence[str]) -> tuple[tuple[str, str], ...]:
    """Return the bones of the arms that the landmarks belong to, by the parts at their ends."""
    sides = _sides_of([part_of(name) for name in landmarks])
    return tuple((side + inner, side + outer) for side in sides for inner, outer in LIMBS)


def _sides_of(parts: Sequence[str]) -> tuple[str, ...]:
    return tuple(side for side in SIDES if any(part.startswith(side) for part in parts))


def _index_across(names: Sequence[str], name: str) -> int:
    """Return where the counterpart on the other side stands, or the name itself without one."""
    other = other_side(name)
    return names.index(other if other in names else name)


@lru_cache(maxsize=1024)
def part_of(landmark: str) -> str:
    """Name the part of the body as MediaPipe does: ``WristRight`` is ``right_wrist``."""
    words = re.findall(r"[A-Z]?[a-z0-9]+|[A-Z]+(?![a-z])", landmark)
    lower = [word.lower() for word in words]
    side = [word for word in lower if word + "_" in SIDES]
    return "_".join(side + [word for word in lower if word not in side])


def hands_in(landmarks: Sequence[str]) -> int:
    """Count the bodies' parts that move by themselves: all landmarks of one arm are one."""
    parts = [part_of(name) for name in landmarks]
    return len({next((side for side in SIDES if part.startswith(side)), part) for part in parts})


def on_both_sides(landmarks: Sequence[str]) -> bool:
    """Tell whether every landmark's counterpart on the other side is among them."""
    parts = {part_of(name) for name in landmarks}
    return all(other_side(part) in parts for part in parts)


def movement(trajectory: Trajectory, landmarks: Sequence[str]) -> Movement:
    """Smooth a trajectory, and resample it along the joint path of the landmarks it shows.

    Parameters
    ----------
    trajectory
        With at least two moments.
    landmarks
        To follow, see `followed_landmarks`; those that were never seen stay still.

    """
    bones = limbs_of(landmarks)
    joints = {joint for bone in bones for joint in bone}
    needed = [name for name in trajectory.landmarks if name in landmarks or part_of(name) in joints]
    smooth = _smoothed(trajectory.select(needed))
    seen = [name for name in landmarks if _is_seen(smooth, name)]
    even = smooth.select(seen).resampled_in_arc_length(STEPS) if seen else None
    reached = smooth.time[[0] * STEPS] if even is None else even.time
    paths = np.zeros((STEPS, len(landmarks), 2))
    if even is not None:
        paths[:, [landmarks.index(name) for name in seen]] = even.xy - even.xy.mean(axis=0)
    limbs = np.full((STEPS, len(bones), 2), np.nan)
    places = smooth.at(reached).xy
    column = {part_of(name): index for index, name in enumerate(smooth.landmarks)}
    shown = [index for index, bone in enumerate(bones) if column.keys() >= {*bone}]
    inner, outer = ([column[bones[index][end]] for index in shown] for end in (0, 1))
    limbs[:, shown] = places[:, outer] - places[:, inner]
    return Movement(paths=paths, limbs=limbs, reached=reached - reached[0])


def _is_seen(trajectory: Trajectory, name: str) -> bool:
    if name not in trajectory.landmarks:
        return False
    return bool(np.isfinite(trajectory.xy[0, trajectory.landmarks.index(name)]).all())


def _smoothed(trajectory: Trajectory) -> Trajectory:
    """Average over neighbouring moments; a gap is bridged by what lies on either side."""
    time = trajectory.time
    width = min(SMOOTHING_SECONDS, SMOOTHING_SHARE * float(time[-1] - time[0]))
    weights = np.exp(-0.5 * ((time[:, None] - time[None]) / max(width, 1e-9)) ** 2)
    weights /= weights.sum(axis=1, keepdims=True)
    bridged = trajectory.xy.copy()
    known = np.asarray(np.isfinite(bridged).all(axis=2))
    for index in np.flatnonzero(known.any(axis=0) & ~known.all(axis=0)):
        seen = known[:, index]
        for axis in range(2):
            bridged[:, index, axis] = np.interp(time, time[seen], bridged[seen, index, axis])
    xy = (weights @ bridged.reshape(len(time), -1)).reshape(bridged.shape)
    return replace(trajectory, xy=xy)
