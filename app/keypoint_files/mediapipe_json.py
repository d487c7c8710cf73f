"""Landmarks as JSON, in the common layouts of MediaPipe, MMPose, AlphaPose and COCO.

A list of frames, or an object with one under ``frames``. A frame is a list of landmarks, or an
object with one under ``landmarks``, ``pose_landmarks`` or ``keypoints``. A landmark is an object
with x and y (and a name), a list ``[x, y, z, visibility]``, or stands under its name.

MMPose writes a frame's people under ``instances``, each with ``keypoints`` and
``keypoint_scores``. COCO's results, which AlphaPose and Detectron write too, are a list of people
with an ``image_id``, each with a flat list of x, y and score. Unnamed keypoints are COCO's where
there are 17, or 133 of a whole body.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np

from app.keypoint_files.column_names import (
    AXES,
    MOST_LANDMARKS,
    plain,
    time_column,
)
from app.keypoint_files.keypoint_table import (
    MALFORMED,
    MOST_PEOPLE,
    KeypointOptions,
    KeypointTable,
    Times,
    hands_of,
)
from app.keypoint_files.mediapipe_table import table_of, times_of
from app.recognition.errors import KeypointFileError, OsgError
from app.recognition.poses.frame import SIDES
from app.recognition.poses.landmarks import HAND_LANDMARKS, POSE_LANDMARKS
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.skeletons import COCO_17
from app.recognition.recording.people import Choice, People, SeenPerson
from app.recognition.recording.video_limits import VideoLimits

LARGEST_FILE: Final = 200_000_000
"""Largest file in bytes; a quarter of an hour of 33 landmarks with all digits takes 150 MB."""

FRAMES: Final = ("frames", "poses", "data", "results", "instance_info", "annotations")
LANDMARKS: Final = ("landmarks", "pose_landmarks", "poseLandmarks", "keypoints", "pose")
"""Keys of the list of frames, and of a frame's landmarks."""

HANDS: Final = ("{side}HandLandmarks", "{side}_hand_landmarks", "{side}_hand")
"""Keys of a frame's hands, as MediaPipe Holistic has them."""

WHOLE_BODY: Final = 133
"""Keypoints of COCO-WholeBody, of which the first 17 are COCO's."""

ORDER: Final = ("x", "y", "z", "v")
"""Order of the numbers in a landmark that is a list; three numbers are x, y and z."""


def read_mediapipe_json(path: Path, options: KeypointOptions, limits: VideoLimits) -> KeypointTable:
    """Read a JSON file of one recording; see `app.keypoint_files.read_keypoints`."""
    if path.stat().st_size > LARGEST_FILE:
        raise KeypointFileError(f"{path} is larger than {LARGEST_FILE // 1_000_000} MB; cut it")
    try:
        content = json.loads(path.read_bytes())
        frames, choice = _frames(content), None
        everybody = _group_people(frames)
        limits.require_frames(len(frames if everybody is None else everybody))
        if everybody is not None:
            frames, choice = _choose_person(everybody, options.nominal_rate)
        rows = [_landmarks(frame) for frame in frames]
        hands = [_hands(frame) for frame in frames]
        about, times = _about(content), _times(frames)
    except OsgError:
        raise
    except MALFORMED as error:
        raise KeypointFileError(
            f"{path} holds no frames of landmarks; expected a list of frames, each a list of "
            "landmarks with x and y, or the results of MMPose, AlphaPose or COCO"
        ) from error
    names = tuple(dict.fromkeys(name for row in rows for name in row))
    if not names or len(names) > MOST_LANDMARKS:
        raise KeypointFileError(
            f"{path} holds {len(names)} landmarks in {len(frames)} frames; expected up to "
            f"{MOST_LANDMARKS}, as in MediaPipe's pose_landmarks"
        )
    unseen = (np.nan, np.nan, np.nan)
    points = np.array([[row.get(name, unseen) for name in names] for row in rows])
    has_visibility = bool(np.isfinite(points[..., 2]).any())
    table = table_of(names, points, has_visibility, times)
    return replace(
        table,
        hands=hands_of(np.array(hands), SIDES),
        frame_size=about.frame_size,
        frame_rate=about.frame_rate,
        notes=() if choice is None else choice.notes,
        people=None if choice is None else choice.count,
    )


