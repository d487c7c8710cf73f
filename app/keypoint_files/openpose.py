"""OpenPose reader: a folder written with ``--write_json``, one file a frame with all people in it.

OpenPose's documentation ("Output") describes the files: BODY_25 or COCO (18), x, y and confidence
in sequence, zeros for keypoints not found; with ``--hand`` also 21 keypoints of each hand, in the
order of `HAND_LANDMARKS`.
"""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from app.keypoint_files.keypoint_table import (
    MALFORMED,
    KeypointOptions,
    KeypointTable,
    Times,
    mask_unseen,
)
from app.recognition.errors import KeypointFileError
from app.recognition.poses.frame import SIDES, Hand
from app.recognition.poses.landmarks import HAND_LANDMARKS
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.skeletons import BODY_25, COCO_18, LandmarkSet
from app.recognition.recording.people import Choice, People, SeenPerson
from app.recognition.recording.salute import best_salute
from app.recognition.recording.video_limits import VideoLimits

SETS: Final[dict[int, LandmarkSet]] = {25: BODY_25, 18: COCO_18}
"""Landmark sets by number of keypoints."""

LARGEST_FILE: Final = 4_000_000
"""Bytes of one frame's file; a person with face and hands takes 6 kB."""


@dataclass(frozen=True, eq=False)
class _Person:
    """One person in one frame: body ``(K, 3)``, and for each side a hand ``(21, 3)`` or None."""

    body: FloatArray
    hands: tuple[FloatArray | None, ...]

    @property
    def xy(self) -> FloatArray:
        return mask_unseen(self.body[:, :2], self.body[:, 2], 0.0)


def is_openpose(path: Path) -> bool:
    """Return whether a folder holds frames of OpenPose."""
    return path.is_dir() and bool(_files(path))


def read_openpose(path: Path, options: KeypointOptions, limits: VideoLimits) -> KeypointTable:
    """Read a folder of frames, sorted by the number in their names; see `read_keypoints`."""
    files = _number_files(path)
    limits.require_frames(len(files))
    frames = np.array([number for number, _ in files], dtype=np.float64)
    everybody = [_people(file) for _, file in files]
    sizes = {len(person.body) for people in everybody for person in people}
    if not sizes:
        raise KeypointFileError(f"{path}: nobody is seen in any of {len(files)} frames")
    if len(sizes) > 1:
        raise KeypointFileError(
            f"{path} mixes people of {' and '.join(str(size) for size in sorted(sizes))} keypoints;"
            f" run OpenPose with one model for all frames"
        )
    landmarks = SETS[sizes.pop()]
    choice = _choose_person(everybody, frames / options.nominal_rate)
    followed = [
        None if place is None else people[place]
        for people, place in zip(everybody, choice.index, strict=True)
    ]
    empty = np.full((len(landmarks), 3), np.nan)
    rows = np.stack([empty if one is None else one.body for one in followed])
    kept = [index for index, name in enumerate(landmarks) if name is not None]
    confidence = np.clip(np.nan_to_num(rows[:, kept, 2]), 0, 1)
    sought = any(hand is not None for people in everybody for one in people for hand in one.hands)
    return KeypointTable(
        names=tuple(name for name in landmarks if name is not None),
        xy=mask_unseen(rows[:, kept, :2], confidence, 0.0),
        confidence=confidence,
        times=Times(frames, counted=True),
        hands=tuple(_hands(one) for one in followed) if sought else None,
        notes=choice.notes,
        people=choice.count,
    )


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
        digits = re.search(r"(\d{1,15})\D*$", file.stem)
        if digits is None:
            raise KeypointFileError(
                f"{file.name} has no frame number in its name; OpenPose's files do, as in "
                f"dive_000000000012_keypoints.json"
            )
        number = int(digits[1])
        if number in numbered:
            raise KeypointFileError(
                f"{folder} holds frame {number} twice, {numbered[number].name} and {file.name}; "
                f"keep one clip in a folder"
            )
        numbered[number] = file
    return sorted(numbered.items())


def _people(file: Path) -> list[_Person]:
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


def _person(entry: Any, file: Path) -> _Person:
    body = _points(entry, ("pose_keypoints_2d", "pose_keypoints"), file)
    if body is None or len(body) not in SETS:
        seen = 0 if body is None else len(body)
        raise KeypointFileError(
            f"{file} has a person of {seen} keypoints, needed: 25 (BODY_25) or 18 (COCO)"
        )
    hands = tuple(_points(entry, (f"hand_{side}_keypoints_2d",), file) for side in SIDES)
    if any(hand is not None and len(hand) != len(HAND_LANDMARKS) for hand in hands):
        raise KeypointFileError(f"{file} has a hand without {len(HAND_LANDMARKS)} keypoints")
    return _Person(body, hands)


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


def _choose_person(everybody: list[list[_Person]], times: FloatArray) -> Choice:
    people = People()
    for seen, time in zip(everybody, times.tolist(), strict=True):
        people.add(
            time,
            [
                SeenPerson(one.xy, float(np.nanmean(one.body[:, 2])), best_salute(_hands(one)))
                for one in seen
            ],
        )
    return people.choose()


def _hands(person: _Person | None) -> tuple[Hand, ...]:
    """Return the hands with all keypoints seen, which a salute needs."""
    found = []
    for side, points in zip(SIDES, person.hands if person else (None, None), strict=True):
        if points is None or not np.isfinite(points).all() or not (points[:, 2] > 0).all():
            continue
        found.append(Hand(points[:, :2], side, float(np.clip(points[:, 2].mean(), 0, 1))))
    return tuple(sorted(found, key=lambda hand: -hand.size))
