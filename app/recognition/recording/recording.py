"""Recordings: the landmarks of body and hands and the salute scores of a clip, with their file.

`place_hands` tells a person's left hand from the right one by the wrists of the body. `find_unseen`
and `find_missable` find the spans in which a trigger may have been missed, and `tell_clock` tells
what is odd about a clock. One rule holds for takes of every source: a take has a label only if no
trigger can have been missed in it. Between two missed triggers lies the way from one gesture to the
next, which may look like a third one.
"""

from __future__ import annotations

import math
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from app.recognition.errors import PoseError
from app.recognition.poses.frame import SIDES, Hand
from app.recognition.poses.landmarks import HAND_LANDMARKS, WRISTS
from app.recognition.poses.sequence import HANDS_SHAPE, FloatArray, PoseSequence
from app.recognition.recording.salute import HOLD_SECONDS, SHORTEST_TAKE
from app.recognition.recording.trimming import SETTING_OUT, Span
from app.recognition.text.atomic_files import PRIVATE, replace_file
from app.recognition.triggers.trigger import SALUTE, Trigger

LONGER_HELD: Final = 0.4
"""Seconds by which divers hold a trigger longer than it must be held, at least: their shortest
salute lasts 0.7 s (`docs/robots/on-the-boat.md`)."""

UNUSUAL: Final = 3.0
"""How many times the usual step a longer one is to be told as a hole: a dropped frame is not."""

CRAMMED: Final = 1 / 300
"""Seconds between two frames below which they are no camera's: action cameras film 240 a second."""


def find_unseen(
    moments: Sequence[float], start: float, end: float, hold: float = HOLD_SECONDS
) -> tuple[Span, ...]:
    """Find the spans from `start` to `end` in which a trigger may have been missed.

    A trigger that is missed lies between two neighbouring frames that show none. Fingers need time
    to form it and to open: `SETTING_OUT` for both.

    Parameters
    ----------
    moments
        Seconds of the frames that show no trigger, increasing; those outside do not count.
    start, end
        Seconds between which a trigger would count.
    hold
        Seconds that the trigger must be held.

    """
    inside = [start, *(each for each in moments if start < each < end), end]
    least = hold + LONGER_HELD + SETTING_OUT - 1e-9
    return tuple(Span(a, b) for a, b in pairwise(inside) if b - a >= least)


def find_missable(
    moments: Sequence[float], start: float, end: float, hold: float = HOLD_SECONDS
) -> tuple[Span, ...]:
    """Find the same in a take; a trigger nearer to its own ones continues these (`TakeMachine`)."""
    return find_unseen(moments, start + SHORTEST_TAKE, end - SHORTEST_TAKE, hold)


def describe_unseen(unseen: Sequence[Span], noun: str) -> str:
    """Return why a take has no label; `noun` is what may have been missed."""
    return f"too little was seen {_name_spans(unseen)}: a {noun} may have been missed there"


def _name_spans(spans: Sequence[Span]) -> str:
    return " and ".join(f"from {each.start:.2f} to {each.end:.2f} s" for each in spans[:2])


def find_pauses(time: FloatArray) -> tuple[str, ...]:
    """Return a sentence about steps of a stroke that are long, and too short to hide a trigger."""
    steps = np.diff(time)
    long = np.flatnonzero((steps > HOLD_SECONDS) & (steps > UNUSUAL * np.median(steps)))
    if not len(long):
        return ()
    spans = [Span(float(time[at]), float(time[at + 1])) for at in long.tolist()]
    return (f"no frame {_name_spans(spans)}: the path between is a straight line",)


def find_holes(time: FloatArray) -> tuple[Span, ...]:
    """Find the spans without a frame in which a trigger may have been missed.

    Parameters
    ----------
    time
        ``(T,)`` seconds, increasing; each step is compared with the usual one.

    """
    if len(time) < 2:
        return ()
    usual = float(np.median(np.diff(time)))
    found = find_unseen(time.tolist(), float(time[0]), float(time[-1]))
    return tuple(each for each in found if each.end - each.start > UNUSUAL * usual)


def tell_clock(time: FloatArray) -> Iterator[str]:
    """Yield a sentence about each thing that is odd about the times of a recording's frames.

    Parameters
    ----------
    time
        As for `find_holes`.

    """
    steps = np.diff(time)
    crammed, holes = steps[steps < CRAMMED], find_holes(time)
    if len(crammed) > 2:
        yield (
            f"{len(crammed) + 1} of {len(time)} frames are crammed together, "
            f"{1 / np.median(crammed):.0f} a second: their times are not when they were filmed; "
            "write true times, or for keypoints without times give --frame-rate"
        )
    if holes:
        longest = max(holes, key=lambda each: each.end - each.start)
        more = f", the longest of {len(holes)} holes" if len(holes) > 1 else ""
        # A shorter one within a short take is too near to its own salutes to hide others.
        sure = longest.end - longest.start > 2 * SHORTEST_TAKE + 1
        then = "no gesture is read across it" if sure else "a salute may have been missed"
        yield f"no frame from {longest.start:.2f} to {longest.end:.2f} s{more}: {then}"
    elif len(steps) and find_unseen(time.tolist(), float(time[0]), float(time[-1])):
        yield (
            f"{len(steps) / (time[-1] - time[0]):.1f} frames a second are too few: a salute may be "
            "missed between two of them; film at ten and more"
        )


