"""Keypoint table: the content of a keypoint file in its own names and units."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import TypedDict

import numpy as np
import numpy.typing as npt

from app.recognition.errors import KeypointFileError, RoundedTimesError
from app.recognition.poses.frame import Hand, Side
from app.recognition.poses.landmarks import HAND_LANDMARKS
from app.recognition.poses.sequence import FloatArray
from app.recognition.recording.video_limits import VideoLimits

LARGEST_COORDINATE = 1e6
"""Largest coordinate of a keypoint in pixels or millimetres; no camera has as many."""

LARGEST_FRACTION = 3.0
"""Coordinates count as fractions of the picture if most are below this value: landmarks beyond its
edge lie one or two pictures away, and a body of three pixels shows no gesture."""

LARGEST_PICTURE = 4096.0
"""Coordinate in pixels up to which keypoints are in a picture whose size is not known."""

FAR = 10.0
"""How many times the usual coordinate one beyond `LARGEST_PICTURE` is to be in no picture."""

MOST_NEGATIVE = 0.25
"""Largest share of coordinates left of or above the picture: at most an arm or the legs of a body
in it are outside. Half of MediaPipe's world landmarks (metres from the hips) are negative."""

LEAST_SIDE = 16
"""Shortest side of a picture in pixels: thumbnails are larger, and nobody is seen in less."""

FALLBACK_RATE = 30.0
"""Frames per second of most cameras."""

MOST_PEOPLE = 10
"""Most people of a frame that are told apart; of a SLEAP project, in every frame on average."""

MOST_RESTARTS = 3
"""Most times that time goes back in files that are joined; in unsorted ones it does so often."""

MALFORMED = (
    ValueError,
    TypeError,
    KeyError,
    IndexError,
    AttributeError,
    OverflowError,
    RecursionError,
)
"""Errors raised by unexpected content, or by numbers out of bounds."""


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
        Name of each keypoint in the file, with its name here: one of `POSE_LANDMARKS`, or any other
        name to keep it under. Known names need not be given.
    keypoint_set
        Name of the set that keypoints without names are of; None: told by their count and places.

    Raises
    ------
    KeypointFileError
        When a rate is not positive and finite, or a side is shorter than `LEAST_SIDE`.

    """

    frame_rate: float | None = None
    frame_size: tuple[int, int] | None = None
    landmarks: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    keypoint_set: str | None = None

    @property
    def nominal_rate(self) -> float:
        """Frames per second assumed to follow people before the rate is known."""
        return self.frame_rate or FALLBACK_RATE

    def __post_init__(self) -> None:
        """Refuse an impossible rate or size."""
        if self.frame_rate is not None and not 0 < self.frame_rate < np.inf:
            raise KeypointFileError(
                f"the frame rate is {self.frame_rate:g}; give the video's frames per second, as 30"
            )
        for side, name in zip(self.frame_size or (), ("width", "height"), strict=False):
            if side < LEAST_SIDE:
                width, height = self.frame_size or (0, 0)
                raise KeypointFileError(
                    f"the frame size is {width}x{height}, and a {name} of {side} shows no person; "
                    "give width and height of the video in pixels"
                )


@dataclass(frozen=True, eq=False)
class Times:
    """Times of the frames of a file.

    Attributes
    ----------
    values
        ``(T,)`` increasing: seconds, or the numbers of the frames.
    counted
        Whether the values are numbers of frames.
    written
        What stands in the file, for messages; None: the values.

    """

    values: FloatArray
    counted: bool
    written: FloatArray | None = None

    def require_order(self, path: Path) -> None:
        """Refuse times that do not go on.

        Raises
        ------
        RoundedTimesError
            When neighbouring frames have one time: a frame rate can stand in for it.
        KeypointFileError
            When time goes back, or is no number.

        """
        steps = np.diff(self.values)
        wrong = np.flatnonzero(~(np.concatenate([[1.0], steps]) > 0) | ~np.isfinite(self.values))
        if not len(wrong):
            return
        at = int(wrong[0])
        written = self.values if self.written is None else self.written
        before, there = (f"{each:.15g}" for each in written[[max(at - 1, 0), at]].tolist())
        if not np.isfinite(written[at]):
            raise KeypointFileError(
                f"{path}: time does not go on at frame {at + 1}, which has none; write it"
            )
        if (steps >= 0).all() and self.counted:
            raise KeypointFileError(
                f"{path}: frame {there} stands twice; keep one row a frame, of one person"
            )
        if (steps >= 0).all():
            raise RoundedTimesError(
                f"{path}: times are rounded: frames {at} and {at + 1} are both at {there}; write "
                "exact times, or give --frame-rate, as 25, by which frames are counted instead"
            )
        back = int((steps < 0).sum())
        if back <= MOST_RESTARTS:
            raise KeypointFileError(
                f"{path}: time does not go on at frame {at + 1}, but begins again, from {before} "
                f"to {there}: several recordings in one file, or its clock was set back; keep one "
                "recording in a file"
            )
        raise KeypointFileError(
            f"{path}: time does not go on at frame {at + 1}, from {before} to {there}, and goes "
            f"back {back} times; sort the frames"
        )


class Facts(TypedDict, total=False):
    """What a file tells beside its keypoints; see `KeypointTable`."""

    frame_size: tuple[int, int] | None
    frame_rate: float | None
    notes: tuple[str, ...]
    people: npt.NDArray[np.int64] | None


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
        ``(T, K)`` in [0, 1]; None if the file has none.
    times
        Times of the frames.
    frame_size
        Width and height of the picture in pixels; None if the file does not state it.
    frame_rate
        Frames per second; None if the file does not state it.
    hands
        T tuples of hands, in the unit of `xy`; None if the file has no hands at all.
    notes
        Sentences for the user about the file.
    people
        ``(T,)`` number of people seen in each frame; None where the file holds one person.

    """

    names: tuple[str, ...]
    xy: FloatArray
    times: Times
    confidence: FloatArray | None = None
    frame_size: tuple[int, int] | None = None
    frame_rate: float | None = None
    hands: tuple[tuple[Hand, ...], ...] | None = None
    notes: tuple[str, ...] = ()
    people: npt.NDArray[np.int64] | None = None

    def __post_init__(self) -> None:
        """Refuse places that can be of no picture: computing with them would overflow."""
        hands = [hand.xy.ravel() for frame in self.hands or () for hand in frame]
        known = np.concatenate([self.xy.ravel(), *hands])
        largest = np.abs(known[np.isfinite(known)]).max(initial=0.0)
        if largest > LARGEST_COORDINATE:
            raise KeypointFileError(
                f"a keypoint has the coordinate {largest:.3g}, which is in no picture; write "
                "keypoints that were not found as empty cells or NaN"
            )

    @property
    def around_zero(self) -> bool:
        """Whether coordinates lie around 0, and so cannot be of a picture."""
        known = self.xy[np.isfinite(self.xy)]
        return bool((known < 0).mean() > MOST_NEGATIVE) if len(known) else False

    @property
    def in_fractions(self) -> bool:
        """Whether coordinates are fractions of the picture and not pixels."""
        known = np.abs(self.xy[np.isfinite(self.xy)])
        return bool(len(known)) and float(np.median(known)) <= LARGEST_FRACTION

    def without_far(self, size: tuple[int, int] | None) -> KeypointTable:
        """Return the table without places far outside of the picture, where nothing was found.

        Parameters
        ----------
        size
            Width and height of the picture in pixels, if known.

        """
        known = np.abs(self.xy[np.isfinite(self.xy)])
        if not len(known):
            return self
        limit = max(LARGEST_PICTURE, FAR * float(np.median(known)))
        if self.in_fractions or size is not None:
            limit = LARGEST_FRACTION * (1 if self.in_fractions or size is None else max(size))
        beyond = np.abs(self.xy) > limit
        far = beyond[..., 0] | beyond[..., 1]
        if not far.any():
            return self
        note = f"{int(far.sum())} places far outside of the picture count as not seen"
        return replace(
            self, xy=np.where(far[..., None], np.nan, self.xy), notes=(*self.notes, note)
        )


