"""Trajectories: landmark paths normalised for the diver's position and distance to the camera."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any, Literal, TypeVar

import numpy as np

from app.recognition.errors import PoseError
from app.recognition.poses.frame import HandShape, mirror_hands
from app.recognition.poses.landmarks import HIPS, SHOULDERS, TORSO, other_side
from app.recognition.poses.sequence import (
    MAX_GAP_SECONDS,
    FloatArray,
    PoseSequence,
    bridge_short_gaps,
    fill_all_gaps,
    find_columns,
)

Result = TypeVar("Result")

Unit = Literal["torso_length", "extent"]

MIN_MOMENTS_OF_DRIFT = 3
"""Least moments from which the torso's drift is told from its sway: two are always a line."""

MIN_EXTENT_IN_FRAME = 0.005
"""Least extent that counts as motion without a torso, as a share of the frame's longer side.

About 3 pixels of 640, a pose model's jitter on a still body. Smaller extents are scaled by the
frame instead of their own size, so that jitter does not look like a gesture.
"""


TURNED_AWAY = 40.0
"""Least degrees from the camera, or between two facings, that count as turned away; pose models err
by 10."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Trajectory:
    """Paths of K landmarks over T moments, relative to the diver's own torso.

    Attributes
    ----------
    landmarks
        K landmark names.
    xy
        ``(T, K, 2)`` in `unit`, x to the image's right, y down, origin at the torso's centre.
        NaN: not seen and not bridged.
    time
        ``(T,)`` seconds since the first moment, strictly increasing.
    unit
        ``"torso_length"``, or ``"extent"`` where the recording shows no torso: then the longest
        diagonal of any landmark's bounding box is 1 (the frame's longer side, where nothing
        moves) and no translation is taken out per frame.
    depth
        ``(T, K)`` in `unit`: how far each landmark is behind the torso's centre, away from the
        camera. NaN: not known. None where the recording has no depth.
    hands
        The hands that hold a shape, left then right (`find_held_hands`); empty where something
        moves or no hand is seen, and in demonstrations that are a movement.
    then_hands
        The same hands with the second of two shapes that they hold one after the other
        (`find_holds`); empty where there is only one shape.
    moving_hands
        The hands that keep a shape during a movement, left then right (`find_moving_hands`); empty
        where none is seen for long enough, and where they are not requested.

    """

    landmarks: tuple[str, ...]
    xy: FloatArray
    time: FloatArray
    unit: Unit
    depth: FloatArray | None = None
    hands: tuple[HandShape, ...] = ()
    then_hands: tuple[HandShape, ...] = ()
    moving_hands: tuple[HandShape, ...] = ()

    @classmethod
    def from_poses(cls, poses: PoseSequence) -> Trajectory:
        """Normalise a pose sequence: torso-centre translation per frame, one scale for all frames.

        Translating or uniformly scaling the recording, and shifting its clock, leave the
        trajectory as it is (paper, Sec. IV-C; the published code never does this). The motion of
        the torso's centre itself is kept as one more path, `TORSO`, without its drift: a leaning
        body is part of a gesture, a drifting one is not.

        Raises
        ------
        PoseError
            When the recording has no frames, or no landmark is seen in any of them.

        """
        if not poses.seen.any():
            raise PoseError(
                f"none of the {len(poses)} frames shows a landmark; choose a range in which the "
                "diver is seen"
            )
        time = poses.time - poses.time[0]
        centre, length = poses.torso_centre(), poses.torso_length()
        if centre is None or length is None:
            frame = float(max(poses.frame_size))
            extent = _extent(poses.xy)
            scale = extent if extent >= MIN_EXTENT_IN_FRAME * frame else frame
            xy = (poses.xy - np.nanmean(poses.xy, axis=(0, 1))) / scale
            return cls(landmarks=poses.landmarks, xy=xy, time=time, unit="extent")
        # Repeated: numpy broadcasts pairs of numbers one by one, which is slow.
        xy = (poses.xy - np.repeat(centre[:, None], len(poses.landmarks), axis=1)) / length
        sway = _remove_drift(centre, time) / length
        return cls(
            landmarks=(*poses.landmarks, TORSO),
            xy=np.concatenate([xy, sway[:, None]], axis=1),
            time=time,
            unit="torso_length",
            depth=_measure_depth(poses),
        )

    def __len__(self) -> int:
        """Count the moments, T."""
        return len(self.time)

    @property
    def held_shapes(self) -> tuple[tuple[HandShape, ...], ...]:
        """The hands of each shape that is held, in their order; empty where none is."""
        return tuple(hands for hands in (self.hands, self.then_hands) if hands)

    @cached_property
    def _computed(self) -> dict[Hashable, Any]:
        return {}

    def compute_once(self, key: Hashable, compute: Callable[[], Result]) -> Result:
        """Return a value computed from this trajectory, cached after the first call.

        Demonstrations and their variants are compared many times while a language is built,
        checked or explained.

        Parameters
        ----------
        key
            Identifies the value and everything it depends on beside the trajectory.
        compute
            Called at most once for a key; its result must not be modified.
        """
        if key not in self._computed:
            self._computed[key] = compute()
        result: Result = self._computed[key]
        return result

    def select(self, names: Sequence[str]) -> Trajectory:
        """Keep the named landmarks, in the order given.

        Raises
        ------
        PoseError
            When a name is not among the trajectory's landmarks.

        """
        columns = find_columns(names, self.landmarks, "trajectory")
        return replace(
            self,
            landmarks=tuple(names),
            xy=self.xy.take(columns, axis=1),
            depth=None if self.depth is None else self.depth.take(columns, axis=1),
        )

    def between(self, start: float, end: float) -> Trajectory:
        """Keep the moments with ``start <= time <= end`` (seconds since the first moment)."""
        inside = (self.time >= start) & (self.time <= end)
        return replace(
            self,
            xy=self.xy[inside],
            time=self.time[inside],
            depth=None if self.depth is None else self.depth[inside],
        )

    @cached_property
    def facing(self) -> float | None:
        """Degrees by which the body is turned from the camera; None where it has no depth.

        Positive: turned to its own left, so that its left shoulder is farther away. The angle of
        the line through the shoulders, the median over the moments.
        """
        if self.depth is None or not set(SHOULDERS) <= set(self.landmarks):
            return None
        left, right = (self.landmarks.index(name) for name in SHOULDERS)
        across = self.xy[:, left, 0] - self.xy[:, right, 0]
        away = self.depth[:, left] - self.depth[:, right]
        known = np.isfinite(across) & np.isfinite(away)
        if not known.any():
            return None
        return math.degrees(math.atan2(np.median(away[known]), np.median(across[known])))

    def turn(self, degrees: float) -> Trajectory:
        """Return the trajectory as seen when the body is turned about the vertical.

        Parameters
        ----------
        degrees
            Positive: to the body's own left, as `facing`. Landmarks whose depth is not known count
            as beside the torso's centre; without any depth nothing changes.

        """
        if self.depth is None:
            return self
        cosine, sine = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        across, away = self.xy[..., 0], np.nan_to_num(self.depth)
        xy = np.stack([cosine * across - sine * away, self.xy[..., 1]], axis=2)
        return replace(self, xy=xy, depth=sine * across + cosine * self.depth)

    def turn_once(self, degrees: int) -> Trajectory:
        """Return `turn`, cached."""
        return self.compute_once(("turned", degrees), lambda: self.turn(degrees))

    def mirror(self) -> Trajectory:
        """Mirror left and right: x changes its sign, landmarks swap their sides."""
        names = tuple(other_side(name) for name in self.landmarks)
        return replace(
            self,
            landmarks=names,
            xy=self.xy * (-1.0, 1.0) + 0.0,
            hands=mirror_hands(self.hands),
            then_hands=mirror_hands(self.then_hands),
            moving_hands=mirror_hands(self.moving_hands),
        )

    def fill_gaps(self, max_gap: float = MAX_GAP_SECONDS) -> Trajectory:
        """Bridge gaps of at most `max_gap` seconds by straight lines; longer ones stay NaN.

        See `bridge_short_gaps`. Depth is smooth, and used for known landmarks only: it is
        interpolated in all gaps.
        """
        depth = None if self.depth is None else _interpolate_depth(self.depth, self.time)
        if np.isfinite(self.xy).all():
            return self if depth is None else replace(self, depth=depth)
        return replace(self, xy=bridge_short_gaps(self.xy, self.time, max_gap), depth=depth)

    def resample_in_time(self, count: int) -> Trajectory:
        """Resample to `count` moments at equal times, linearly.

        A moment between two samples of which one is NaN becomes NaN: gaps stay gaps.

        Raises
        ------
        PoseError
            When `count` is below 2 or the trajectory has fewer than two moments.

        """
        self._require_two(count)
        return self.at(np.linspace(self.time[0], self.time[-1], count))

    def resample_in_arc_length(self, count: int) -> Trajectory:
        """Resample to `count` moments at equal steps along the joint path of all landmarks.

        The step is the root of the summed squared steps of all landmarks, so they stay in step
        with each other; `time` keeps when each point was reached. A trajectory without motion
        is resampled in time instead. Steps into or out of a gap have no length.

        Raises
        ------
        PoseError
            When `count` is below 2 or the trajectory has fewer than two moments.

        """
        return self.at(self.find_arc_length_moments(count))

    def find_arc_length_moments(self, count: int) -> FloatArray:
        """Return the `count` moments to which `resample_in_arc_length` resamples.

        Raises
        ------
        PoseError
            As there.

        """
        self._require_two(count)
        places = self.xy.reshape(len(self), -1)
        steps = places[1:] - places[:-1]
        squares = np.vecdot(steps, steps)
        if np.isnan(squares).any():
            squares = np.fmax(steps**2, 0.0).sum(axis=1)  # NaN: no length
        travelled = np.zeros(len(self))
        np.cumsum(np.sqrt(squares), out=travelled[1:])
        if travelled[-1] == 0:
            return np.linspace(self.time[0], self.time[-1], count)
        # A rest makes `travelled` flat; the tiny share of time keeps it strictly increasing.
        travelled += 1e-9 * travelled[-1] * (self.time / self.time[-1])
        even = travelled[-1] * _equal_shares(count)
        return np.asarray(np.interp(even, travelled, self.time), dtype=np.float64)

    def _require_two(self, count: int) -> None:
        if count < 2 or len(self) < 2:
            raise PoseError(f"cannot resample {len(self)} moments to {count}; both must be >= 2")

    def at(self, moments: FloatArray) -> Trajectory:
        """Interpolate linearly at `moments`, ``(N,)`` seconds inside the time range, in order.

        A moment between two samples of which one is NaN becomes NaN.
        """
        after = np.minimum(np.maximum(self.time.searchsorted(moments), 1), len(self) - 1)
        start, end = self.time[after - 1], self.time[after]
        share = np.minimum(np.maximum((moments - start) / (end - start), 0.0), 1.0)[:, None, None]
        low, high = self.xy.take(after - 1, axis=0), self.xy.take(after, axis=0)
        xy = low + share * (high - low)
        # At a sample itself its neighbour's NaN must not leak in, nor a sum's rounding.
        np.copyto(xy, high, where=share == 1)
        np.copyto(xy, low, where=share == 0)
        depth = self.depth
        if depth is not None:
            depth = _interpolate_depth(depth, self.time, moments)
        return replace(self, xy=xy, time=moments, depth=depth)


@lru_cache(maxsize=16)
def _equal_shares(count: int) -> FloatArray:
    """Return `count` numbers from 0 to 1 at equal steps."""
    return np.linspace(0.0, 1.0, count)


def _remove_drift(path: FloatArray, time: FloatArray) -> FloatArray:
    """Subtract from ``(T, 2)`` its straight line of least squares in time."""
    if len(path) < MIN_MOMENTS_OF_DRIFT:
        return np.zeros_like(path)
    since = time - time.mean()
    velocity = since @ path / (since @ since)
    return np.asarray(path - path.mean(axis=0) - since[:, None] * velocity)


def _measure_depth(poses: PoseSequence) -> FloatArray | None:
    """Return ``(T, K + 1)`` depths in torso lengths, the torso's own last; None if not known."""
    if poses.world is None or not {*SHOULDERS, *HIPS} <= set(poses.landmarks):
        return None
    shoulders, hips = (
        poses.world[:, [poses.landmarks.index(name) for name in pair]].mean(axis=1)
        for pair in (SHOULDERS, HIPS)
    )
    torso = np.linalg.norm((shoulders - hips)[:, :2], axis=1)
    if not np.isfinite(torso).any() or not np.nanmedian(torso) > 0:
        return None
    centre = (shoulders + hips)[:, 2] / 2
    depth = (poses.world[..., 2] - centre[:, None]) / np.nanmedian(torso)
    return np.concatenate([depth, np.zeros((len(poses), 1))], axis=1)


def _interpolate_depth(
    depth: FloatArray, time: FloatArray, moments: FloatArray | None = None
) -> FloatArray:
    """Return depths ``(T, K)`` without gaps, at `moments` if given; NaN where never known."""
    return fill_all_gaps(depth[..., None], time, moments)[..., 0]


def _extent(xy: FloatArray) -> float:
    """Longest bounding-box diagonal of any landmark's path, in the unit of `xy`."""
    seen = np.isfinite(xy).any(axis=(0, 2))
    span = np.nanmax(xy[:, seen], axis=0) - np.nanmin(xy[:, seen], axis=0)
    return float(np.linalg.norm(span, axis=1).max())