def _frames(content: Any) -> list[Any]:
    frames = content
    if isinstance(content, Mapping):
        frames = next((content[key] for key in FRAMES if key in content), None)
    if not isinstance(frames, list):
        raise TypeError(f"no list of frames, but {type(frames).__name__}")
    return frames


def _about(content: Any) -> KeypointOptions:
    """Return size and rate of the video, if the file states them beside the frames."""
    if not isinstance(content, Mapping):
        return KeypointOptions()
    rate, width, height = (content.get(key) for key in ("fps", "width", "height"))
    return KeypointOptions(
        frame_rate=None if rate is None else float(rate),
        frame_size=None if width is None or height is None else (int(width), int(height)),
    )


def _landmarks(frame: Any) -> dict[str, tuple[float, float, float]]:
    """Return x, y and visibility by name; empty if nobody is seen."""
    if isinstance(frame, Mapping):
        frame = next((frame[key] for key in LANDMARKS if key in frame), None)
    if not frame:
        return {}
    if isinstance(frame, Mapping):
        return {str(name): _point(point) for name, point in frame.items()}
    if isinstance(frame[0], list) and frame[0] and isinstance(frame[0][0], (Mapping, list)):
        frame = frame[0]  # MediaPipe Tasks gives a list of people, the highest score first
    found = {}
    unnamed = COCO_17 if len(frame) in (len(COCO_17), WHOLE_BODY) else POSE_LANDMARKS
    for index, point in enumerate(frame):
        named = isinstance(point, Mapping) and point.get("name")
        number = unnamed[index] if index < len(unnamed) else str(index)
        found[str(named) if named else number] = _point(point)
    return found


def _hands(frame: Any) -> list[tuple[float, float]]:
    """Return x and y of the left and the right hand's landmarks; NaN without a whole hand."""
    unseen = [(np.nan, np.nan)] * len(HAND_LANDMARKS)
    points: list[tuple[float, float]] = []
    for side in SIDES:
        keys = [key.format(side=side) for key in HANDS] if isinstance(frame, Mapping) else []
        hand = next((frame[key] for key in keys if key in frame), None)
        if isinstance(hand, list) and len(hand) == len(unseen):
            points += [_point(each)[:2] for each in hand]
        else:
            points += unseen
    return points


def _group_people(frames: list[Any]) -> list[list[Any]] | None:
    """Return the people of each frame; None where a frame holds one person's landmarks."""
    images: dict[str, list[Any]] = {}
    for place, frame in enumerate(frames):
        if not isinstance(frame, Mapping):
            return None
        if "image_id" in frame:
            images.setdefault(str(frame["image_id"]), []).append(frame)
        elif "instances" in frame:
            images[str(place)] = list(frame["instances"])
        else:
            return None
    return list(images.values())


def _choose_person(everybody: list[list[Any]], rate: float) -> tuple[list[Any], Choice]:
    """Return the landmarks in each frame of the person who stands out most, and the choice."""
    people, seen = People(), []
    for place, persons in enumerate(everybody):
        bodies = [_list_points(person) for person in persons]
        bodies = [body for body in bodies if np.isfinite(body).all(axis=1).any()]
        # By score, so that the work for a frame is bounded.
        bodies.sort(key=lambda body: -float(body[:, 2].mean()))
        seen.append(bodies[:MOST_PEOPLE])
        people.add(
            place / rate,
            [SeenPerson(body[:, :2], float(body[:, 2].mean())) for body in seen[-1]],
        )
    choice = people.choose()
    followed = [
        [] if place is None else [(x, y, 0, v) for x, y, v in bodies[place]]
        for bodies, place in zip(seen, choice.index, strict=True)
    ]
    return followed, choice


def _list_points(person: Mapping[str, Any]) -> FloatArray:
    """Return a person's keypoints ``(K, 3)``: x, y and score; NaN and 0: not seen."""
    given = np.array(person["keypoints"], dtype=np.float64)
    points = given.reshape(-1, 3) if given.ndim == 1 else given[:, :2]
    if points.shape[1] == 2:
        scores = np.array(person.get("keypoint_scores", np.ones(len(points))), dtype=np.float64)
        points = np.concatenate([points, scores.reshape(-1, 1)], axis=1)
    hidden = (points[:, 2] <= 0) | (points[:, :2] == 0).all(axis=1)
    return np.where(hidden[:, None], (np.nan, np.nan, 0.0), points)


def _point(point: Any) -> tuple[float, float, float]:
    if isinstance(point, Mapping):
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
