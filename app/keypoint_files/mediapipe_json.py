"""Landmarks as JSON, in the common layouts of MediaPipe, MMPose, AlphaPose and COCO.

A list of frames, or an object with one under ``frames``. A frame is a list of landmarks, or an
object with one under ``landmarks``, ``pose_landmarks`` or ``keypoints``. A landmark is an object
with x and y (and a name), a list ``[x, y, z, visibility]``, or stands under its name.

MMPose writes a frame's people under ``instances``, each with ``keypoints`` and
``keypoint_scores``. COCO's results, which AlphaPose and Detectron write too, are a list of people
with an ``image_id``, each with a flat list of x, y and score. What keypoints without names are
follows from ``categories``, ``meta_info`` or their count (`app.keypoint_files.keypoint_people`).
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np

from app.keypoint_files.column_names import (
    AXES,
    MOST_LANDMARKS,
    plain,
    time_column,
)
from app.keypoint_files.keypoint_people import (
    Person,
    frame_number,
    is_numbered,
    table_of_people,
)
from app.keypoint_files.keypoint_table import (
    MALFORMED,
    Facts,
    KeypointFormat,
    KeypointOptions,
    KeypointTable,
    Times,
    has_no_zero,
)
from app.keypoint_files.mediapipe_table import times_of
from app.recognition.errors import KeypointFileError, OsgError
from app.recognition.poses.frame import SIDES, Side
from app.recognition.poses.sequence import FloatArray
from app.recognition.recording.video_limits import VideoLimits

LARGEST_FILE: Final = 200_000_000
"""Largest file in bytes; a quarter of an hour of 33 landmarks with all digits takes 150 MB."""

FRAMES: Final = ("frames", "poses", "data", "results", "instance_info", "annotations")
LANDMARKS: Final = ("landmarks", "pose_landmarks", "poseLandmarks", "keypoints", "pose")
"""Keys of the list of frames, and of a frame's landmarks."""

HANDS: Final = ("{side}HandLandmarks", "{side}_hand_landmarks", "{side}_hand", "{side}hand_kpts")
"""Keys of a frame's hands, as MediaPipe and COCO-WholeBody have them."""

ORDER: Final = ("x", "y", "z", "v")
"""Order of the numbers in a landmark that is a list; three numbers are x, y and z."""

DEEP: Final = re.compile(r'("\w*(?:3d|world|position)\w*"):', re.IGNORECASE)
"""Keys of places in space, as Azure Kinect's ``joint_positions``."""

IN_SPACE: Final = (
    "holds places in space, 3D and not of a picture; write the keypoints of the picture, in pixels"
)


def read_mediapipe_json(path: Path, options: KeypointOptions, limits: VideoLimits) -> KeypointTable:
    """Read a JSON file of one recording; see `app.keypoint_files.read_keypoints`."""
    content = _load(path)
    try:
        frames = _frames(content)
        everybody, times = _group(frames, content, limits)
        limits.require_frames(len(everybody))
        parsed = [[_points(each) for each in people] for people in everybody]
        names = tuple(
            dict.fromkeys(name for people in parsed for named, _ in people for name in named)
        )
        hands = [[_hands(each) for each in people] for people in everybody]
        about, called, titles = _about(content)
    except OsgError:
        raise
    except MALFORMED as error:
        raise KeypointFileError(
            f"{path} holds no frames of landmarks; expected a list of frames, each a list of "
            "landmarks with x and y, or the results of MMPose, AlphaPose or COCO"
        ) from error
    if not names or len(names) > MOST_LANDMARKS:
        key = DEEP.search(json.dumps(frames[:100]))
        if key and not names:
            raise KeypointFileError(f"{path}: {key[1]} {IN_SPACE}")
        raise KeypointFileError(
            f"{path} holds {len(names)} landmarks in {len(frames)} frames; expected up to "
            f"{MOST_LANDMARKS}, as in MediaPipe's pose_landmarks"
        )
    people = [
        [
            Person(_ordered(points, named, names), hand)
            for (named, points), hand in zip(*both, strict=True)
            if named or hand
        ]
        for both in zip(parsed, hands, strict=True)
    ]
    given = titles if is_numbered(names) else names
    facts = Facts(frame_size=about.frame_size, frame_rate=about.frame_rate)
    return table_of_people(people, times, path, options, called, given, **facts)


