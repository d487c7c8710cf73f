"""Bag extraction: finds the landmarks in a topic of a dive recording, and writes its video."""

from __future__ import annotations

from contextlib import nullcontext
from pathlib import Path

import cv2
import numpy as np
from typing_extensions import Unpack

from app.bags.bag import open_bag
from app.bags.image_topic import BagFrames
from app.bags.keypoint_topic import even_size, keypoint_recording
from app.bags.video_writer import VideoFile
from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.water import WaterCorrection
from app.recognition.poses.frame import Body, FrameLandmarks, Image
from app.recognition.poses.landmarks import POSE_LANDMARKS, SKELETON
from app.recognition.poses.sequence import FloatArray, PoseSequence
from app.recognition.recording.extraction import Following, Observer, Progress, record_frames
from app.recognition.recording.recording import Recording
from app.recognition.recording.video import FrameSource, Turn, VideoFrame
from app.recognition.recording.video_limits import VideoLimits

BONE = (208, 214, 222)
JOINT = (90, 160, 255)
"""RGB, light on black; the studio draws its own colours over the picture."""

THICKNESS = 1 / 160
"""Thickness of a bone, in heights of the picture: three pixels of 480, visible on a thumbnail."""

_SUBPIXEL = 4
"""Fractional bits of coordinates in OpenCV's drawing, so that movement is smooth."""

_FARTHEST = 2.0
"""Farthest point drawn, in picture sizes beyond the edge: OpenCV counts in 32 bits."""


class Reading(Following, total=False):
    """Keywords of all who read a clip: what finds the landmarks if it has pictures, and the rest.

    See `app.recognition.recording.extraction.record`.
    """

    estimator: PoseEstimator | None


def record_bag(
    path: str | Path,
    topic: str | None = None,
    *,
    video: Path | None = None,
    water: WaterCorrection = "auto",
    turn: Turn = 0,
    **how: Unpack[Reading],
) -> Recording:
    """Find body and hands in a dive recording, as `extraction.record` does in a clip.

    Pictures go directly from the recording to the models; recorded keypoints need no models.

    Parameters
    ----------
    path
        A rosbag2 folder, its one file, or a zip of either.
    topic
        Name of the topic; None for the only usable one.
    video
        Path of a copy for players (`VideoFile`): the same pictures at the same times, or the
        skeleton on black if only keypoints were recorded. None writes no copy.
    water, turn, how
        See `app.recognition.recording.extraction.record`.

    Raises
    ------
    BagError
        When it is no dive recording, is damaged, or has no such topic.
    TopicError
        When several topics are usable and none is named.
    VideoError
        When a limit is exceeded.
    ModelError
        When the default estimator's models are not installed.

    """
    with open_bag(path) as bag:
        chosen = bag.topic(topic)
        if chosen.use == "keypoints":
            recording = keypoint_recording(bag, chosen)
            show_recording(recording, video, how.get("progress"), how.get("observer"))
            return recording
        return record_and_copy(BagFrames(bag, chosen, turn=turn), video, water, **how)


def write_video(path: str | Path, topic: str | None, video: Path, turn: Turn = 0) -> None:
    """Write the copy of a topic for players, without finding landmarks in it.

    See `record_bag`, also for the errors raised.
    """
    with open_bag(path) as bag:
        chosen = bag.topic(topic)
        if chosen.use == "keypoints":
            show_recording(keypoint_recording(bag, chosen), video)
            return
        copy_frames(BagFrames(bag, chosen, turn=turn), video)


def copy_frames(frames: FrameSource, video: Path) -> None:
    """Write the frames of a source as a video for players, without finding landmarks in them."""
    with VideoFile(video, frames.info.width, frames.info.height) as copy:
        for frame in frames:
            copy.add(frame.image, frame.time)


def holds_keypoints(path: str | Path, topic: str | None = None) -> bool:
    """Return whether the topic that `record_bag` takes holds keypoints; raises the same errors."""
    with open_bag(path) as bag:
        return bag.topic(topic).use == "keypoints"