def mask_unseen(xy: FloatArray, confidence: FloatArray | None) -> FloatArray:
    """Return keypoints ``(..., 2)`` with NaN for those without confidence.

    A keypoint at exactly 0, 0 or -1, -1 is none, as at any other number below 0 for both: many
    programs write an unseen one so.
    """
    known = np.asarray(np.isfinite(xy).all(axis=-1)) & (
        (xy > 0).any(axis=-1) | (xy[..., 0] != xy[..., 1])
    )
    if confidence is not None:
        known &= confidence > 0
    return np.where(known[..., None], xy, np.nan)


def visibility_of(points: FloatArray) -> FloatArray:
    """Return the visibility in [0, 1] of points ``(..., 3)`` of x, y and visibility.

    A point of unknown visibility counts as seen if it has coordinates.
    """
    has_place = np.asarray(np.isfinite(points[..., :2]).all(axis=-1))
    visibility = np.where(np.isnan(points[..., 2]), 1.0, np.clip(points[..., 2], 0, 1))
    return np.where(has_place, visibility, 0.0)


def hands_of(points: FloatArray, sides: Sequence[Side]) -> tuple[tuple[Hand, ...], ...] | None:
    """Return the hands of each frame of which all points are seen, as a salute needs them.

    Parameters
    ----------
    points
        ``(T, 21 * len(sides), 3)`` x, y and score, see `visibility_of`.
    sides
        Side of each hand.

    Returns
    -------
    T tuples, the larger hand first, or None if no hand is seen in any frame.

    """
    groups = points.reshape(len(points), len(sides), len(HAND_LANDMARKS), 3)
    scores = visibility_of(groups)
    xy = mask_unseen(groups[..., :2], scores)
    seen = np.isfinite(xy).all(axis=(2, 3)) & (np.ptp(xy, axis=2) > 0).any(axis=2)
    if not seen.any():
        return None
    frames = (
        [
            Hand(xy[row, place], side, float(scores[row, place].mean()))
            for place, side in enumerate(sides)
            if seen[row, place]
        ]
        for row in range(len(groups))
    )
    return tuple(tuple(sorted(hands, key=lambda hand: -hand.size)) for hands in frames)


@dataclass(frozen=True)
class KeypointFormat:
    """A format of keypoint files; `app.keypoint_files.registry` lists all.

    Attributes
    ----------
    endings
        Endings of its files, in lower case; without its name a file gets the first one.
    begins
        Returns whether the first bytes of a file may be of this format.
    read
        Reads a file; see `app.keypoint_files.read_keypoints`.
    is_text
        Whether it has no mark of its kind, so that the name must have one of the endings too.

    """

    endings: tuple[str, ...]
    begins: Callable[[bytes], bool]
    read: Callable[[Path, KeypointOptions, VideoLimits], KeypointTable]
    is_text: bool = False

    def recognises(self, head: bytes, name: str) -> bool:
        """Return whether a file with this name that begins with `head` is of this format."""
        is_named = not self.is_text or name.lower().endswith(self.endings)
        return is_named and self.begins(head)


def has_no_zero(head: bytes) -> bool:
    """Return whether the beginning of a file may be text: it has no zero bytes."""
    return b"\0" not in head
