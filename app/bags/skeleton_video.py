"""Skeleton video: draws a landmark recording on black, frame by frame."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path

import numpy as np

from app.bags.keypoint_topic import pad_to_even
from app.bags.skeleton_image import skeleton_picture
from app.bags.video_writer import VideoFile
from app.recognition.poses.frame import Body, FrameLandmarks
from app.recognition.poses.landmarks import POSE_LANDMARKS
from app.recognition.poses.sequence import FloatArray, PoseSequence
from app.recognition.recording.extraction import Observer, Progress
from app.recognition.recording.recording import Recording
from app.recognition.recording.video import VideoFrame
from app.recognition.recording.video_limits import VideoLimits


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
    size = pad_to_even(poses.frame_size)
    VideoLimits().require_pixels(*size)
    xy, confidence = _whole_body(poses)
    with ExitStack() as open_files:
        file = None
        if video is not None:
            file = open_files.enter_context(VideoFile(video, *size))
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
