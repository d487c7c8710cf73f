"""Keypoint file reader: maps names to landmarks, converts to pixels and seconds.

Each format limits its own size: the file's (`LARGEST_FILE`), that of what it unpacks to
(`MOST_BYTES`), or the number of frames (`VideoLimits`).
"""

from __future__ import annotations

import csv
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from app.keypoint_files.keypoint_table import KeypointOptions, KeypointTable, Times
from app.keypoint_files.registry import find_format
from app.recognition.errors import (
    FrameRateError,
    FrameSizeError,
    KeypointFileError,
    RoundedTimesError,
)
from app.recognition.poses.landmarks import HIPS, SHOULDERS
from app.recognition.poses.sequence import FloatArray, PoseSequence
from app.recognition.poses.skeletons import find_missing_landmarks, translate_landmark
from app.recognition.recording.recording import Recording
from app.recognition.recording.salute import best_salute
from app.recognition.recording.timestamps import FrameClock
from app.recognition.recording.video_limits import VideoLimits
from app.recognition.text.wording import list_some

MOST_NAMED: Final = 20
"""Most keypoints named in a sentence."""


@dataclass(frozen=True, eq=False)
class ReadKeypoints:
    """Landmarks read from a keypoint file.

    Attributes
    ----------
    recording
        The landmarks, and the hands if the file has some.
    has_hands
        Whether the file has hands; without them there is no salute.

    """

    recording: Recording
    has_hands: bool


def read_keypoints(
    path: str | Path,
    options: KeypointOptions | None = None,
    limits: VideoLimits | None = None,
) -> ReadKeypoints:
    """Read one person's keypoints.

    Names are mapped by `translate_landmark` and by the user's own `options.landmarks`; keypoints
    without a counterpart are left out with a warning. Of several people it is the one who
    salutes, or stands out most over the file (`app.recognition.recording.people`).

    Parameters
    ----------
    path
        A folder of OpenPose's JSON; MediaPipe's landmarks as CSV or JSON; DeepLabCut's CSV; SLEAP's
        .slp or analysis .h5 (extra ``keypoints``); pose-format's .pose.
    options
        Values that the file does not contain.
    limits
        Limits of the recording's length.

    Raises
    ------
    KeypointFileError
        When the file cannot be read, or no name in it is known.
    FrameRateError, FrameSizeError
        When neither the file nor `options` give the frame rate or frame size.
    VideoError
        When the recording is longer than the limits.

    """
    source, given = Path(path), options or KeypointOptions()
    allowed = limits or VideoLimits()
    table = _table(source, given, allowed)
    table, rounded = _number_rounded_frames(table, given, source)
    time, clock = _seconds(table, given, source), FrameClock()
    if not table.times.counted:
        time = np.array([clock.seconds(each) for each in time.tolist()])
    allowed.require_seconds(float(time[-1] - time[0]))
    landmarks, columns, notes = _map_names(table.names, given.landmarks, source)
    size = _frame_size(table, given, source)
    scale = np.array(size, dtype=np.float64) if table.in_fractions else np.ones(2)
    poses = PoseSequence(
        landmarks=landmarks,
        xy=table.xy[:, columns] * scale,
        confidence=None if table.confidence is None else table.confidence[:, columns],
        time=time - time[0],
        frame_size=size,
    )
    hands = table.hands or ((),) * len(poses)
    hands = tuple(tuple(replace(hand, xy=hand.xy * scale) for hand in each) for each in hands)
    one = np.asarray(poses.seen.any(axis=1), dtype=np.int64)
    people = one if table.people is None else table.people
    recording = Recording(
        poses=poses,
        hands=hands,
        salute=np.array([best_salute(frame) for frame in hands]),
        warnings=(
            *rounded,
            *table.notes,
            *notes,
            *_gaps(poses, people),
            *(_direction(poses) or _sides(poses)),
            *clock.sentences,
        ),
        people=people,
    )
    return ReadKeypoints(recording, table.hands is not None)


def _table(path: Path, options: KeypointOptions, limits: VideoLimits) -> KeypointTable:
    try:
        table = find_format(path).read(path, options, limits)
    except (UnicodeDecodeError, csv.Error) as error:
        raise KeypointFileError(f"{path} is no text table ({error}); export it again") from error
    table = table.without_far(options.frame_size or table.frame_size)
    if not np.isfinite(table.xy).all(axis=2).any():
        raise KeypointFileError(
            f"{path}: no keypoint is seen in any of {len(table.xy)} frames; is somebody in the "
            f"picture?"
        )
    if table.around_zero:
        raise KeypointFileError(
            f"{path} has coordinates around 0, which are in no picture; give landmarks in pixels "
            f"or fractions of the picture, not MediaPipe's world landmarks nor OpenPose's "
            f"--keypoint_scale 4"
        )
    return table


