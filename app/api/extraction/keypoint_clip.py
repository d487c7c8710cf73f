"""Reading a keypoint file inside a worker, and telling of it in words of whoever sent it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from app.api.extraction.keypoint_source import KeypointSource
from app.api.extraction.messages import Failed
from app.keypoint_files import placed, read_keypoints
from app.recognition.errors import (
    FrameRateError,
    FrameSizeError,
    KeypointFileError,
    OsgError,
)
from app.recognition.recording.recording import Recording
from app.recognition.recording.video_limits import VideoLimits

DRAWN = "there is no picture in this file: the skeleton is drawn"
NO_HANDS = (
    "there are no hands in this file and so no salute: choose the range of a gesture by hand, with "
    "the handles on the timeline"
)


def read_recording(file: Path, source: KeypointSource) -> Recording | Failed:
    """Read a keypoint file, or tell why it cannot be read."""
    place = file
    try:
        with placed(file, source.ending) as place:
            read = read_keypoints(place, source.options)
        # The skeleton is drawn in pictures of this size.
        VideoLimits().require_pixels(*read.recording.poses.frame_size)
    except OsgError as error:
        return Failed(code=_code(error), detail=_detail(error, place))
    notes = [_in_senders_words(note, place) for note in read.recording.warnings]
    said = [DRAWN] if read.has_hands else [DRAWN, NO_HANDS]
    return replace(read.recording, warnings=(*said, *notes))


def _code(error: OsgError) -> str:
    match error:
        case FrameRateError():
            return "frame_rate_needed"
        case FrameSizeError():
            return "frame_size_needed"
        case KeypointFileError():
            return "keypoints_unreadable"
    return "video_unreadable"


def _detail(error: OsgError, place: Path) -> str:
    match error:
        case FrameRateError():
            return (
                "the file counts frames and tells no time; tell how many frames a second its video "
                "has (field frame_rate, as 30)"
            )
        case FrameSizeError():
            return (
                "the file tells fractions of a picture, whose shape it does not tell; tell the "
                "size of its video in pixels (field frame_size, as 1920x1080)"
            )
    return _in_senders_words(str(error), place)


def _in_senders_words(text: str, place: Path) -> str:
    """Replace our own names of the file, and say whose options are meant."""
    said = text.replace(f"{place}/", "").replace(str(place), "the file")
    said = said.replace(place.name, "the file")
    return f"{said} (an option of the command line)" if " --landmark" in said else said