def record_and_copy(
    frames: FrameSource, video: Path | None, water: WaterCorrection, **how: Unpack[Reading]
) -> Recording:
    """Find landmarks in every frame, and copy the frames; see `record_frames` and `VideoFile`.

    With a copy, nothing is kept before the end.
    """
    if video is None:
        return record_frames(frames, water=water, **how)
    observer = how.get("observer")
    with VideoFile(video, frames.info.width, frames.info.height) as copy:

        def observe(frame: VideoFrame, found: FrameLandmarks) -> None:
            copy.add(frame.image, frame.time)
            if observer is not None:
                observer(frame, found)

        how |= {"observer": observe, "keep_so_far": None}
        return record_frames(frames, water=water, **how)


def skeleton_picture(xy: FloatArray, size: tuple[int, int]) -> Image:
    """Draw one frame's body on black.

    Parameters
    ----------
    xy
        ``(33, 2)`` pixels of `POSE_LANDMARKS`, NaN where not seen.
    size
        Width and height in pixels.

    Returns
    -------
    ``(height, width, 3)`` RGB.

    """
    width, height = size
    picture = np.zeros((height, width, 3), dtype=np.uint8)
    thickness = max(2, round(height * THICKNESS))
    limit = _FARTHEST * max(size)
    # The comparison is False for NaN.
    seen = np.asarray((np.abs(xy) < limit).all(axis=1))
    points = np.rint(np.nan_to_num(np.clip(xy, -limit, limit)) * 2**_SUBPIXEL).astype(int)
    for one, other in SKELETON:
        first, second = POSE_LANDMARKS.index(one), POSE_LANDMARKS.index(other)
        if seen[first] and seen[second]:
            ends = tuple(points[first].tolist()), tuple(points[second].tolist())
            cv2.line(picture, *ends, BONE, thickness, cv2.LINE_AA, _SUBPIXEL)
    for point in points[seen].tolist():
        radius = thickness << _SUBPIXEL
        cv2.circle(picture, tuple(point), radius, JOINT, cv2.FILLED, cv2.LINE_AA, _SUBPIXEL)
    return picture


def show_recording(
    recording: Recording,
    video: Path | None,
    progress: Progress | None = None,
    observer: Observer | None = None,
) -> None:
    """Draw a recording's frames one by one, if there is a video or an observer.

    Parameters
    ----------
    recording
        Recording of any landmarks; those of `POSE_LANDMARKS` are drawn.
    video
        Path of the video (`VideoFile`); None writes none.
    progress, observer
        See `app.recognition.recording.extraction.record`.

    Raises
    ------
    VideoError
        When its pictures exceed the largest size of a clip.

    """
    poses = recording.poses
    if video is None and observer is None:
        return
    size = even_size(poses.frame_size)
    VideoLimits().require_pixels(*size)
    xy, confidence = _whole_body(poses)
    with nullcontext() if video is None else VideoFile(video, *size) as file:
        for index, time in enumerate(poses.time.tolist()):
            image = skeleton_picture(xy[index], size)
            if file is not None:
                file.add(image, time)
            if observer is not None:
                seen = bool(np.isfinite(xy[index]).any())
                body = Body(xy[index], confidence[index], 1.0) if seen else None
                frame = VideoFrame(index, time, image)
                observer(frame, FrameLandmarks(body, recording.hands[index]))
            if progress is not None:
                progress(index + 1, len(poses))


def _whole_body(poses: PoseSequence) -> tuple[FloatArray, FloatArray]:
    """Return ``(T, 33, 2)`` and ``(T, 33)`` of `POSE_LANDMARKS`; missing ones count as not seen."""
    xy = np.full((len(poses), len(POSE_LANDMARKS), 2), np.nan)
    confidence = np.zeros(xy.shape[:2])
    known = [name for name in poses.landmarks if name in POSE_LANDMARKS]
    rows = [poses.landmarks.index(name) for name in known]
    places = [POSE_LANDMARKS.index(name) for name in known]
    xy[:, places] = poses.xy[:, rows]
    given = poses.seen if poses.confidence is None else poses.confidence
    confidence[:, places] = given[:, rows]
    return xy, confidence