def _load(path: Path) -> Any:
    """Parse the file; the reason why it cannot be is told."""
    size = path.stat().st_size
    if size > LARGEST_FILE:
        raise KeypointFileError(f"{path} is larger than {LARGEST_FILE // 1_000_000} MB; cut it")
    content = path.read_bytes()
    try:
        return json.loads(content)
    except json.JSONDecodeError as error:
        if not content.strip():
            raise KeypointFileError(f"{path} is empty; write it again") from error
        text = error.doc.strip()
        cut = text[-1] not in "]}" or error.pos >= len(error.doc.rstrip())
        if cut and text[0] in "[{":
            raise KeypointFileError(
                f"{path} breaks off at byte {size}, as where a program was stopped while it wrote; "
                "write it again to its end"
            ) from error
        what = "one document a line" if error.msg == "Extra data" else error.msg
        raise KeypointFileError(
            f"{path} is not JSON: {what} at line {error.lineno}, column {error.colno}; write one "
            "list of all frames"
        ) from error
    except MALFORMED as error:
        raise KeypointFileError(f"{path} is no JSON text in UTF-8; export it again") from error


def _frames(content: Any) -> list[Any]:
    frames = content
    if isinstance(content, Mapping):
        frames = next((content[key] for key in FRAMES if key in content), None)
    if not isinstance(frames, list):
        raise TypeError(f"no list of frames, but {type(frames).__name__}")
    return frames


def _about(content: Any) -> tuple[KeypointOptions, str, tuple[str, ...]]:
    """Return size and rate of the video, and what its keypoints are, if the file states them."""
    if not isinstance(content, Mapping):
        return KeypointOptions(), "", ()
    video = next(iter(content.get("images") or []), content)
    rate, width, height = content.get("fps"), video.get("width"), video.get("height")
    options = KeypointOptions(
        frame_rate=None if rate is None else float(rate),
        frame_size=None if width is None or height is None else (int(width), int(height)),
    )
    stated = [content.get("meta_info"), content.get("meta"), *(content.get("categories") or [])]
    about = {
        key: value for each in stated if isinstance(each, Mapping) for key, value in each.items()
    }
    named = about.get("keypoints") or about.get("keypoint_id2name") or []
    if isinstance(named, Mapping):
        named = [named[key] for key in sorted(named, key=int)]
    return options, str(about.get("dataset_name", "")), tuple(map(str, named))


def _find_points(frame: Any) -> Any:
    """Return what a frame states of its points: by name, in a list, or as numbers."""
    given = frame
    if isinstance(frame, Mapping):
        given = next((frame[key] for key in LANDMARKS if key in frame), None)
    if isinstance(given, Mapping) and "keypoints" in given:  # of ml5
        given = given["keypoints"]
    if isinstance(given, Mapping) and isinstance(given.get("x"), list):  # of Ultralytics
        given = [list(each) for each in zip(*(given[axis] for axis in "xy"), strict=True)]
    return given


def _points(frame: Any) -> tuple[tuple[str, ...], FloatArray]:
    """Return the names, else the numbers, and ``(N, 3)`` x, y and visibility of a person.

    No points where nobody is seen.
    """
    given = _find_points(frame)
    if not given:
        return (), np.empty((0, 3))
    if isinstance(given, list) and isinstance(given[0], int | float):
        points = np.array(given, dtype=np.float64).reshape(-1, 3)
        return tuple(map(str, range(len(points)))), points
    if isinstance(given, Mapping):
        names, values = list(given), list(given.values())
    else:
        # MediaPipe Tasks gives a list of people, the highest score first.
        nested = isinstance(given[0], list) and isinstance((given[0] or [0])[0], Mapping | list)
        values = given[0] if nested else given
        names = [
            (isinstance(each, Mapping) and (each.get("name") or each.get("part"))) or place
            for place, each in enumerate(values)
        ]
    points = np.array([_point(each) for each in values], dtype=np.float64).reshape(-1, 3)
    if isinstance(frame, Mapping) and "keypoint_scores" in frame:
        if isinstance(values[0], list) and len(values[0]) > 2:
            raise KeypointFileError(f'"keypoints" {IN_SPACE}')
        points[:, 2] = frame["keypoint_scores"]
    return tuple(map(str, names)), points


def _ordered(points: FloatArray, named: tuple[str, ...], names: tuple[str, ...]) -> FloatArray:
    """Return points ``(K, 3)`` in the order of all names; NaN for those that are not given.

    Numbered ones of a person stay as many as they are.
    """
    if named and is_numbered(names):
        return points
    places = {name: place for place, name in enumerate(names)}
    ordered = np.full((len(names), 3), np.nan)
    ordered[[places[name] for name in named]] = points
    return ordered


