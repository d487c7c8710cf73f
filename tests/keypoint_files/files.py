"""Keypoint files as other programs write them, of a recording that is known."""

from __future__ import annotations

import csv
import json
import struct
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from app.recognition.poses.frame import Hand
from app.recognition.poses.landmarks import HIPS, SHOULDERS
from app.recognition.poses.sequence import FloatArray, PoseSequence
from app.recognition.poses.skeletons import BODY_25, COCO_17, LandmarkSet


def write_openpose(
    folder: Path,
    poses: PoseSequence,
    landmarks: LandmarkSet = BODY_25,
    *,
    hands: Sequence[Sequence[Hand]] | None = None,
    others: Sequence[PoseSequence] = (),
    first: int = 0,
) -> Path:
    """Write one file per frame, as ``--write_json`` does; unseen landmarks are zeros."""
    folder.mkdir(exist_ok=True)
    for index in range(len(poses)):
        people = [_person(each, index, landmarks) for each in (*others, poses)]
        for hand in hands[index] if hands else ():
            values = np.column_stack([hand.xy, np.full(21, 0.9)]).ravel().tolist()
            people[-1][f"hand_{hand.side}_keypoints_2d"] = values
        seen = [person for person in people if any(person["pose_keypoints_2d"])]
        content = json.dumps({"version": 1.3, "people": seen})
        (folder / f"dive_{first + index:012d}_keypoints.json").write_text(content)
    return folder


def _person(poses: PoseSequence, index: int, landmarks: LandmarkSet) -> dict[str, Any]:
    values: list[float] = []
    anybody = bool(poses.seen[index].any())
    for at, name in enumerate(landmarks):
        # Of sets with several that have no counterpart, the first one is the neck.
        pair = SHOULDERS if None not in landmarks[:at] else HIPS
        point = _place(poses, index, name, pair) if anybody else None
        values += [0.0, 0.0, 0.0] if point is None else [*point, 0.875]
    return {
        "person_id": [-1],
        "pose_keypoints_2d": values,
        "face_keypoints_2d": [],
        "hand_left_keypoints_2d": [],
        "hand_right_keypoints_2d": [],
    }


def _place(
    poses: PoseSequence, index: int, name: str | None, pair: tuple[str, str]
) -> tuple[float, float] | None:
    """Return the place of a landmark; one without a counterpart here is in the middle of a pair."""
    if name is None:
        if not set(pair) <= set(poses.landmarks):
            return None
        x, y = np.mean([poses.column(each)[index] for each in pair], axis=0).tolist()
        return None if np.isnan(x) else (x, y)
    if name not in poses.landmarks:
        return None
    x, y = poses.column(name)[index].tolist()
    return None if np.isnan(x) else (x, y)


def write_rows(path: Path, rows: Sequence[Sequence[object]]) -> Path:
    """Write a CSV file."""
    with path.open("w", newline="") as file:
        csv.writer(file).writerows(rows)
    return path


def fractions(poses: PoseSequence) -> FloatArray:
    """``(T, K, 2)`` in fractions of the picture."""
    return np.asarray(poses.xy / np.array(poses.frame_size))


def write_numbered(path: Path, poses: PoseSequence, first: int = 0) -> Path:
    """Write numbered columns ``x0,y0,z0,v0,...``, fractions of the picture, without any time."""
    numbers = range(first, first + len(poses.landmarks))
    heads = [f"{axis}{number}" for number in numbers for axis in "xyzv"]
    rows = [
        [value for x, y in moment.tolist() for value in (x, y, -0.1, 0.75)]
        for moment in fractions(poses)
    ]
    return write_rows(path, [heads, *rows])


def write_named(path: Path, poses: PoseSequence) -> Path:
    """Write named columns ``NOSE_x, NOSE_y``, pixels, with a column of milliseconds."""
    heads = [
        "timestamp_ms",
        *(f"{name.upper()}_{axis}" for name in poses.landmarks for axis in "xy"),
    ]
    rows = [
        [round(1000 * time), *moment.ravel().tolist()]
        for time, moment in zip(poses.time.tolist(), poses.xy, strict=True)
    ]
    return write_rows(path, [heads, *rows])


