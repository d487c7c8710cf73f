"""A clip as a source: every frame, at the container's timestamps."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from app.recognition.video import FrameReader
from app.recognition.video_limits import VideoLimits
from app.robot.source import Frame, Notice, Warned


class ClipSource:
    """A video file; a `Source` that is not live.

    Parameters
    ----------
    path
        The file.
    limits
        What the clip may cost.

    Raises
    ------
    VideoError
        When the file is no video, holds no readable frame, or breaks a limit.

    """

    live = False

    def __init__(self, path: str | Path, limits: VideoLimits | None = None) -> None:
        self.name = str(path)
        self._reader = FrameReader(path, limits)
        self._closed = False

    @property
    def frame_size(self) -> tuple[int, int]:
        """Width and height in pixels of every frame."""
        return self._reader.info.width, self._reader.info.height

    def __iter__(self) -> Iterator[Frame | Notice]:
        """Give every frame, then what was wrong with the file.

        Raises
        ------
        VideoError
            When the clip breaks a limit after all.

        """
        time = 0.0
        while not self._closed:
            frame = next(self._reader, None)
            if frame is None:
                break
            time = frame.time
            yield Frame(time, frame.image)
        for warning in self._reader.warnings:
            yield Warned(time, warning)

    def close(self) -> None:
        """Close the file; nothing more is given."""
        self._closed = True
        self._reader.close()
