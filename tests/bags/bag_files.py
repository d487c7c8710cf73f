"""Bags written by rosbags into a test's own folder, as a robot would have recorded them."""

from __future__ import annotations

import shutil
import zipfile
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, Literal

import cv2
import numpy as np
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from app.bags.bag import DEFINITIONS
from app.recognition import Recording
from app.recognition.poses.frame import Image
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.skeletons import SKELETON_2D
from tests.conftest import PROCESSORS, RECORDINGS

START = 1_763_731_234_123_456_789
"""Nanoseconds since 1970 of the first stamp: not a round number, so that rounding shows."""

DELAY = 7_000_000
"""Nanoseconds from a message's stamp to its reception."""

Storage = Literal["mcap", "sqlite3"]

Row = tuple[str, Any, int]
"""Topic, message, and nanoseconds when it was received."""

store = get_typestore(Stores.ROS2_HUMBLE)
for _name, _text in DEFINITIONS.items():
    store.register(get_types_from_msg(_text, _name))


def message(kind: str, *fields: Any) -> Any:
    """Make a message of a type by its fields in order."""
    return store.types[kind](*fields)


def write_bag(folder: Path, rows: Iterable[Row], storage: Storage = "mcap") -> Path:
    """Write a bag, and return its folder."""
    plugin = StoragePlugin.MCAP if storage == "mcap" else StoragePlugin.SQLITE3
    connections: dict[str, Any] = {}
    with Writer(folder, version=9, storage_plugin=plugin) as writer:
        for topic, content, received in rows:
            kind = content.__msgtype__
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=store)
            writer.write(connections[topic], received, store.serialize_cdr(content, kind))
    return folder


def file_of(folder: Path) -> Path:
    """Return the one storage file of a bag."""
    (found,) = (path for path in folder.iterdir() if path.suffix in (".mcap", ".db3"))
    return found


def zipped(folder: Path) -> Path:
    """Pack a bag's folder as a person does, with the folder itself inside."""
    return Path(shutil.make_archive(str(folder), "zip", folder.parent, folder.name))


def zip_of(path: Path, entries: dict[str, bytes]) -> Path:
    """Write a zip with these entries, whatever their names."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in entries.items():
            archive.writestr(name, content)
    return path


def recorded(name: str, folder: Path) -> Path:
    """Write what was found in a sample clip as a bag, and return its file."""
    recording = Recording.load(RECORDINGS / PROCESSORS[0] / f"{name}.npz")
    return file_of(write_bag(folder / name, our_rows(recording)))


def stamps(seconds: FloatArray | list[float]) -> list[int]:
    """Return nanoseconds since 1970 of moments of a clip."""
    return [START + round(second * 1e9) for second in seconds]


def header(stamp: int) -> Any:
    """Return a header with a stamp in nanoseconds; 0: not set."""
    return message(
        "std_msgs/msg/Header",
        message("builtin_interfaces/msg/Time", stamp // 10**9, stamp % 10**9),
        "camera",
    )


def raw(image: Image, encoding: str, stamp: int, padding: int = 0) -> Any:
    """Return a ``sensor_msgs/Image`` of bytes already in `encoding`."""
    height, width = image.shape[:2]
    rows = np.ascontiguousarray(image).view(np.uint8).reshape(height, -1)
    rows = np.pad(rows, ((0, 0), (0, padding)))
    return message(
        "sensor_msgs/msg/Image",
        header(stamp),
        height,
        width,
        encoding,
        0,
        rows.shape[1],
        rows.ravel(),
    )


def compressed(image: Image, ending: str, stamp: int) -> Any:
    """Return a ``sensor_msgs/CompressedImage`` of RGB."""
    options = {".jpg": [cv2.IMWRITE_JPEG_QUALITY, 95], ".png": []}
    _, data = cv2.imencode(ending, image[..., ::-1], options[ending])
    said = {".jpg": "bgr8; jpeg compressed bgr8", ".png": "png"}[ending]
    return message("sensor_msgs/msg/CompressedImage", header(stamp), said, data.ravel())


def published_rows(recording: Recording) -> Iterator[Row]:
    """Return the published port's messages: fractions, upper-case names, a flag."""
    poses = recording.poses
    width, height = poses.frame_size
    moments = stamps(poses.time)
    for stamp, xy, salute in zip(moments, poses.xy, recording.salute, strict=True):
        points = [
            message("keypoints_interfaces/msg/PoseKeypoints", name.upper(), x / width, y / height)
            for name, (x, y) in zip(poses.landmarks, xy.tolist(), strict=True)
        ]
        body = message("keypoints_interfaces/msg/PoseKeypointsArray", points)
        yield "/pose_keypoints", body, stamp + DELAY
        yield "/vulcan_salute_detected", message("std_msgs/msg/Bool", salute > 0.5), stamp + DELAY
    info = camera_info(width, height)
    yield "/camera_info", info, moments[-1] + DELAY


def camera_info(width: int, height: int) -> Any:
    """Return a ``sensor_msgs/CameraInfo`` with only the size."""
    region = message("sensor_msgs/msg/RegionOfInterest", 0, 0, 0, 0, False)
    nine, twelve = np.zeros(9), np.zeros(12)
    fields = (header(0), height, width, "", np.zeros(0), nine, nine, twelve, 0, 0, region)
    return message("sensor_msgs/msg/CameraInfo", *fields)


def our_rows(recording: Recording) -> Iterator[Row]:
    """Return our own nodes' messages: pixels, confidences, hands, and the picture's time."""
    poses = recording.poses
    confidence = np.ones(poses.xy.shape[:2]) if poses.confidence is None else poses.confidence
    for index, stamp in enumerate(stamps(poses.time)):
        seen = zip(poses.landmarks, poses.xy[index].tolist(), confidence[index], strict=True)
        points = [
            message("osg_interfaces/msg/Keypoint", name, x, y, float(belief))
            for name, (x, y), belief in seen
        ]
        body = message(
            "osg_interfaces/msg/BodyKeypoints",
            header(stamp),
            "diver",
            *poses.frame_size,
            1.0,
            points,
        )
        yield "/osg/body", body, stamp + DELAY
        salute = float(recording.salute[index])
        hands = message("osg_interfaces/msg/Hands", header(stamp), *poses.frame_size, salute, [])
        yield "/osg/hands", hands, stamp + DELAY


def skeleton_rows(recording: Recording) -> Iterator[Row]:
    """Return ROS4HRI's skeletons; the neck is not seen."""
    poses = recording.poses
    width, height = poses.frame_size
    kind = "hri_msgs/msg/NormalizedPointOfInterest2D"
    for index, stamp in enumerate(stamps(poses.time)):
        points = []
        for name in SKELETON_2D:
            known = name is not None
            x, y = poses.xy[index][poses.landmarks.index(name)] if name else (0.0, 0.0)
            points.append(message(kind, x / width, y / height, float(known)))
        yield (
            "/humans/bodies/diver/skeleton2d",
            message("hri_msgs/msg/Skeleton2D", header(stamp), points),
            stamp + DELAY,
        )
