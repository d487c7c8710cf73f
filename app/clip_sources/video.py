"""Clip source: a video file."""

from __future__ import annotations

from pathlib import Path

from typing_extensions import Unpack

from app.bags.extraction import copying, record_and_copy
from app.clip_sources.source import (
    ClipFacts,
    OpenFrames,
    ReadOptions,
    RecordedClip,
    Refusal,
)
from app.recognition.errors import OsgError
from app.recognition.estimation import finds_hands
from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.recording.extraction import Following
from app.recognition.recording.file_kinds import HEAD_BYTES, video_type
from app.recognition.recording.video import FrameReader, probe, read_frames


class VideoSource:
    """A video file, which players show as it is."""

    name = "video"
    noun = "a video"
    formats = "MP4, MOV, WebM, MKV, AVI, MPEG-TS, MPG"
    endings: tuple[str, ...] = (".avi", ".m4v", ".mkv", ".mov", ".mp4", ".mpg", ".webm")
    folder: str | None = None
    has_pictures = True
    has_topics = False
    probe_seconds = 30.0
    """Longest time to probe, which decodes one frame and takes milliseconds."""
    broken_off = Refusal(
        code="decoder",
        detail="the process that read this clip broke off: the clip is damaged, or it needs more "
        "memory or time than a job may use; convert it to an MP4 with H.264 and try again",
    )

    def accepts(self, path: Path, topic: str | None = None) -> bool:
        """Return whether the first bytes of a file are those of a video."""
        if topic is not None or not path.is_file():
            return False
        with path.open("rb") as file:
            return video_type(file.read(HEAD_BYTES)) is not None

    def accepts_upload(self, head: bytes, name: str) -> bool:
        """Return whether `head` is the beginning of a video."""
        return video_type(head) is not None

    def upload_options(self, head: bytes, name: str, options: ReadOptions) -> ReadOptions:
        """Return `options` unchanged."""
        return options

    def media_type(self, head: bytes) -> str:
        """Return the media type of a video that begins with `head`."""
        found = video_type(head)
        assert found is not None
        return found

    def is_take(self, path: Path) -> bool:
        """Return whether a file is a video by its ending, or by its first bytes."""
        return path.is_file() and (path.suffix.lower() in self.endings or self.accepts(path))

    def probe(self, path: Path, options: ReadOptions) -> ClipFacts:
        """Read the container's facts, and decode one frame."""
        info = probe(path, turn=options.turn)
        return ClipFacts(info.width, info.height, info.duration, info.frames)

    def shows_pictures(self, path: Path, options: ReadOptions) -> bool:
        """Return True."""
        return True

    def record(
        self,
        path: Path,
        options: ReadOptions,
        *,
        video: Path | None = None,
        estimator: PoseEstimator | None = None,
        **following: Unpack[Following],
    ) -> RecordedClip:
        """Find body and hands in every frame."""
        with read_frames(path, turn=options.turn) as frames:
            found = record_and_copy(frames, video, estimator, options.water, **following)
        has_hands = estimator is None or finds_hands(estimator)
        return RecordedClip(found, has_hands, found.poses.landmarks)

    def refuse(self, error: OsgError, path: Path) -> Refusal:
        """Return a refusal that names the clip, not the stored file."""
        return Refusal("video_unreadable", str(error).replace(path.name, "the clip"))

    def playable_video(self, path: Path, options: ReadOptions, copy: Path) -> Path | None:
        """Return the file itself, or write a copy whose pictures are turned."""
        if not options.turn:
            return path
        with read_frames(path, turn=options.turn) as frames, copying(frames, copy) as add:
            for frame in frames:
                add(frame)
        return copy

    def open_frames(self, path: Path, options: ReadOptions) -> OpenFrames:
        """Open the file for decoding."""
        reader = FrameReader(path, turn=options.turn)
        return OpenFrames(reader, reader.close)