def write_long(path: Path, poses: PoseSequence) -> Path:
    """Write one landmark per row, pixels, with the number of the frame."""
    rows = [
        [index, name, *poses.column(name)[index].tolist(), 0.5]
        for index in range(len(poses))
        for name in poses.landmarks
    ]
    return write_rows(path, [["frame", "landmark", "x", "y", "visibility"], *rows])


def write_deeplabcut(
    path: Path, people: dict[str, PoseSequence], likelihood: FloatArray | None = None
) -> Path:
    """Write predictions; with more than one person the way ``multianimal`` projects do."""
    first = next(iter(people.values()))
    columns = [
        (who, name, axis)
        for who, poses in people.items()
        for name in poses.landmarks
        for axis in ("x", "y", "likelihood")
    ]
    heads = [["scorer", *["DLC_resnet50"] * len(columns)]]
    if len(people) > 1:
        heads.append(["individuals", *(who for who, _, _ in columns)])
    heads.append(["bodyparts", *(name for _, name, _ in columns)])
    heads.append(["coords", *(axis for _, _, axis in columns)])
    rows: list[list[object]] = []
    for index in range(len(first)):
        row: list[object] = [index]
        for poses in people.values():
            belief = np.ones(poses.seen.shape) if likelihood is None else likelihood
            for place, (x, y) in enumerate(poses.xy[index].tolist()):
                row += ["" if np.isnan(x) else x, "" if np.isnan(y) else y, belief[index, place]]
        rows.append(row)
    return write_rows(path, [*heads, *rows])


def renamed(poses: PoseSequence, names: dict[str, str]) -> PoseSequence:
    """Return landmarks under other names."""
    return replace(poses, landmarks=tuple(names.get(name, name) for name in poses.landmarks))


def unseen_frames(poses: PoseSequence) -> list[int]:
    """Return the numbers of the frames that show nobody."""
    return [index for index, seen in enumerate(poses.seen) if not seen.any()]


def sleap_labels(library: Any, people: list[PoseSequence], *, tracked: bool) -> Any:
    """Return predictions as written by SLEAP's own library, with its names for the right side."""
    landmarks, frames = people[0].landmarks, len(people[0])
    skeleton = library.Skeleton(nodes=[name.replace("right_", "R_") for name in landmarks])
    video = library.Video(filename="dive.mp4", open_backend=False)
    tracks = [library.Track(f"diver {number}") for number in range(len(people))]
    labelled = [
        library.LabeledFrame(
            video=video,
            frame_idx=index + 100,
            instances=[
                library.PredictedInstance.from_numpy(
                    each.xy[index],
                    skeleton=skeleton,
                    point_scores=np.full(len(landmarks), 0.8),
                    score=0.9,
                    track=track if tracked else None,
                )
                for each, track in zip(people, tracks, strict=True)
            ],
        )
        for index in range(frames)
    ]
    return library.Labels(labelled)