def place_hands(hands: Sequence[Sequence[Hand]], wrists: FloatArray) -> FloatArray | None:
    """Return the hands of all frames by the person's side.

    A hand belongs to the wrist that it is nearest to: the hand model guesses the side from the
    shape alone and takes the back of a left hand for the palm of a right one. Two hands at one
    wrist are assigned to both wrists by the least sum of distances. Where a wrist is not seen, the
    model's own side counts; of two hands of one side, the hand with the higher score.

    Parameters
    ----------
    hands
        T frames of at most a few hands.
    wrists
        ``(T, 2, 2)`` pixels of the body's left and right wrist; NaN: not seen.

    Returns
    -------
    ``(T, 2, 21, 2)`` pixels, left and right, NaN where not seen; None where no frame shows a hand.

    """
    if not any(hands):
        return None
    placed = np.full((len(hands), *HANDS_SHAPE), np.nan)
    for frame, found in enumerate(hands):
        for side, hand in _pair(found, wrists[frame]):
            placed[frame, side] = np.where(np.isfinite(hand.xy), hand.xy, np.nan)
    return placed


def _pair(found: Sequence[Hand], wrists: FloatArray) -> list[tuple[int, Hand]]:
    """Return the hands of a frame with the index of their side."""
    if not found:
        return []
    believed = sorted(found, key=lambda hand: -hand.score)[:2]
    far = np.array([np.linalg.norm(wrists - hand.xy[0], axis=1) for hand in believed])
    if not np.isfinite(far).all():
        return [(SIDES.index(hand.side), hand) for hand in reversed(believed)]
    if len(believed) == 1:
        return [(int(far[0].argmin()), believed[0])]
    crossed = far[0, 1] + far[1, 0] < far[0, 0] + far[1, 1]
    return [*enumerate(reversed(believed) if crossed else believed)]


FILE_VERSION = 1
"""Version of the file that `Recording.save` writes; increased when older readers would fail."""

MOST_BYTES = 512 * 1024 * 1024
"""Most memory of a file's arrays: 54,000 frames, the longest clip, of a whole body take 220 MB."""


