"""Clip source: a video file."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from typing_extensions import Unpack

from app.bags.extraction import Reading, copy_frames, record_and_copy
from app.clip_sources.source import (
    ClipFacts,
    ClipSource,
    OpenFrames,
    ReadOptions,
    RecordedClip,
    Refusal,
)
from app.recognition.errors import OsgError
from app.recognition.estimation.factory import finds_hands
from app.recognition.recording.chapters import chapters_in, join_chapters
from app.recognition.recording.file_kinds import read_head, video_type
from app.recognition.recording.video import FrameReader, probe


class VideoSource(ClipSource):
    """A video file, which players show as it is."""

    name = "video"
    noun = "a video"
    formats = "MP4, MOV, WebM, MKV, AVI, MPEG-TS, MPG"
    endings: tuple[str, ...] = (".avi", ".m4v", ".mkv", ".mov", ".mp4", ".mpg", ".webm")
    probe_seconds = 30.0
    """Longest time to probe, which decodes one frame and takes milliseconds."""
    broken_off = Refusal(
        code="decoder",
        detail="the process that read this clip broke off: the clip is damaged, or it needs more "
        "memory or time than a job may use; convert it to an MP4 with H.264 and try again",
    )

    def accepts(self, path: Path, topic: str | None = None) -> bool:
        """Return whether the first bytes of a file are those of a video."""
        return topic is None and path.is_file() and video_type(read_head(path)) is not None

    def accepts_upload(self, head: bytes, name: str) -> bool:
        """Return whether `head` is the beginning of a video."""
        return video_type(head) is not None

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
        with _one_file(path) as file:
            info = probe(file, options.limits, options.turn)
        return ClipFacts(info.width, info.height, info.duration, info.frames)

    def record(
        self, path: Path, options: ReadOptions, *, video: Path | None = None, **how: Unpack[Reading]
    ) -> RecordedClip:
        """Find body and hands in every frame."""
        with _one_file(path) as file, _open(file, options) as frames:
            found = record_and_copy(frames, video, options.water, **how)
        estimator = how.get("estimator")
        has_hands = estimator is None or finds_hands(estimator)
        return RecordedClip(found, has_hands, found.poses.landmarks)

    def refuse(self, error: OsgError, path: Path) -> Refusal:
        """Return a refusal that names the clip, not the stored file."""
        return Refusal("video_unreadable", str(error).replace(path.name, "the clip"))

    def playable_video(self, path: Path, options: ReadOptions, copy: Path) -> Path | None:
        """Return the file itself, or write a copy whose pictures are joined or turned."""
        with _one_file(path) as file:
            if not options.turn:
                return path if file == path else Path(shutil.copyfile(file, copy))
            with _open(file, options) as frames:
                copy_frames(frames, copy)
        return copy

    def open_frames(self, path: Path, options: ReadOptions) -> OpenFrames:
        """Open the file for decoding."""
        reader = _open(path, options)
        return OpenFrames(reader, reader.close)


class ChaptersSource(VideoSource):
    """A folder of one recording's chapters, read as one; those that are received are joined."""

    name = "chapters"
    endings = ()

    def accepts(self, path: Path, topic: str | None = None) -> bool:
        """Return whether a folder holds the chapters of one recording, and nothing else."""
        return topic is None and path.is_dir() and bool(chapters_in(path))

    def accepts_upload(self, head: bytes, name: str) -> bool:
        """Return False: a folder is not received."""
        return False


def _open(file: Path, options: ReadOptions) -> FrameReader:
    return FrameReader(file, options.limits, options.turn)


@contextmanager
def _one_file(path: Path) -> Iterator[Path]:
    """Yield a video itself, or for a while the one into which a folder's chapters are joined."""
    if not path.is_dir():
        yield path
        return
    with tempfile.TemporaryDirectory(prefix="chapters-") as made:
        joined = Path(made, "joined")
        join_chapters([(each, None) for each in chapters_in(path)], joined)
        yield joined