def write_pose_format(
    path: Path,
    people: Sequence[PoseSequence],
    hands: Sequence[FloatArray | None] = (),
    *,
    version: float = 0.2,
    rate: float = 25.0,
) -> Path:
    """Write a ``.pose`` file as pose-format does, the world landmarks last; unseen are zeros.

    Parameters
    ----------
    path, people
        The file, and who is in it.
    hands
        ``(21, 2)`` of the right hand of everybody in each frame, or None.
    version, rate
        Of the format; frames per second.

    """
    first = people[0]
    names = [name.upper() for name in first.landmarks]
    fingers = [f"FINGER_{number}" for number in range(21)]
    components = {
        "POSE_LANDMARKS": names,
        "RIGHT_HAND_LANDMARKS": fingers,
        "POSE_WORLD_LANDMARKS": names,
    }
    head = struct.pack("<fHHHH", version, *first.frame_size, 0, len(components))
    for name, points in components.items():
        head += _pose_text(name) + _pose_text("XYZC") + struct.pack("<HHH", len(points), 1, 1)
        head += b"".join(map(_pose_text, points)) + struct.pack("<5H", 0, 1, 255, 0, 0)
    counts = (len(first), len(people))
    layout = "<HHH" if version == 0.1 else "<fIH"
    head += struct.pack(layout, round(rate) if version == 0.1 else rate, *counts)
    hand = np.zeros((len(first), len(people), 21, 3))
    for index, xy in enumerate(hands):
        hand[index, :, :, :2] = 0.0 if xy is None else xy
    body = np.zeros((len(first), len(people), len(names), 3))
    body[..., :2] = np.nan_to_num(np.stack([each.xy for each in people], axis=1))
    data = np.concatenate([body, hand, body * 1e-3], axis=2)
    confidence = (data[..., :2] != 0).any(axis=3) * 0.75
    path.write_bytes(head + data.astype("<f4").tobytes() + confidence.astype("<f4").tobytes())
    return path


def _pose_text(text: str) -> bytes:
    return struct.pack("<H", len(text)) + text.encode()


def write_results(path: Path, people: Sequence[PoseSequence], kind: str) -> Path:
    """Write COCO's 17 keypoints of people as MMPose (``mmpose``) or COCO (``coco``) does."""
    frames: list[list[FloatArray]] = [
        [
            np.array([(*(_place(each, index, name, HIPS) or (0.0, 0.0)), 0.9) for name in COCO_17])
            for each in people
        ]
        for index in range(len(people[0]))
    ]
    content: list[dict[str, Any]] = [
        {"image_id": f"{index}.jpg", "keypoints": points.ravel().tolist(), "score": 0.9}
        for index, persons in enumerate(frames)
        for points in persons
    ]
    if kind == "mmpose":
        content = [
            {
                "frame_id": index,
                "instances": [
                    {"keypoints": points[:, :2].tolist(), "keypoint_scores": points[:, 2].tolist()}
                    for points in persons
                ],
            }
            for index, persons in enumerate(frames)
        ]
    path.write_text(json.dumps(content))
    return path


def write_browser(path: Path, poses: PoseSequence) -> Path:
    """Write frames of MediaPipe's own JavaScript."""
    frames = [
        {
            "poseLandmarks": [{"x": x, "y": y, "visibility": 0.9} for x, y in moment.tolist()],
            "leftHandLandmarks": [{"x": x, "y": y} for x, y in moment[:21].tolist()],
        }
        for moment in fractions(poses)
    ]
    path.write_text(json.dumps(frames))
    return path


def write_tracks(path: Path, people: Sequence[PoseSequence], name: str = "track_{}") -> Path:
    """Write SLEAP's analysis as a table: a row a frame and track."""
    landmarks = people[0].landmarks
    heads = [f"{each}.{axis}" for each in landmarks for axis in ("x", "y", "score")]
    rows: list[list[object]] = [["track", "frame_idx", "instance.score", *heads]]
    for frame in range(len(people[0])):
        for number, each in enumerate(people):
            points = np.column_stack([each.xy[frame], np.full(len(landmarks), 0.9)])
            rows.append([name.format(number), frame, 0.9, *points.ravel().tolist()])
    return write_rows(path, rows)


def write_hands(path: Path, poses: PoseSequence, hand: FloatArray, named: str) -> Path:
    """Write numbered columns of the body, and of a left hand in the first three frames.

    `named` is the heading of the hand's landmark ``{0}`` and axis ``{1}``.
    """
    heads = [f"pose_{number}_{axis}" for number in range(33) for axis in ("x", "y", "visibility")]
    heads += [named.format(number, axis) for number in range(21) for axis in "xy"]
    fingers = (hand / np.array(poses.frame_size)).ravel().tolist()
    rows = [
        [value for x, y in moment.tolist() for value in (x, y, 0.9)]
        + (fingers if index < 3 else [""] * 42)
        for index, moment in enumerate(fractions(poses))
    ]
    return write_rows(path, [heads, *rows])
