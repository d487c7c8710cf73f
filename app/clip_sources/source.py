"""Protocol of a clip source: one kind of file or folder that a clip is made of."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Protocol

from pydantic import BaseModel, ConfigDict, Field
from typing_extensions import Unpack

from app.bags.extraction import Reading
from app.bags.topic_summary import TopicSummary
from app.keypoint_files import Ending, KeypointOptions
from app.recognition.errors import OsgError
from app.recognition.estimation.water import WaterCorrection
from app.recognition.recording.recording import Recording
from app.recognition.recording.video import FrameSource, Turn
from app.recognition.recording.video_limits import TAKE, VideoLimits

MADE_VIDEO: Final = "video/mp4"
"""Media type of the video that is written for a clip whose file is no video."""


class UnsupportedFile(OsgError):
    """Raised when a file is not of the kind that its first bytes indicate."""


@dataclass(frozen=True)
class Refusal:
    """Why a received file cannot be used.

    Attributes
    ----------
    code
        Stable word for programs, in snake_case.
    detail
        One line for the person who sent it.

    """

    code: str
    detail: str


class ReadOptions(BaseModel):
    """Options for reading a file: values that the file does not contain.

    Attributes
    ----------
    topic
        Topic of a dive recording; None for the only usable one.
    ending
        Ending by which a keypoint file that was stored without its name is read.
    frame_rate, frame_size, landmarks, keypoint_set
        Values for a keypoint file, see `KeypointOptions`.
    water
        Whether colour and contrast are corrected before landmarks are found.
    turn
        By how much pictures are turned before; players then show a turned copy.
    one_take
        Whether it is one gesture of somebody who was invited, with closer `limits`.
    chapters
        Bytes of each chapter of which the video was joined when it was received; empty for others.

    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    topic: str | None = None
    ending: Ending | None = None
    frame_rate: float | None = None
    frame_size: tuple[int, int] | None = None
    landmarks: dict[str, str] = Field(default_factory=dict)
    keypoint_set: str | None = None
    water: WaterCorrection = "auto"
    turn: Turn = 0
    one_take: bool = False
    chapters: tuple[int, ...] = ()

    @property
    def limits(self) -> VideoLimits:
        """The largest video that is read."""
        return TAKE if self.one_take else VideoLimits()

    @property
    def keypoints(self) -> KeypointOptions:
        """The options of keypoint files.

        Raises
        ------
        KeypointFileError
            When a rate or a size is not positive.

        """
        return KeypointOptions(self.frame_rate, self.frame_size, self.landmarks, self.keypoint_set)


@dataclass(frozen=True)
class ClipFacts:
    """Facts that a file states about its clip, before all of it is read.

    Attributes
    ----------
    width, height
        Pixels of the upright picture.
    duration
        Seconds; None if the container does not state it.
    frames
        Number of frames; None if the container does not state it.
    topics
        Topics of a dive recording to choose from; the other values are those of the first topic.

    """

    width: int
    height: int
    duration: float | None
    frames: int | None
    topics: tuple[TopicSummary, ...] = ()


@dataclass(frozen=True, eq=False)
class RecordedClip:
    """The landmarks read from a clip.

    Attributes
    ----------
    recording
        The landmarks.
    has_hands
        Whether the source can show a hand, and so a salute.
    landmarks
        Names of the landmarks that the source gives.

    """

    recording: Recording
    has_hands: bool
    landmarks: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class OpenFrames:
    """The pictures of a clip, open for reading.

    Attributes
    ----------
    frames
        The pictures, to be iterated once.
    close
        Releases the file; may be called twice.

    """

    frames: FrameSource
    close: Callable[[], None]


class ClipSource(Protocol):
    """One kind of file or folder that becomes a clip.

    Attributes
    ----------
    name
        Stable word for programs; the database and the name of the stored file use it.
    noun
        Noun with its article, for messages: ``a video``.
    formats
        Formats to send, for messages.
    endings
        Endings of the names of these files, in lower case.
    folder
        Mark of a folder of this kind, for messages; None, the default, if it is always a file.
    has_pictures
        Whether a file of this kind may hold pictures of the diver, as most do.
    has_topics
        Whether a clip is made of one of several topics; False by default.
    probe_seconds
        Longest time for `probe`.
    broken_off
        Refusal to return when the process that reads the file dies.

    """

    name: str
    noun: str
    formats: str
    endings: tuple[str, ...]
    folder: str | None = None
    has_pictures: bool = True
    has_topics: bool = False
    probe_seconds: float
    broken_off: Refusal

    def accepts(self, path: Path, topic: str | None = None) -> bool:
        """Return whether the file or folder at `path` is of this kind."""

    def accepts_upload(self, head: bytes, name: str) -> bool:
        """Return whether a received file that begins with `head` may be of this kind."""

    def upload_options(self, head: bytes, name: str, options: ReadOptions) -> ReadOptions:
        """Return `options` with what the first bytes and the name of a received file add.

        By default they add nothing.
        """
        return options

    def media_type(self, head: bytes) -> str:
        """Return the media type of the video that players show; by default, of one made of it."""
        return MADE_VIDEO

    def is_take(self, path: Path) -> bool:
        """Return whether `path`, in a folder of labelled takes, is a take, by its name."""

    def probe(self, path: Path, options: ReadOptions) -> ClipFacts:
        """Read the facts that the file states about its clip.

        Raises
        ------
        UnsupportedFile
            When the file is of another kind.
        OsgError
            When no clip can be made of it.

        """

    def shows_pictures(self, path: Path, options: ReadOptions) -> bool:
        """Return whether landmarks are found in pictures; else the file holds keypoints.

        By default they are wherever files of this kind may hold pictures.
        """
        return self.has_pictures

    def record(
        self, path: Path, options: ReadOptions, *, video: Path | None = None, **how: Unpack[Reading]
    ) -> RecordedClip:
        """Read the landmarks of every frame.

        Parameters
        ----------
        path, options
            The file, and how it is read.
        video
            Path of the video that players show, unless the file itself is that video; None writes
            none.
        how
            The keywords of `Reading`, see `app.recognition.recording.extraction.record`; only
            videos that are shown as they are keep anything before the end.

        Raises
        ------
        OsgError
            When the file cannot be read, or exceeds a limit.
        ModelError
            When the default estimator's models are not installed.

        """

    def refuse(self, error: OsgError, path: Path) -> Refusal:
        """Return the answer to the sender of the file, which is stored as `path`."""

    def playable_video(self, path: Path, options: ReadOptions, copy: Path) -> Path | None:
        """Return a video of the clip, written to `copy` if the file is none; None for no video."""

    def open_frames(self, path: Path, options: ReadOptions) -> OpenFrames:
        """Open the pictures for reading.

        Raises
        ------
        OsgError
            When the file holds no pictures, or cannot be read.

        """
