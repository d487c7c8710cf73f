"""Bag extraction: finds the landmarks in a topic of a dive recording, and writes its video."""

from __future__ import annotations

from pathlib import Path

from typing_extensions import Unpack

from app.bags.bag import open_bag
from app.bags.image_topic import BagFrames
from app.bags.keypoint_topic import keypoint_recording
from app.bags.skeleton_video import show_recording
from app.bags.video_writer import VideoFile
from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.water import WaterCorrection
from app.recognition.poses.frame import FrameLandmarks
from app.recognition.recording.extraction import Following, record_frames
from app.recognition.recording.recording import Recording
from app.recognition.recording.video import FrameSource, Turn, VideoFrame


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