@dataclass(frozen=True, eq=False)
class Recording:
    """The landmarks that an estimator found in all T frames of a clip.

    Attributes
    ----------
    poses
        The body in every frame; all landmarks NaN where no person was found. They get the hands
        by the person's side where they have none.
    hands
        T tuples: the hands of each frame, the larger first.
    salute
        ``(T,)`` in [0, 1]: score of the best salute in the frame (`best_salute`), 0 without a hand.
    warnings
        Problems of the clip, as sentences with counts; those of its clock (`tell_clock`) are put
        before the given ones.
    salute_warnings
        Those that concern salutes, and no language with another trigger or none.
    people
        ``(T,)`` number of people seen in each frame, whose body is among them; None where it is not
        known, as in files of older versions.

    Raises
    ------
    PoseError
        When the parts do not have the same number of frames, or scores lie outside [0, 1].

    """

    poses: PoseSequence
    hands: tuple[tuple[Hand, ...], ...]
    salute: FloatArray
    warnings: tuple[str, ...] = ()
    people: npt.NDArray[np.int64] | None = None
    salute_warnings: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Validate, and freeze a private copy of the scores."""
        salute = np.array(self.salute, dtype=np.float64)
        frames = len(self.poses)
        if salute.shape != (frames,) or len(self.hands) != frames:
            raise PoseError(
                f"a recording of {frames} poses has {len(self.hands)} frames of hands and "
                f"{salute.shape} salute scores; all must be the same number"
            )
        if not ((salute >= 0) & (salute <= 1)).all():
            raise PoseError("salute scores lie outside [0, 1]")
        if self.people is not None:
            people = np.array(self.people, dtype=np.int64)
            if people.shape != (frames,) or (people < 0).any():
                raise PoseError(
                    f"{people.shape} numbers of people, expected ({frames},), none negative"
                )
            people.setflags(write=False)
            object.__setattr__(self, "people", people)
        # One check of the clock for every source; what a file kept is not told again.
        odd = [each for each in tell_clock(self.poses.time) if each not in self.warnings]
        object.__setattr__(self, "warnings", (*odd, *self.warnings))
        salute.setflags(write=False)
        object.__setattr__(self, "salute", salute)
        if self.poses.hands is None and any(self.hands):
            placed = place_hands(self.hands, _wrists(self.poses))
            object.__setattr__(self, "poses", replace(self.poses, hands=placed))

    def list_warnings(self, trigger: Trigger = SALUTE) -> tuple[str, ...]:
        """Return the warnings that concern a language with this trigger."""
        return self.warnings + (self.salute_warnings if trigger.kind == "salute" else ())

    def save(self, path: str | Path) -> None:
        """Write a compressed NumPy archive atomically.

        The file appears under its name only when it is complete and on the disk.
        """
        found = [hand for frame in self.hands for hand in frame]
        arrays: dict[str, Any] = {
            "version": np.array(FILE_VERSION),
            "landmarks": np.array(self.poses.landmarks, dtype=np.str_),
            "xy": self.poses.xy,
            "time": self.poses.time,
            "frame_size": np.array(self.poses.frame_size),
            "salute": self.salute,
            "hands_per_frame": np.array([len(frame) for frame in self.hands], dtype=np.int64),
            "hand_xy": np.array([hand.xy for hand in found]).reshape(-1, len(HAND_LANDMARKS), 2),
            "hand_is_right": np.array([hand.side == "right" for hand in found], dtype=np.bool_),
            "hand_score": np.array([hand.score for hand in found], dtype=np.float64),
            "warnings": np.array(self.warnings, dtype=np.str_),
            "salute_warnings": np.array(self.salute_warnings, dtype=np.str_),
        }
        if self.poses.confidence is not None:
            arrays["confidence"] = self.poses.confidence
        if self.poses.world is not None:
            arrays["world"] = self.poses.world.astype(np.float32)  # micrometres are enough
        if self.people is not None:
            arrays["people"] = self.people
        with replace_file(Path(path), PRIVATE) as file:
            np.savez_compressed(file, allow_pickle=False, **arrays)

    @classmethod
    def load(cls, path: str | Path) -> Recording:
        """Read a file that `save` wrote.

        Raises
        ------
        PoseError
            When the file is missing, damaged, or of a newer version.

        """
        source = Path(path)
        unpacked_bytes(source)
        with _readable(source), np.load(source, allow_pickle=False) as archive:
            # Unpacks what is asked for, so that an array of an unknown name stays packed.
            return cls._from_arrays(archive)

    @classmethod
    def _from_arrays(cls, arrays: Mapping[str, Any]) -> Recording:
        version = int(arrays["version"])
        if version != FILE_VERSION:
            raise PoseError(
                f"the recording has file version {version}, this program reads {FILE_VERSION}; "
                "extract the clip's poses again, or update the program"
            )
        poses = PoseSequence(
            landmarks=tuple(str(name) for name in arrays["landmarks"]),
            xy=arrays["xy"],
            confidence=arrays.get("confidence"),
            time=arrays["time"],
            frame_size=(int(arrays["frame_size"][0]), int(arrays["frame_size"][1])),
            world=arrays.get("world"),
        )
        found = [
            Hand(xy=xy, side="right" if is_right else "left", score=float(score))
            for xy, is_right, score in zip(
                arrays["hand_xy"], arrays["hand_is_right"], arrays["hand_score"], strict=True
            )
        ]
        ends = np.cumsum(arrays["hands_per_frame"])
        starts = ends - arrays["hands_per_frame"]
        if len(found) != (int(ends[-1]) if len(ends) else 0):
            raise PoseError("the recording's hands do not match its frames; extract it again")
        return cls(
            poses=poses,
            hands=tuple(tuple(found[start:end]) for start, end in zip(starts, ends, strict=True)),
            salute=arrays["salute"],
            warnings=tuple(str(warning) for warning in arrays["warnings"]),
            salute_warnings=tuple(str(warning) for warning in arrays.get("salute_warnings", ())),
            people=arrays.get("people"),
        )


@contextmanager
def _readable(file: Path) -> Iterator[None]:
    """Raise a PoseError that names the file for all that is wrong with it."""
    try:
        yield
    except PoseError:
        raise
    except (OSError, ValueError, KeyError, TypeError, EOFError, zipfile.BadZipFile) as error:
        raise PoseError(
            f"{file.name} is not a readable recording ({error}); extract the clip's poses again"
        ) from error


def unpacked_bytes(file: Path) -> int:
    """Return how much memory the arrays of a recording's file take, by their headers alone.

    Raises
    ------
    PoseError
        When it is more than `MOST_BYTES`, or a header is not as `Recording.save` writes it.

    """
    size = 0
    with _readable(file), zipfile.ZipFile(file) as archive:
        if len(set(archive.namelist())) < len(archive.namelist()):
            raise ValueError("it holds two arrays of one name")
        for info in archive.infolist():
            with archive.open(info) as packed:
                if np.lib.format.read_magic(packed) != (1, 0):
                    raise ValueError(f"{info.filename} has an unknown header")
                shape, _, dtype = np.lib.format.read_array_header_1_0(packed)
            if min(shape, default=0) < 0:
                raise ValueError(f"{info.filename} has the shape {shape}")
            size += math.prod(shape) * dtype.itemsize
            if size > MOST_BYTES:
                raise ValueError(f"it would take more than {MOST_BYTES >> 20} MB of memory")
    return size


def _wrists(poses: PoseSequence) -> FloatArray:
    """Return ``(T, 2, 2)`` the wrists' pixels, NaN where the set of landmarks has none."""
    if not set(WRISTS) <= set(poses.landmarks):
        return np.full((len(poses), 2, 2), np.nan)
    return poses.select(WRISTS).xy
