"""Movements: trajectories resampled to equal steps, the input of the motion voters.

Gestures are compared step by step, so all trajectories get the same number of steps and the same
landmarks: those that are salient in any gesture of the language, and the limbs of their arms.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
import numpy.typing as npt

from app.recognition.poses.landmarks import TORSO, other_side
from app.recognition.poses.sequence import FloatArray, fill_all_gaps
from app.recognition.poses.trajectory import Trajectory

STEPS = 32
"""Steps of a movement: a figure of ten strokes has three points a stroke.

64 steps cost four times as much and changed no result by more than sampling error; $1 uses 64 for
single strokes, Jackknife 16.
"""

SMOOTHING_SECONDS = 0.065
"""Standard deviation of the Gaussian that smooths paths: two frames of a 30 Hz camera.

Strokes of an arm last several tenths of a second; a pose model's jitter changes every frame.
"""

SMOOTHING_SHARE = 0.03
"""Largest standard deviation as a share of the duration, so that a quick gesture, or one whose
clock is not in seconds, keeps its shape."""

FARTHEST = 40.0
"""Largest exponent of the Gaussian: ``exp(-40)`` is below the rounding of 1, and numbers so small
that a double is denormal take four times as long.
"""

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

ARM_JOINTS = ("elbow", "wrist")
"""Joints of an arm whose places in time are compared, of both arms."""

ARMS = len(SIDES) * len(ARM_JOINTS)
"""Number of these joints."""

RESTING_SHARE = 0.04
"""Share of the joint path that is cut at either end, with the rests before and after a gesture.

Recordings begin and end with hanging arms for any length of time, and with a part of the way from
and to them. A share of the path needs no speed of rest; shares from 0.02 to 0.07 give the same
accuracy (`benchmarks/studies/people.md`)."""

SHARES, SIZE = "shares", "size"
"""Names of `Movement.shares` and `Movement.size` among a movement's descriptors."""

