"""Clip source: another program's keypoint file; the video is its drawn skeleton."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

from typing_extensions import Unpack

from app.bags import show_recording
from app.bags.extraction import Reading
from app.bags.video_writer import require_encodable
from app.clip_sources.source import (
    ClipFacts,
    ClipSource,
    OpenFrames,
    ReadOptions,
    RecordedClip,
    Refusal,
    UnsupportedFile,
)
from app.keypoint_files import (
    ENDINGS,
    ReadKeypoints,
    is_keypoint_file,
    is_openpose_archive,
    keypoint_ending,
    read_keypoints,
    stage,
)
from app.recognition.errors import (
    FrameRateError,
    FrameSizeError,
    KeypointFileError,
    OsgError,
    RoundedTimesError,
)
from app.recognition.recording.video_limits import VideoLimits

DRAWN = "there is no picture in this file: the skeleton is drawn"
NO_HANDS = (
    "there are no hands in this file and so no salute: choose the range of a gesture by hand, with "
    "the handles on the timeline"
)
FRAME_RATE_NEEDED = (
    "the file counts frames and has no timestamps; give the frames per second of its video (field "
    "frame_rate, as 30)"
)
ROUNDED_TIMES = (
    "the times are rounded, so that several frames have one; give the frames per second of the "
    "video (field frame_rate, as 30), by which frames are counted instead"
)
FRAME_SIZE_NEEDED = (
    "the file holds fractions of a picture, whose size it does not say; give the size of its "
    "video in pixels (field frame_size, as 1920x1080)"
)


class KeypointFileSource(ClipSource):
    """Keypoint file written by OpenPose, MediaPipe, DeepLabCut or SLEAP."""

    name = "keypoints"
    noun = "a keypoint file"
    formats = "keypoints (CSV, JSON, SLEAP, .pose, or OpenPose's folder as zip)"
    endings = ENDINGS
    folder = "frames of OpenPose (*_keypoints.json)"
    has_pictures = False
    probe_seconds = 120.0
    """Longest time to probe, which must read the whole file to know its content."""
    broken_off = Refusal(
        code="keypoints_unreadable",
        detail="the process that read this keypoint file broke off: the file is damaged, or it "
        "needs more memory or time than a job may use; cut out the part with the gestures",
    )

    def accepts(self, path: Path, topic: str | None = None) -> bool:
        """Return whether a file has the ending of a keypoint file, or holds OpenPose's frames."""
        return topic is None and self.is_take(path)

    def accepts_upload(self, head: bytes, name: str) -> bool:
        """Decide by the first bytes, and for text by the name's ending."""
        return keypoint_ending(head, name) is not None

    def upload_options(self, head: bytes, name: str, options: ReadOptions) -> ReadOptions:
        """Return `options` with the ending by which the file is read."""
        return options.model_copy(update={"ending": keypoint_ending(head, name)})

    def is_take(self, path: Path) -> bool:
        """Return whether it is a keypoint file; OpenPose's folder, or its archive, is one take."""
        return is_keypoint_file(path) or is_openpose_archive(path)

    def probe(self, path: Path, options: ReadOptions) -> ClipFacts:
        """Read all of the file."""
        if options.ending == ".zip" and not is_openpose_archive(path):
            raise UnsupportedFile(
                "the archive holds neither a dive recording (no .mcap and no .db3 file) nor frames "
                "of OpenPose (*_keypoints.json)"
            )
        poses = _read(path, options).recording.poses
        # The skeleton is drawn in pictures of this size.
        VideoLimits().require_pixels(*poses.frame_size)
        require_encodable(*poses.frame_size)
        return ClipFacts(*poses.frame_size, poses.duration, len(poses))

    def record(
        self, path: Path, options: ReadOptions, *, video: Path | None = None, **how: Unpack[Reading]
    ) -> RecordedClip:
        """Read the keypoints, and draw the skeleton if there is a video or an observer."""
        read = _read(path, options)
        recording = read.recording
        show_recording(recording, video, how.get("progress"), how.get("observer"))
        if video is not None:
            recording = replace(
                recording,
                warnings=(DRAWN, *recording.warnings),
                salute_warnings=() if read.has_hands else (NO_HANDS,),
            )
        return RecordedClip(recording, read.has_hands, recording.poses.landmarks)

    def refuse(self, error: OsgError, path: Path) -> Refusal:
        """Return a refusal that names missing values by form field, and not the stored file."""
        match error:
            case RoundedTimesError():
                return Refusal("frame_rate_needed", ROUNDED_TIMES)
            case FrameRateError():
                return Refusal("frame_rate_needed", FRAME_RATE_NEEDED)
            case FrameSizeError():
                return Refusal("frame_size_needed", FRAME_SIZE_NEEDED)
        code = "video_unreadable"
        if isinstance(error, KeypointFileError):
            code = "keypoints_unreadable"
        return Refusal(code, _without_path(str(error), path))

    def playable_video(self, path: Path, options: ReadOptions, copy: Path) -> Path | None:
        """Return None: there are no pictures."""
        return None

    def open_frames(self, path: Path, options: ReadOptions) -> OpenFrames:
        """Refuse: there are no pictures."""
        raise KeypointFileError(
            f"{path} holds keypoints, and a robot looks at pictures; use `osg-studio recognize "
            f"{path}`"
        )


def _read(path: Path, options: ReadOptions) -> ReadKeypoints:
    """Read a file; one that was stored without its name is read by its ending."""
    ending = options.ending or (".zip" if is_openpose_archive(path) else None)
    if ending is None:
        return read_keypoints(path, options.keypoints)
    with stage(path, ending) as place:
        try:
            read = read_keypoints(place, options.keypoints)
        except OsgError as error:
            raise type(error)(_without_path(str(error), place)) from error
        notes = tuple(_without_path(note, place) for note in read.recording.warnings)
    return replace(read, recording=replace(read.recording, warnings=notes))


def _without_path(text: str, place: Path) -> str:
    """Replace the stored file's name, and mention that the named option is of the command line."""
    text = text.replace(f"{place}/", "").replace(str(place), "the file")
    text = text.replace(place.name, "the file")
    note = "(an option of the command line)"
    option = re.search(" --(landmark|keypoints) ", text) and note not in text
    return f"{text} {note}" if option else text
