"""Pose sequences: body landmarks over time as an estimator finds them, in pixels and seconds.

`bridge_short_gaps` and `fill_all_gaps` interpolate landmarks where they are not seen.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from app.recognition.errors import PoseError
from app.recognition.poses.landmarks import HAND_LANDMARKS, HIPS, SHOULDERS

FloatArray: TypeAlias = npt.NDArray[np.float64]

MAX_GAP_SECONDS = 0.5
"""Longest gap that is bridged by a straight line, seconds.

Reaching movements last 0.5 s and more (Flash and Hogan 1985): a longer line could replace a whole
stroke, and an invented stroke is worse than a gap.
"""


def bridge_short_gaps(xy: FloatArray, time: FloatArray, max_gap: float) -> FloatArray:
    """Bridge gaps of at most `max_gap` seconds by straight lines; longer ones stay NaN.

    A gap lasts from the last moment a landmark is seen to the next one. Before the first and after
    the last of them there is nothing to bridge to.

    Parameters
    ----------
    xy
        ``(T, K, 2)``; NaN: not seen.
    time
        ``(T,)`` seconds, strictly increasing.

    """
    xy = xy.copy()
    seen = np.asarray(np.isfinite(xy).all(axis=2))
    for index in np.flatnonzero(~seen.all(axis=0)):
        path, known = xy[:, index], np.flatnonzero(seen[:, index])
        for gap in np.flatnonzero(np.diff(known) > 1):
            before, after = known[gap], known[gap + 1]
            span = time[after] - time[before]
            if span <= max_gap:
                inside = slice(before + 1, after)
                share = (time[inside] - time[before]) / span
                path[inside] = path[before] + share[:, None] * (path[after] - path[before])
    return xy


def fill_all_gaps(
    points: FloatArray, time: FloatArray, moments: FloatArray | None = None
) -> FloatArray:
    """Interpolate linearly in time, however long the gap; beyond the ends the nearest value holds.

    Parameters
    ----------
    points
        ``(T, K, D)``; a point is known where all its coordinates are finite.
    time
        ``(T,)`` seconds, strictly increasing.
    moments
        ``(N,)`` seconds at which the result is wanted; by default `time`.

    Returns
    -------
    points
        ``(N, K, D)``; NaN for a landmark that is never known.

    """
    at = time if moments is None else moments
    finite = np.isfinite(points)
    if moments is None and finite.all():
        return points
    known = np.asarray(finite.all(axis=2))
    filled = np.full((len(at), *points.shape[1:]), np.nan)
    for index in np.flatnonzero(known.any(axis=0)):
        seen = known[:, index]
        for axis in range(points.shape[2]):
            filled[:, index, axis] = np.interp(at, time[seen], points[seen, index, axis])
    return filled


SHOULDER_WIDTHS_PER_TORSO = 1.5
"""Torso length over shoulder width, for a diver whose hips are not in view.