LEAST_MOVING = 8
"""Least moments that are kept; a movement of fewer is not cut."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Movement:
    """Paths and limbs in `STEPS` steps of equal length along the joint path.

    Attributes
    ----------
    paths
        ``(N, L, 2)``: the followed landmarks, each relative to its own mean position. A landmark
        that was never seen is 0 throughout, as if it did not move.
    limbs
        ``(N, B, 2)``: vectors along the arms' bones; NaN where an end was not seen.
    reached
        ``(N,)`` seconds after the start at which each step was reached.
    places
        ``(N, A, 2)`` in the trajectory's unit: `list_arm_landmarks` at N equal times, relative to
        the body without its drift; NaN for landmarks that were not seen.
    ways
        ``(N, 4, 2)``: `ARM_JOINTS` of both `SIDES` in steps of equal length along their own joint
        path, relative to the torso of the same moment; all NaN where one of them was not seen.
    relative_to_body
        Whether `places` and `ways` are measured from a torso and in its lengths.

    """

    paths: FloatArray
    limbs: FloatArray
    reached: FloatArray
    places: FloatArray
    ways: FloatArray
    relative_to_body: bool

    @cached_property
    def figure(self) -> FloatArray:
        """`paths` in sizes: divided by the root of the mean square.

        The mean over the steps of the squares summed over all landmarks; paths without motion
        are unchanged.
        """
        return normalize_figure(self.paths)

    @cached_property
    def _flat_places(self) -> FloatArray:
        """``(N, 2 A)``: `places`; landmarks that were not seen are 0, as if they did not move."""
        return np.nan_to_num(self.places).reshape(len(self.places), -1)

    @cached_property
    def shares(self) -> FloatArray:
        """``(2, 2 A)``: how much each coordinate of `places` moves, by its path and its extent.

        Both are unit vectors; 0 for landmarks that were not seen. They give the correction factor
        of a score (`References.correct`).
        """
        flat = self._flat_places
        moved = np.stack([np.abs(np.diff(flat, axis=0)).sum(axis=0), np.ptp(flat, axis=0)])
        return np.asarray(moved / np.maximum(np.linalg.norm(moved, axis=1, keepdims=True), 1e-9))

    @cached_property
    def size(self) -> FloatArray:
        """``(2,)``: logarithms to base 2 of the path's length and extent, torso lengths.

        NaN where no torso is seen.
        """
        if not self.relative_to_body:
            return np.full(2, np.nan)
        flat = self._flat_places
        steps = np.diff(flat, axis=0)
        length = float(np.sqrt(np.vecdot(steps, steps)).sum())
        extent = float(np.linalg.norm(np.ptp(flat, axis=0)))
        return np.log2(np.maximum([length, extent], 1e-3))

    @property
    def duration(self) -> float:
        """Seconds from the first to the last step."""
        return float(self.reached[-1] - self.reached[0])

    def reorder(self, order: npt.NDArray[np.intp]) -> Movement:
        """Return the movement with its steps in another order, each as long as before."""
        return replace(
            self,
            paths=self.paths[order],
            limbs=self.limbs[order],
            places=self.places[order],
            ways=self.ways[order],
        )

    def with_sides_exchanged(self, landmarks: Sequence[str]) -> Movement:
        """Return the movement with the left and right landmarks and limbs exchanged.

        Parameters
        ----------
        landmarks
            Names of the paths; one whose counterpart is not among them stays as it is.

        """
        parts = tuple(parse_body_part(name) for name in landmarks)
        sides = _sides_of(parts)
        by_side = self.limbs.reshape(len(self.limbs), len(sides), len(LIMBS), 2)
        placed = tuple(parse_body_part(name) for name in list_arm_landmarks(landmarks))
        across = [_index_across(placed, part) for part in placed]
        return replace(
            self,
            places=self.places[:, across],
            ways=self.ways[:, across[: self.ways.shape[1]]],
            paths=self.paths[:, [_index_across(parts, part) for part in parts]],
            limbs=by_side[:, [_index_across(sides, side) for side in sides]].reshape(
                self.limbs.shape
            ),
        )


def normalize_figure(paths: FloatArray) -> FloatArray:
    """Move each path of ``(N, K, 2)`` to its own mean, and divide all by one size."""
    return normalize_size(paths - np.add.reduce(paths) / len(paths))


def normalize_size(vectors: FloatArray) -> FloatArray:
    """Divide ``(N, K, 2)`` by the root of the mean over the steps of the summed squares.

    NaN adds nothing; vectors of size 0 are unchanged.
    """
    coordinates = vectors.reshape(-1)
    total = float(coordinates @ coordinates)
    if math.isnan(total):
        known = coordinates[~np.isnan(coordinates)]
        total = float(known @ known)
    size = math.sqrt(total / len(vectors))
    return vectors / size if size > 0 else vectors


def central_differences(values: FloatArray) -> FloatArray:
    """Return the change a step of ``(N, ...)``, N >= 2: half of that between both neighbours.

    At the ends, where one neighbour is missing, the change from or to the other.
    """
    changes = np.empty_like(values)
    changes[1:-1] = (values[2:] - values[:-2]) / 2
    changes[0], changes[-1] = values[1] - values[0], values[-1] - values[-2]
    return changes


def find_followed_landmarks(salient: Sequence[Sequence[str]]) -> tuple[str, ...]:
    """Return the landmarks that are salient in any gesture of a language, in alphabetical order."""
    return tuple(sorted({name for names in salient for name in names}))


def list_arm_landmarks(landmarks: Sequence[str]) -> tuple[str, ...]:
    """Return the landmarks of `Movement.places`: joints of both arms, then other followed ones."""
    parts = [parse_body_part(name) for name in landmarks]
    joints = tuple(side + joint for side in SIDES for joint in ARM_JOINTS)
    return (*joints, *(part for part in parts if part not in joints))


def list_limbs(landmarks: Sequence[str]) -> tuple[tuple[str, str], ...]:
    """Return the bones of the arms that the landmarks belong to, as pairs of their ends' names."""
    sides = _sides_of([parse_body_part(name) for name in landmarks])
    return tuple((side + inner, side + outer) for side in sides for inner, outer in LIMBS)


def _sides_of(parts: Sequence[str]) -> tuple[str, ...]:
    return tuple(side for side in SIDES if any(part.startswith(side) for part in parts))


