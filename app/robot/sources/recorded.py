"""Recorded frame source: every frame of a file, at the file's own timestamps."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from app.recognition.recording.video import FrameSource
from app.robot.events import SourceWarned
from app.robot.sources.source import Frame, Notice


class RecordedSource:
    """A video file or dive recording; a `Source` that is not live.

    Parameters
    ----------
    name
        Name for people.
    frames
        Open iterator over the frames.
    release
        Closes the file that they are read from; may be called twice.

    """

    live = False
    began = None

    def __init__(self, name: str, frames: FrameSource, release: Callable[[], None]) -> None:
        self.name = name
        self._frames = frames
        self._release = release

    @property
    def frame_size(self) -> tuple[int, int]:
        """Width and height in pixels of every frame."""
        return self._frames.info.width, self._frames.info.height

    def __iter__(self) -> Iterator[Frame | Notice]:
        """Yield every frame, then the warnings about the recording.

        Raises
        ------
        VideoError
            When the recording exceeds a limit that its header did not show.

        """
        time = 0.0
        for frame in self._frames:
            time = frame.time
            yield Frame(time, frame.image)
        for warning in self._frames.warnings:
            yield SourceWarned(time, warning)

    def close(self) -> None:
        """Close the recording; it must not be iterated any more."""
        self._release()