Torso: mid-shoulders to mid-hips; width: between the shoulder joints. Adult body proportions
(Winter 2009, table 4.1: trunk 0.288 of stature, biacromial half-width 0.129, joints lie inside)
put the ratio at 1.3 to 1.7; it only stands in until the hips are seen.
"""


HANDS_SHAPE = (2, len(HAND_LANDMARKS), 2)
"""Shape of the hands of one frame: left and right, landmarks, x and y."""

ARRAYS = ("xy", "time", "confidence", "world", "hands")
"""Attributes of a pose sequence with a row for every frame."""


@dataclass(frozen=True, eq=False, kw_only=True)
class PoseSequence:
    """T poses of K landmarks in the pixels of the camera, with the container's own timestamps.

    Parameters
    ----------
    landmarks
        K distinct landmark names. MediaPipe's 33 (`POSE_LANDMARKS`) or any other set.
    xy
        ``(T, K, 2)`` pixels, x to the right, y down, origin at the image's top left corner.
        NaN: not seen in this frame. Infinite values are refused.
    confidence
        ``(T, K)`` in [0, 1], or None where the source gives none.
    time
        ``(T,)`` seconds, strictly increasing: timestamps, never frame number over rate.
    frame_size
        Width and height of the image in pixels.
    world
        ``(T, K, 3)`` metres, x to the image's right, y down, z away from the camera, from any
        origin in each frame; NaN: not known. None where the source gives none. Only depth is
        used, to turn demonstrations (`Trajectory.turn`).
    hands
        ``(T, 2, 21, 2)`` pixels: the person's left and right hand in the order of
        `HAND_LANDMARKS`; NaN: not seen. None where the source sees no hands.

    Raises
    ------
    PoseError
        When a shape, a value or a name breaks the rules above; the message names it.

    """

    landmarks: tuple[str, ...]
    xy: FloatArray
    confidence: FloatArray | None = None
    time: FloatArray
    frame_size: tuple[int, int]
    world: FloatArray | None = None
    hands: FloatArray | None = None

    def __post_init__(self) -> None:
        """Validate, and freeze private copies of the arrays."""
        object.__setattr__(self, "landmarks", _check_names(self.landmarks))
        xy = _freeze(self.xy, "xy")
        count = len(self.landmarks)
        if xy.ndim != 3 or xy.shape[1:] != (count, 2):
            raise PoseError(f"xy has shape {xy.shape}, expected (frames, {count} landmarks, 2)")
        if np.isinf(xy).any():
            raise PoseError("xy holds infinite values; mark what was not seen with NaN")
        time = _freeze(self.time, "time")
        if time.shape != (len(xy),):
            raise PoseError(f"time has shape {time.shape}, expected ({len(xy)},), one per frame")
        if not np.isfinite(time).all():
            raise PoseError("time holds NaN or infinite values")
        if (steps := time[1:] - time[:-1]).size and steps.min() <= 0:
            at = int(np.argmin(steps)) + 1
            raise PoseError(
                f"time does not increase at frame {at} ({time[at - 1]:g} s, then {time[at]:g} s)"
            )
        object.__setattr__(self, "xy", xy)
        object.__setattr__(self, "time", time)
        object.__setattr__(self, "frame_size", _check_size(self.frame_size))
        for name, shape in (
            ("confidence", xy.shape[:2]),
            ("world", (*xy.shape[:2], 3)),
            ("hands", (len(xy), *HANDS_SHAPE)),
        ):
            object.__setattr__(self, name, _freeze_optional(getattr(self, name), name, shape))
        if not (self.confidence is None or ((self.confidence >= 0) & (self.confidence <= 1)).all()):
            raise PoseError("confidence holds values outside [0, 1]")

    def __len__(self) -> int:
        """Count the frames, T."""
        return len(self.time)

    def __eq__(self, other: object) -> bool:
        """Return whether two pose sequences hold the same values; NaN equals NaN."""
        if not isinstance(other, PoseSequence):
            return NotImplemented
        return (
            self.landmarks == other.landmarks
            and self.frame_size == other.frame_size
            and all(_same_values(getattr(self, name), getattr(other, name)) for name in ARRAYS)
        )

    __hash__ = None  # type: ignore[assignment]  # arrays inside: equality without a hash

    @property
    def duration(self) -> float:
        """Seconds from the first to the last frame; 0 for fewer than two frames."""
        return float(self.time[-1] - self.time[0]) if len(self) > 1 else 0.0

    @cached_property
    def seen(self) -> npt.NDArray[np.bool_]:
        """``(T, K)``: which landmark was found in which frame."""
        seen = _all_finite(self.xy)
        seen.setflags(write=False)
        return seen

    def column(self, name: str) -> FloatArray:
        """Return one landmark's path.

        Returns
        -------
        ``(T, 2)`` pixels, NaN where not seen.

        Raises
        ------
        PoseError
            When the recording has no landmark of that name.

        """
        if name not in self.landmarks:
            raise PoseError(f"no landmark {name!r} in this recording; it has {self.landmarks}")
        return self.xy[:, self.landmarks.index(name)]

    def select(self, names: Sequence[str]) -> PoseSequence:
        """Keep the named landmarks, in the order given.

        Raises
        ------
        PoseError
            When a name is not among the recording's landmarks.

        """
        columns = find_columns(names, self.landmarks, "recording")
        return replace(
            self,
            landmarks=tuple(names),
            **self._cut(("xy", "confidence", "world"), np.s_[:, columns]),
        )

    def between(self, start: float, end: float) -> PoseSequence:
        """Keep the frames with ``start <= time <= end`` (seconds, as in `time`)."""
        return replace(self, **self._cut(ARRAYS, (self.time >= start) & (self.time <= end)))

    def _cut(self, names: Sequence[str], at: Any) -> dict[str, Any]:
        """Return a part of the named arrays, but of those that are None."""
        return {name: array[at] for name in names if (array := getattr(self, name)) is not None}

    def torso_centre(self) -> FloatArray | None:
        """Return the middle of the torso: the mean of mid-shoulders and mid-hips.

        In a frame where one of the pairs is not seen, the other one is carried over by the
        median torso vector; frames in which neither is seen are interpolated in time.

        Returns
        -------
        ``(T, 2)`` pixels without NaN, or None when no frame shows shoulders.

        """
        return self._torso_centre

    def torso_length(self) -> float | None:
        """Return the distance from mid-shoulders to mid-hips, the median over the recording.

        The median of the whole recording, not a value per frame: a body does not change its
        size while it gestures, the detector's error does. Where hips are never seen together
        with shoulders, it is estimated from the shoulder width (`SHOULDER_WIDTHS_PER_TORSO`).

        Returns
        -------
        Pixels, or None when no frame shows both shoulders.

        """
        return self._torso_length

    @cached_property
    def _torso_centre(self) -> FloatArray | None:
        shoulders, hips = self._middle(SHOULDERS), self._middle(HIPS)
        if not np.isfinite(shoulders).any():
            return None
        torso = hips - shoulders
        both = _all_finite(torso)
        half = np.median(torso[both], axis=0) / 2 if both.any() else np.zeros(2)
        centre = np.where(both[:, None], (shoulders + hips) / 2, shoulders + half)
        centre = np.where(np.isfinite(centre), centre, hips - half)
        centre = fill_all_gaps(centre[:, None], self.time)[:, 0]
        centre.setflags(write=False)
        return centre

    @cached_property
    def _torso_length(self) -> float | None:
        lengths = np.linalg.norm(self._middle(HIPS) - self._middle(SHOULDERS), axis=1)
        if not np.isfinite(lengths).any():
            if not set(SHOULDERS) <= set(self.landmarks):
                return None
            left, right = (self.column(name) for name in SHOULDERS)
            lengths = SHOULDER_WIDTHS_PER_TORSO * np.linalg.norm(left - right, axis=1)
            if not np.isfinite(lengths).any():
                return None
        length = float(np.nanmedian(lengths))
        return length if length > 0 else None

    def _middle(self, pair: tuple[str, str]) -> FloatArray:
        """``(T, 2)`` middle of two landmarks; all NaN where the set lacks one of them."""
        if not set(pair) <= set(self.landmarks):
            return np.full((len(self), 2), np.nan)
        return (self.column(pair[0]) + self.column(pair[1])) / 2


def find_columns(names: Sequence[str], landmarks: Sequence[str], what: str) -> list[int]:
    """Return the indices of `names` in `landmarks`.

    Raises
    ------
    PoseError
        When a name is missing; `what` is the owner of the landmarks in the message.

    """
    missing = [name for name in names if name not in landmarks]
    if missing:
        raise PoseError(f"no landmarks {missing} in this {what}; it has {landmarks}")
    return [landmarks.index(name) for name in names]


def join_sequences(moments: Sequence[PoseSequence]) -> PoseSequence:
    """Concatenate the parts of a stream to one pose sequence.

    Parameters
    ----------
    moments
        At least one part, in order, with the same landmarks and frame size. Confidence is kept
        only if all of them have it; world landmarks and hands of a part without them are NaN.

    Raises
    ------
    PoseError
        When the time does not increase from one part to the next.

    """
    known = [each.confidence for each in moments if each.confidence is not None]
    return replace(
        moments[0],
        xy=np.concatenate([each.xy for each in moments]),
        confidence=np.concatenate(known) if len(known) == len(moments) else None,
        time=np.concatenate([each.time for each in moments]),
        world=_join_optional(
            [each.world for each in moments], [(*each.xy.shape[:2], 3) for each in moments]
        ),
        hands=_join_optional(
            [each.hands for each in moments], [(len(each), *HANDS_SHAPE) for each in moments]
        ),
    )


def _join_optional(
    parts: Sequence[FloatArray | None], shapes: Sequence[tuple[int, ...]]
) -> FloatArray | None:
    """Concatenate arrays, NaN of the given shape for those that are None; None if all are."""
    if all(each is None for each in parts):
        return None
    return np.concatenate(
        [
            np.full(shape, np.nan) if each is None else each
            for each, shape in zip(parts, shapes, strict=True)
        ]
    )


def _check_names(names: Any) -> tuple[str, ...]:
    if not isinstance(names, str):
        # TypeError: not a collection, or with entries that are not hashable.
        with suppress(TypeError):
            return _check_distinct(tuple(names))
    raise PoseError(f"landmarks must be non-empty names, got {names!r}")


@lru_cache(maxsize=16)  # every frame of a stream comes with the same ones
def _check_distinct(names: tuple[Any, ...]) -> tuple[str, ...]:
    if not all(isinstance(name, str) and name for name in names):
        raise PoseError(f"landmarks must be non-empty names, got {names!r}")
    if not names:
        raise PoseError("landmarks is empty; at least one name is needed")
    if len(set(names)) < len(names):
        twice = sorted({name for name in names if names.count(name) > 1})
        raise PoseError(f"landmark names occur twice: {twice}")
    return names


def _freeze(values: Any, name: str) -> FloatArray:
    try:
        array = np.array(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise PoseError(f"{name} is not an array of numbers: {error}") from error
    array.setflags(write=False)
    return array


def _freeze_optional(values: Any, name: str, shape: tuple[int, ...]) -> FloatArray | None:
    if values is None:
        return None
    array = _freeze(values, name)
    if array.shape != shape:
        raise PoseError(f"{name} has shape {array.shape}, expected {shape}")
    if np.isinf(array).any():
        raise PoseError(f"{name} holds infinite values; mark what was not seen with NaN")
    return array


def _check_size(size: Any) -> tuple[int, int]:
    if len(size) != 2 or not all(float(side) > 0 for side in size):
        raise PoseError(f"frame_size is {size!r}, expected (width, height) in pixels, both > 0")
    return int(size[0]), int(size[1])


def _same_values(one: FloatArray | None, other: FloatArray | None) -> bool:
    if one is None or other is None:
        return one is other
    return np.array_equal(one, other, equal_nan=True)


def _all_finite(points: FloatArray) -> npt.NDArray[np.bool_]:
    """Return ``(...)``: which of the points ``(..., 2)`` have both coordinates."""
    known = np.isfinite(points)
    return np.asarray(known[..., 0] & known[..., 1], dtype=np.bool_)