def _index_across(names: Sequence[str], name: str) -> int:
    """Return the index of a name's counterpart on the other side, or its own without one."""
    other = other_side(name)
    return names.index(other if other in names else name)


@lru_cache(maxsize=1024)
def parse_body_part(landmark: str) -> str:
    """Return the name of a landmark in MediaPipe's form: ``WristRight`` as ``right_wrist``."""
    words = re.findall(r"[A-Z]?[a-z0-9]+|[A-Z]+(?![a-z])", landmark)
    lower = [word.lower() for word in words]
    side = [word for word in lower if word + "_" in SIDES]
    return "_".join(side + [word for word in lower if word not in side])


def find_hands(landmarks: Sequence[str]) -> int:
    """Count the parts of the body that move independently: all landmarks of one arm are one."""
    parts = [parse_body_part(name) for name in landmarks]
    return len({next((side for side in SIDES if part.startswith(side)), part) for part in parts})


def uses_both_sides(landmarks: Sequence[str]) -> bool:
    """Return whether every landmark's counterpart on the other side is among them."""
    parts = {parse_body_part(name) for name in landmarks}
    return all(other_side(part) in parts for part in parts)


def build_movement(trajectory: Trajectory, landmarks: Sequence[str]) -> Movement:
    """Build a movement: smooth a trajectory, cut its rests, and resample it by path and in time.

    Parameters
    ----------
    trajectory
        With at least two moments.
    landmarks
        The followed ones, see `find_followed_landmarks`; those never seen do not move.

    """
    at = _find_columns(trajectory.landmarks, tuple(landmarks))
    xy = trajectory.xy.take(at.columns, axis=1)
    needed = replace(trajectory, landmarks=at.needed, xy=xy, depth=None)
    smooth = _cut_rests(_smooth(needed), at.moving)
    followed, path = at.followed, at.paths
    seen = np.isfinite(smooth.xy[0]).all(axis=1).take(followed)
    if not seen.all():
        followed, path = followed[seen], path[seen]
    if len(followed):
        shown = replace(smooth, xy=smooth.xy.take(followed, axis=1))
        reached = shown.find_arc_length_moments(STEPS)
    else:
        reached = np.full(STEPS, smooth.time[0])
    even = smooth.at(reached).xy
    paths = np.zeros((STEPS, len(landmarks), 2))
    places_shown = even.take(followed, axis=1)
    paths[:, path] = places_shown - np.add.reduce(places_shown) / STEPS
    limbs = np.full((STEPS, at.bones, 2), np.nan)
    limbs[:, at.shown] = even.take(at.outer, axis=1) - even.take(at.inner, axis=1)
    in_time = smooth.resample_in_time(STEPS).xy
    places = np.full((STEPS, at.arms, 2), np.nan)
    places[:, at.placed] = in_time.take(at.joints, axis=1)
    if at.torso is not None:
        # Positions are relative to the torso of each moment, whose sway is a part of the movement.
        places += in_time[:, [at.torso]]
    return Movement(
        paths=paths,
        limbs=limbs,
        reached=reached - trajectory.time[0],
        places=places,
        ways=_follow_arms(smooth, at),
        relative_to_body=trajectory.unit == "torso_length",
    )


def _follow_arms(smooth: Trajectory, at: _Columns) -> FloatArray:
    """Return `Movement.ways` of a smoothed trajectory."""
    joints = at.joints[at.placed < ARMS]
    xy = smooth.xy.take(joints, axis=1)
    if len(joints) < ARMS or not np.isfinite(xy[0]).all():
        return np.full((STEPS, ARMS, 2), np.nan)
    arms = replace(smooth, xy=xy)
    return arms.at(arms.find_arc_length_moments(STEPS)).xy