def _number_rounded_frames(
    table: KeypointTable, options: KeypointOptions, path: Path
) -> tuple[KeypointTable, tuple[str, ...]]:
    """Replace rounded times by numbers of the frames, if the frame rate is given, and tell it."""
    try:
        table.times.require_order(path)
    except RoundedTimesError:
        twice = np.diff(table.times.values) == 0
        if np.array_equal(table.xy[1:][twice], table.xy[:-1][twice], equal_nan=True):
            raise KeypointFileError(
                f"{path}: {twice.sum()} rows stand twice; keep one row a frame"
            ) from None
        if options.frame_rate is None:
            raise
        counted = Times(np.arange(len(table.xy), dtype=np.float64), counted=True)
        told = f"times are rounded, so that frames are counted, {options.frame_rate:g} a second"
        return replace(table, times=counted), (told,)
    return table, ()


def _seconds(table: KeypointTable, options: KeypointOptions, path: Path) -> FloatArray:
    if not table.times.counted:
        return table.times.values
    rate = options.frame_rate or table.frame_rate
    if rate is None:
        raise FrameRateError(
            f"{path} counts frames and has no timestamps; give the video's frame rate, as in "
            f"--frame-rate 30"
        )
    return table.times.values / rate


def _map_names(
    names: tuple[str, ...], given: Mapping[str, str], path: Path
) -> tuple[tuple[str, ...], list[int], tuple[str, ...]]:
    """Return our names, their columns, and sentences about keypoints that were left out."""
    if unknown := [name for name in given if name not in names]:
        raise KeypointFileError(f"{path} has no keypoint {unknown[0]!r}; it has {', '.join(names)}")
    found: dict[str, int] = {}
    dropped = []
    for column, name in enumerate(names):
        landmark = given.get(name) or translate_landmark(name)
        if landmark is None:
            dropped.append(name)
        elif landmark in found:
            raise KeypointFileError(
                f"{path}: {names[found[landmark]]!r} and {name!r} are both {landmark!r}; give one "
                f"of them another name, as in --landmark {name}=other"
            )
        else:
            found[landmark] = column
    if not found:
        raise KeypointFileError(
            f"{path} names no keypoint that is known here: {list_some(names, MOST_NAMED)}; say "
            f"which they are, as in --landmark {names[0]}=right_wrist"
        )
    notes = []
    if dropped:
        notes.append(
            f"left out, for they mean no landmark here: {list_some(dropped, MOST_NAMED)}; keep "
            f"one by --landmark {dropped[0]}=NAME"
        )
    if missing := find_missing_landmarks(found):
        source = "the folder" if path.is_dir() else "the file"
        notes.append(f"{source} gives no {', '.join(missing)}")
    return tuple(found), list(found.values()), tuple(notes)


def _frame_size(table: KeypointTable, options: KeypointOptions, path: Path) -> tuple[int, int]:
    """Return the picture's size; if unknown, the size of the box around keypoints in pixels."""
    size = options.frame_size or table.frame_size
    if size is not None:
        return size
    if table.in_fractions:
        raise FrameSizeError(
            f"{path} holds fractions of the picture, whose size it does not say; give the "
            f"video's size in pixels, as in --frame-size 1920x1080"
        )
    known = table.xy[np.isfinite(table.xy).all(axis=2)]
    width, height = np.maximum(np.ceil(known.max(axis=0)), 1).astype(int).tolist()
    return width, height


def _gaps(poses: PoseSequence, people: npt.NDArray[np.int64]) -> tuple[str, ...]:
    unseen = int((~poses.seen.any(axis=1)).sum())
    who = "that person is not seen" if people.max(initial=0) > 1 else "no person"
    return (f"{who} in {unseen} of {len(poses)} frames",) if unseen else ()


def _direction(poses: PoseSequence) -> tuple[str, ...]:
    """Return a sentence if the body stands on its head all the time, as where y points upwards."""
    ends = [
        [poses.column(name) for name in names if name in poses.landmarks]
        for names in (SHOULDERS, HIPS)
    ]
    if not all(ends):
        return ()
    across, up = (np.mean(ends[1], axis=0) - np.mean(ends[0], axis=0)).T
    known = np.isfinite(up)
    if not known.any() or (up[known] > -np.abs(across[known])).any():
        return ()
    return (
        "the body is upside down in every frame; if y points upwards in this file, write the "
        "picture's height minus y",
    )


def _sides(poses: PoseSequence) -> tuple[str, ...]:
    """Return a sentence if left lies left in every frame, as the viewer's names for a diver do."""
    if not {*SHOULDERS} <= set(poses.landmarks):
        return ()
    across = poses.column(SHOULDERS[0])[:, 0] - poses.column(SHOULDERS[1])[:, 0]
    known = across[np.isfinite(across)]
    if not len(known) or known.max() >= 0:
        return ()
    return (
        "the left shoulder lies left in every frame: the diver's back is seen, or names are given "
        "from the viewer's side, which is the other arm; then swap left and right in the file",
    )
