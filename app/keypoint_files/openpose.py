"""OpenPose reader: a folder written with ``--write_json``, one file a frame with all people in it.

OpenPose's documentation ("Output") describes the files: x, y and confidence in sequence, zeros for
keypoints not found; with ``--hand`` also 21 keypoints of each hand, in the order of
`HAND_LANDMARKS`. RTMLib, Pose2Sim and AlphaPose write other sets of keypoints in the same layout.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Final

import numpy as np

from app.keypoint_files.keypoint_people import Person, frame_number, table_of_people
from app.keypoint_files.keypoint_table import (
    MALFORMED,
    KeypointFormat,
    KeypointOptions,
    KeypointTable,
    Times,
)
from app.recognition.errors import KeypointFileError
from app.recognition.poses.frame import SIDES, Side
from app.recognition.poses.landmarks import HAND_LANDMARKS
from app.recognition.poses.sequence import FloatArray
from app.recognition.recording.video_limits import VideoLimits

LARGEST_FILE: Final = 4_000_000
"""Bytes of one frame's file; a person with face and hands takes 6 kB."""


def is_openpose(path: Path) -> bool:
    """Return whether a folder holds frames of OpenPose."""
    return path.is_dir() and bool(_files(path))


def read_openpose(path: Path, options: KeypointOptions, limits: VideoLimits) -> KeypointTable:
    """Read a folder of frames, sorted by the number in their names; see `read_keypoints`."""
    files = _number_files(path)
    limits.require_frames(len(files))
    frames = np.array([number for number, _ in files], dtype=np.float64)
    everybody = [_people(file) for _, file in files]
    return table_of_people(everybody, Times(frames, counted=True), path, options, "openpose")


def _files(folder: Path) -> list[Path]:
    named = sorted(folder.glob("*_keypoints.json"))
    return named or sorted(folder.glob("*.json"))


def _number_files(folder: Path) -> list[tuple[int, Path]]:
    files = _files(folder)
    if not files:
        raise KeypointFileError(
            f"{folder} holds no *_keypoints.json; name the folder that OpenPose wrote to by "
            f"--write_json"
        )
    numbered: dict[int, Path] = {}
    for file in files:
        number = frame_number(file.name)
        if number is None:
            raise KeypointFileError(
                f"{file.name} has no frame number in its name; OpenPose's files do, as in "
                f"dive_000000000012_keypoints.json"
            )
        if number in numbered:
            raise KeypointFileError(
                f"{folder} holds frame {number} twice, {numbered[number].name} and {file.name}; "
                f"keep one clip in a folder"
            )
        numbered[number] = file
    return sorted(numbered.items())


def _people(file: Path) -> list[Person]:
    try:
        if file.stat().st_size > LARGEST_FILE:
            raise KeypointFileError(f"{file} is larger than a frame of OpenPose can be")
        people = json.loads(file.read_bytes())["people"]
        found = [_person(entry, file) for entry in people]
    except KeypointFileError:
        raise
    except MALFORMED as error:
        raise KeypointFileError(
            f"{file} is no frame of OpenPose ({type(error).__name__}: {error}); expected an object "
            f'with "people"'
        ) from error
    return [person for person in found if np.isfinite(person.xy).any()]


def _person(entry: Any, file: Path) -> Person:
    body = _points(entry, ("pose_keypoints_2d", "pose_keypoints"), file)
    if body is None:
        raise KeypointFileError(f"{file} has a person of 0 keypoints; run OpenPose with its body")
    hands: dict[Side, FloatArray] = {}
    for side in SIDES:
        points = _points(entry, (f"hand_{side}_keypoints_2d", f"hand_{side}_keypoints"), file)
        if points is not None and len(points) != len(HAND_LANDMARKS):
            raise KeypointFileError(f"{file} has a hand without {len(HAND_LANDMARKS)} keypoints")
        if points is not None:
            hands[side] = points
    return Person(body, hands)


def _points(entry: Any, keys: tuple[str, ...], file: Path) -> FloatArray | None:
    """Return ``(K, 3)`` x, y, confidence, or None if the file has none."""
    values = next((entry[key] for key in keys if entry.get(key)), None)
    if values is None:
        return None
    numbers = np.array(values, dtype=np.float64)
    if numbers.ndim != 1 or len(numbers) % 3:
        raise KeypointFileError(
            f"{file} has {keys[0]} of {numbers.shape} values, expected x, y, confidence in a row"
        )
    return numbers.reshape(-1, 3)


OPENPOSE: Final = KeypointFormat(
    (".zip",), lambda head: head.startswith(b"PK\x03\x04"), read_openpose
)
"""An archive is unpacked, see `app.keypoint_files.stage`: a folder is read."""
