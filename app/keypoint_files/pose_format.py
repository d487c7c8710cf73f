"""Pose-format reader: ``.pose`` files of sign language research, versions 0.1 and 0.2.

The format is that of github.com/sign-language-processing/pose (docs/specs): a header that names
components and their points, then 32-bit numbers of all frames, little endian. Read are the body and
both hands; face and world landmarks are left out.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any, Final

import numpy as np

from app.keypoint_files.keypoint_people import Person, table_of_people
from app.keypoint_files.keypoint_table import (
    MALFORMED,
    MOST_PEOPLE,
    Facts,
    KeypointFormat,
    KeypointOptions,
    KeypointTable,
    Times,
)
from app.recognition.errors import KeypointFileError, OsgError
from app.recognition.poses.frame import SIDES, Side
from app.recognition.poses.landmarks import HAND_LANDMARKS
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.skeletons import translate_landmark
from app.recognition.recording.video_limits import VideoLimits

BEGINNINGS: Final[Mapping[bytes, str]] = {
    struct.pack("<f", 0.1): "<HHH",
    struct.pack("<f", 0.2): "<fIH",
}
"""First bytes of a file, the version, with the layout of rate, number of frames and of people."""

MOST_COMPONENTS: Final = 16
MOST_POINTS: Final = 1000
"""Most points of all components; MediaPipe's with face and world landmarks have 586."""


@dataclass(frozen=True)
class _Component:
    """Points ``[first, first + len(names))`` of a frame."""

    name: str
    names: tuple[str, ...]
    first: int


def read_pose_format(path: Path, options: KeypointOptions, limits: VideoLimits) -> KeypointTable:
    """Read the most prominent person; see `app.keypoint_files.read_keypoints`."""
    try:
        with path.open("rb") as file:
            return _read(file, path, limits)
    except OsgError:
        raise
    except (*MALFORMED, struct.error) as error:
        raise KeypointFileError(
            f"{path} cannot be read as a .pose file of version 0.1 or 0.2: it is damaged or of "
            "another kind; write it again with the newest pose-format"
        ) from error


def _read(file: IO[bytes], path: Path, limits: VideoLimits) -> KeypointTable:
    layout = BEGINNINGS[file.read(4)]
    width, height, _, count = _unpack(file, "<HHHH")
    if not 0 < count <= MOST_COMPONENTS:
        raise ValueError(f"{count} components")
    components, points, values = [], 0, 0
    for _ in range(count):
        name, form = _text(file), _text(file)
        number, limbs, colours = _unpack(file, "<HHH")
        if points + number > MOST_POINTS:
            raise ValueError(f"{points + number} points")
        components.append(_Component(name, tuple(_text(file) for _ in range(number)), points))
        points, values = points + number, max(values, len(form))
        file.seek(4 * limbs + 6 * colours, 1)
    rate, frames, people = _unpack(file, layout)
    if not 0 < people <= MOST_PEOPLE or values < 3 or not points:
        raise ValueError(f"{people} people, {values} values of a point")
    start, row = file.tell(), 4 * people * points
    whole = (path.stat().st_size - start) // (row * values)
    # Version 0.1 counts frames in 16 bits, which may be too few.
    frames = whole if layout == "<HHH" else frames
    if not 0 < frames <= whole:
        raise ValueError(f"{frames} frames, of which {whole} are in the file")
    limits.require_frames(frames)
    body = _find_body(components)
    hands = _find_hands(components)
    wanted = [*range(body.first, body.first + len(body.names))]
    wanted += [hand.first + each for hand in hands.values() for each in range(len(HAND_LANDMARKS))]
    shape = (frames, people, points, values - 1)
    places = np.memmap(file, "<f4", "r", start, shape)[:, :, wanted, :2]
    scores = np.memmap(file, "<f4", "r", start + row * (values - 1) * frames, shape[:3])
    seen = np.concatenate([places, scores[:, :, wanted, None]], axis=3).astype(np.float64)
    seen[..., 2] = np.nan_to_num(seen[..., 2])
    everybody = [[_person(one, len(body.names), tuple(hands)) for one in frame] for frame in seen]
    times = Times(np.arange(frames, dtype=np.float64), counted=True)
    options = KeypointOptions(frame_rate=float(rate) if np.isfinite(rate) and rate > 0 else None)
    size = (width, height) if width and height else None
    facts = Facts(frame_size=size, frame_rate=options.frame_rate)
    return table_of_people(everybody, times, path, options, names=body.names, **facts)


def _person(points: FloatArray, size: int, sides: tuple[Side, ...]) -> Person:
    """Return a person of points ``(K, 3)``: the body's, then those of the hands of these sides."""
    hands = zip(sides, points[size:].reshape(-1, len(HAND_LANDMARKS), 3), strict=True)
    return Person(points[:size], {side: hand for side, hand in hands if hand[:, 2].any()})


def _unpack(file: IO[bytes], layout: str) -> tuple[Any, ...]:
    return struct.unpack(layout, file.read(struct.calcsize(layout)))


def _text(file: IO[bytes]) -> str:
    (length,) = _unpack(file, "<H")
    return file.read(length).decode()


def _find_body(components: list[_Component]) -> _Component:
    """Return the first component with landmarks of a body in the picture."""
    for each in components:
        other = any(word in each.name.lower() for word in ("hand", "face", "world"))
        if not other and any(map(translate_landmark, each.names)):
            return each
    named = ", ".join(each.name[:40] for each in components)
    raise KeypointFileError(f"the .pose file holds no body that is known here, only {named}")


def _find_hands(components: list[_Component]) -> dict[Side, _Component]:
    """Return the components of hands by their sides."""
    return {
        side: each
        for side in SIDES
        for each in components
        if "hand" in each.name.lower()
        and side in each.name.lower()
        and len(each.names) == len(HAND_LANDMARKS)
    }


POSE_FORMAT: Final = KeypointFormat(
    (".pose",), lambda head: head[:4] in BEGINNINGS, read_pose_format
)
