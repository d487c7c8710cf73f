"""Skeleton video: draws a landmark recording on black, frame by frame."""

from __future__ import annotations

from contextlib import nullcontext
from pathlib import Path

import cv2
import numpy as np

from app.bags.keypoint_topic import even_size
from app.bags.video_writer import VideoFile
from app.recognition.poses.frame import Body, FrameLandmarks, Image
from app.recognition.poses.landmarks import POSE_LANDMARKS, SKELETON
from app.recognition.poses.sequence import FloatArray, PoseSequence
from app.recognition.recording.extraction import Observer, Progress
from app.recognition.recording.recording import Recording
from app.recognition.recording.video import VideoFrame
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
