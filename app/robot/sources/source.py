"""Protocol of a frame source: a clip, a camera, a network stream, a dive recording."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from datetime import datetime
from typing import Protocol

from app.recognition.poses.frame import Image
from app.robot.events import SourceLost, SourceRestored, SourceWarned


@dataclass(frozen=True, eq=False)
class Frame:
    """One frame of a source.

    Attributes
    ----------
    time
        Seconds in the source's own clock, greater than in every frame before. A clip's first frame
        is at 0 s; a live source counts from when it was opened.
    image
        ``(height, width, 3)`` RGB, upright, y down.
    dropped
        Number of frames skipped since the previous one because newer ones had arrived;
        always 0 for a recording.

    """

    time: float
    image: Image
    dropped: int = 0


@dataclass(frozen=True)
class NoFrame:
    """A pause without frames, given so that the caller can do other work.

    Attributes
    ----------
    time
        Seconds in the source's clock.

    """

    time: float


Notice = SourceLost | SourceRestored | SourceWarned | NoFrame
"""What a source yields besides frames; the runtime emits all of them but `NoFrame`."""


class Source(Protocol):
    """A stream of frames in order, with notices between them.

    A recording yields every frame as fast as they are requested, then ends. A live source yields
    the newest frame, waits if there is none, and never ends by itself.

    Attributes
    ----------
    name
        Display name, without passwords.
    live
        Whether it is a camera or stream; frames not requested in time are then dropped.
    began
        Time in UTC at which the source's clock was 0; None for a recording.
    frame_size
        Width and height in pixels of the first frame; after a `SourceRestored` another may come.

    """

    @property
    def name(self) -> str:
        """Display name, without passwords."""

    @property
    def live(self) -> bool:
        """Whether it is a camera or stream, not a recording."""

    @property
    def began(self) -> datetime | None:
        """Time in UTC at which its clock was 0; None: unknown."""

    @property
    def frame_size(self) -> tuple[int, int]:
        """Width and height in pixels of the first frame."""

    def __iter__(self) -> Iterator[Frame | Notice]:
        """Iterate once over the frames and notices."""

    def close(self) -> None:
        """Release the camera or file; iteration ends. May be called twice."""