@dataclass(frozen=True, eq=False)
class _Columns:
    """Indices that map the landmarks of a trajectory to a movement.

    Attributes
    ----------
    needed, columns
        Names of the landmarks that are followed or end a bone, and their columns in the trajectory.
    followed, paths
        Indices of the followed landmarks in the trajectory: in `needed`, and in the paths.
    shown, inner, outer
        Indices of the bones with both ends in the trajectory: in the limbs, and of both ends in
        `needed`.
    bones
        Number of all bones.
    placed, joints
        Indices of the arms' landmarks in the trajectory: in the places, and in `needed`.
    arms
        Number of all landmarks of the arms.
    moving
        Indices in `needed` of the landmarks whose path shows rests.
    torso
        Index of the torso's path in `needed`; None where the trajectory has none.

    """

    needed: tuple[str, ...]
    columns: npt.NDArray[np.intp]
    followed: npt.NDArray[np.intp]
    paths: npt.NDArray[np.intp]
    shown: npt.NDArray[np.intp]
    inner: npt.NDArray[np.intp]
    outer: npt.NDArray[np.intp]
    bones: int
    placed: npt.NDArray[np.intp]
    joints: npt.NDArray[np.intp]
    arms: int
    moving: npt.NDArray[np.intp]
    torso: int | None


@lru_cache(maxsize=256)
def _find_columns(names: tuple[str, ...], landmarks: tuple[str, ...]) -> _Columns:
    bones, arms = list_limbs(landmarks), list_arm_landmarks(landmarks)
    joints = {TORSO, *arms, *(joint for bone in bones for joint in bone)}
    needed = tuple(name for name in names if name in landmarks or parse_body_part(name) in joints)
    at = {parse_body_part(name): index for index, name in enumerate(needed)}
    here = [(needed.index(name), path) for path, name in enumerate(landmarks) if name in needed]
    shown = [
        (index, at[inner], at[outer])
        for index, (inner, outer) in enumerate(bones)
        if inner in at and outer in at
    ]
    followed, paths = np.array(here, dtype=np.intp).reshape(-1, 2).T
    placed = [(index, at[name]) for index, name in enumerate(arms) if name in at]
    places, columns = np.array(placed, dtype=np.intp).reshape(-1, 2).T
    limbs, inner_ends, outer_ends = np.array(shown, dtype=np.intp).reshape(-1, 3).T
    return _Columns(
        needed=needed,
        columns=np.array([names.index(name) for name in needed], dtype=np.intp),
        followed=followed,
        paths=paths,
        shown=limbs,
        inner=inner_ends,
        outer=outer_ends,
        bones=len(bones),
        placed=places,
        joints=columns,
        arms=len(arms),
        moving=columns if len(columns) else followed,
        torso=at.get(TORSO),
    )


def _cut_rests(trajectory: Trajectory, moving: npt.NDArray[np.intp]) -> Trajectory:
    """Cut the rests before and after a movement; `moving` are the landmarks whose path counts."""
    count = len(trajectory.time)
    if count <= LEAST_MOVING:
        return trajectory
    steps = np.diff(np.nan_to_num(trajectory.xy.take(moving, axis=1)).reshape(count, -1), axis=0)
    way = np.cumsum(np.sqrt(np.vecdot(steps, steps)))
    if not way[-1] > 0:
        return trajectory
    first, last = np.searchsorted(way / way[-1], (RESTING_SHARE, 1 - RESTING_SHARE))
    inside = slice(int(first), max(int(last) + 2, int(first) + LEAST_MOVING))
    return replace(trajectory, xy=trajectory.xy[inside], time=trajectory.time[inside])


def _smooth(trajectory: Trajectory) -> Trajectory:
    """Smooth with a Gaussian in time; gaps are bridged by straight lines."""
    time = trajectory.time
    width = min(SMOOTHING_SECONDS, SMOOTHING_SHARE * float(time[-1] - time[0]))
    scaled = time / (np.sqrt(2.0) * max(width, 1e-9))
    weights = scaled[:, None] - scaled
    np.multiply(weights, weights, out=weights)
    np.minimum(weights, FARTHEST, out=weights)
    np.exp(np.negative(weights, out=weights), out=weights)
    # A column of ones beside the coordinates: its average is the sum of the weights.
    beside = np.ones((len(time), 2 * len(trajectory.landmarks) + 1))
    beside[:, :-1] = fill_all_gaps(trajectory.xy, time).reshape(len(time), -1)
    averaged = weights @ beside
    xy = averaged[:, :-1] / averaged[:, -1:]
    return replace(trajectory, xy=xy.reshape(trajectory.xy.shape))