def _hands(frame: Any) -> dict[Side, FloatArray]:
    """Return the hands beside a body, each ``(K, 3)``; MediaPipe's have no visibility."""
    found: dict[Side, FloatArray] = {}
    for side in SIDES:
        keys = [key.format(side=side) for key in HANDS] if isinstance(frame, Mapping) else []
        hand = next((frame[key] for key in keys if key in frame), None)
        if isinstance(hand, list) and hand:
            points = _points(hand)[1]
            scored = isinstance(hand[0], int | float)
            found[side] = points if scored else points * (1, 1, np.nan)
    return found


def _group(frames: list[Any], content: Any, limits: VideoLimits) -> tuple[list[list[Any]], Times]:
    """Return the people of each frame, in the order of time, and the times."""
    keys = [set(each) if isinstance(each, Mapping) else set[str]() for each in frames]
    shared = set.intersection(*keys) if keys else set[str]()
    if "image_id" in shared:
        people: dict[int, list[Any]] = {}
        numbers = _number_images(frames, content)
        for frame in frames:
            people.setdefault(numbers[str(frame["image_id"])], []).append(frame)
        wanted = sorted(numbers.values())
        if not (isinstance(content, Mapping) and content.get("images")):
            wanted = _fill(wanted, limits)
        times = Times(np.array(wanted, dtype=np.float64), counted=True)
        return [people.get(number, []) for number in wanted], times
    if "instances" in shared:
        if "frame_id" in shared:
            frames = sorted(frames, key=lambda frame: int(frame["frame_id"]))
        return [list(frame["instances"]) for frame in frames], _times(frames)
    return [frame if _is_people(frame) else [frame] for frame in frames], _times(frames)


def _is_people(frame: Any) -> bool:
    """Return whether a frame is a list of people and not of landmarks."""
    first = frame[0] if isinstance(frame, list) and frame else None
    return isinstance(first, Mapping) and bool({"keypoints", "pose"} & set(first))


def _number_images(frames: list[Any], content: Any) -> dict[str, int]:
    """Return the number of each image by its name, also of those that are known to be empty."""
    named = {str(frame["image_id"]): str(frame["image_id"]) for frame in frames}
    if isinstance(content, Mapping):
        for image in content.get("images") or []:
            told = image.get("frame_id", image.get("file_name", image["id"]))
            named[str(image["id"])] = str(told)
    numbers = {name: frame_number(told) for name, told in named.items()}
    by_number: dict[int | None, str] = {None: ""}
    for name, number in numbers.items():
        if by_number.setdefault(number, name) != name:
            raise KeypointFileError(
                f"the images {by_number[number]!r} and {name!r} tell no order of time; number them "
                "by frame, and keep one recording in a file"
            )
    return {name: number for name, number in numbers.items() if number is not None}


def _fill(numbers: list[int], limits: VideoLimits) -> list[int]:
    """Return the numbers of all frames, also of those without people, which have no entry.

    Frames count from 0 or 1; of a recording that is cut from a long one, from its first.
    """
    step = math.gcd(*(number - numbers[0] for number in numbers)) or 1
    from_start = 1 < numbers[0] < limits.frames
    first = numbers[0] % step if from_start else numbers[0]
    limits.require_frames((numbers[-1] - first) // step + 1)
    return [*range(first, numbers[-1] + 1, step)]


def _point(point: Any) -> tuple[float, float, float]:
    if isinstance(point, Mapping):
        place = point.get("position")  # of PoseNet
        if isinstance(place, Mapping) and "z" not in place:
            point = {**point, **place}
        values = {AXES.get(plain(str(key))): value for key, value in point.items()}
    else:
        values = dict(zip(ORDER, point, strict=False))
    x, y, visibility = (values.get(axis) for axis in ("x", "y", "v"))
    if x is None or y is None:
        return np.nan, np.nan, np.nan
    return float(x), float(y), np.nan if visibility is None else float(visibility)


def _times(frames: list[Any]) -> Times:
    """Return the times of the frames; without any time, their numbers."""
    place, unit = None, "frames"
    keys: list[str] = []
    if frames and all(isinstance(frame, Mapping) for frame in frames):
        keys = [str(key) for key in frames[0]]
        place, unit = time_column(keys)
    if place is None:
        return Times(np.arange(len(frames), dtype=np.float64), counted=True)
    return times_of(np.array([float(frame[keys[place]]) for frame in frames]), unit)


MEDIAPIPE_JSON: Final = KeypointFormat((".json",), has_no_zero, read_mediapipe_json, is_text=True)
