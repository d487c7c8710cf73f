"""Keypoint table: the content of a keypoint file in its own names and units."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

from app.recognition.errors import KeypointFileError
from app.recognition.poses.frame import Hand
from app.recognition.poses.sequence import FloatArray

LARGEST_FRACTION = 3.0
"""Coordinates of which nearly all are below this are fractions of the picture: landmarks beyond its
edge lie one or two pictures away, and a body of three pixels shows no gesture."""

MOST_NEGATIVE = 0.25
"""Share of the coordinates that may lie left of or above the picture: of a body in it an arm or the
legs are outside. MediaPipe's world landmarks, metres from the hips, are negative by half."""

FALLBACK_RATE = 30.0
"""Frames per second of most cameras."""

MALFORMED = (
    ValueError,
    TypeError,
    KeyError,
    IndexError,
    AttributeError,
    OverflowError,
    RecursionError,
)
"""What reading raises where something else stands than expected, or numbers beyond all bounds."""

NEARLY_ALL = 95.0
"""Per cent; a few landmarks are always lost far outside."""


@dataclass(frozen=True)
class KeypointOptions:
    """Values that a keypoint file may lack, given by the user.

    Attributes
    ----------
    frame_rate
        Frames per second of the video, for files that count frames.
    frame_size
        Width and height of the video in pixels, for files with fractions of it.
    landmarks
        What the file calls a keypoint, and what it is here: a name of `POSE_LANDMARKS` or any
        other name to keep it under. Names that are known anyway need not be given.

    Raises
    ------
    KeypointFileError
        When a rate or a size cannot be one.

    """

    frame_rate: float | None = None
    frame_size: tuple[int, int] | None = None
    landmarks: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))

    @property
    def nominal_rate(self) -> float:
        """Frames per second to follow people by, before a rate is asked for."""
        return self.frame_rate or FALLBACK_RATE

    def __post_init__(self) -> None:
        """Refuse what is no rate and no size."""
        if self.frame_rate is not None and not 0 < self.frame_rate < np.inf:
            raise KeypointFileError(
                f"the frame rate is {self.frame_rate:g}; give the video's frames per second, as 30"
            )
        if self.frame_size is not None and min(self.frame_size) < 1:
            raise KeypointFileError(
                f"the frame size is {self.frame_size}; give width and height of the video in pixels"
            )


@dataclass(frozen=True, eq=False)
class Times:
    """When the frames of a file are.

    Attributes
    ----------
    values
        ``(T,)`` increasing: seconds, or the numbers of the frames.
    counted
        Whether they are numbers of frames.

    Raises
    ------
    KeypointFileError
        When they do not increase.

    """

    values: FloatArray
    counted: bool

    def __post_init__(self) -> None:
        """Refuse frames out of order: they are of two recordings, or sorted by something else."""
        late = np.concatenate([[False], np.diff(self.values) <= 0])
        wrong = np.flatnonzero(late | ~np.isfinite(self.values))
        if len(wrong):
            at = int(wrong[0])
            raise KeypointFileError(
                f"time does not go on at frame {at + 1} of the file, which is at "
                f"{self.values[at]:g}; sort the frames, and keep one recording in a file"
            )


@dataclass(frozen=True, eq=False, kw_only=True)
class KeypointTable:
    """One person's keypoints in T frames.

    Attributes
    ----------
    names
        K names, as the file calls them.
    xy
        ``(T, K, 2)``, x right, y down, pixels or fractions of the picture; NaN: not seen.
    confidence
        ``(T, K)`` in [0, 1]; None where the file has none.
    times
        When the frames are.
    frame_size
        Width and height of the picture in pixels; None where the file does not say.
    frame_rate
        Frames per second; None where the file does not say.
    hands
        T tuples of hands, in the unit of `xy`; None where the file has no hands at all.
    notes
        What the user should know, in sentences.

    """

    names: tuple[str, ...]
    xy: FloatArray
    times: Times
    confidence: FloatArray | None = None
    frame_size: tuple[int, int] | None = None
    frame_rate: float | None = None
    hands: tuple[tuple[Hand, ...], ...] | None = None
    notes: tuple[str, ...] = ()

    @property
    def around_zero(self) -> bool:
        """Whether coordinates lie around 0, and so neither in a picture nor beside it."""
        known = self.xy[np.isfinite(self.xy)]
        return bool((known < 0).mean() > MOST_NEGATIVE) if len(known) else False

    @property
    def in_fractions(self) -> bool:
        """Whether coordinates are fractions of the picture and not pixels."""
        known = np.abs(self.xy[np.isfinite(self.xy)])
        return bool(len(known)) and float(np.percentile(known, NEARLY_ALL)) <= LARGEST_FRACTION


def mask_unseen(xy: FloatArray, confidence: FloatArray | None, least: float) -> FloatArray:
    """Return keypoints ``(..., 2)`` with NaN for those of less than the `least` confidence."""
    known = np.asarray(np.isfinite(xy).all(axis=-1))
    if confidence is not None:
        known &= confidence >= least
        known &= confidence > 0
    return np.where(known[..., None], xy, np.nan)


def visibility_of(points: FloatArray) -> FloatArray:
    """Return how well points ``(..., 3)`` of x, y and visibility are seen, in [0, 1].

    A point whose visibility is unknown is seen where it has a place.
    """
    has_place = np.asarray(np.isfinite(points[..., :2]).all(axis=-1))
    visibility = np.where(np.isnan(points[..., 2]), 1.0, np.clip(points[..., 2], 0, 1))
    return np.where(has_place, visibility, 0.0)
