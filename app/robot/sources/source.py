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
        Frames that came since the one before and were left out because newer ones had come;
        always 0 for a recording.

    """

    time: float
    image: Image
    dropped: int = 0


@dataclass(frozen=True)
class Quiet:
    """No frame came for a moment; lets the caller do other work.

    Attributes
    ----------
    time
        Seconds in the source's clock.

    """

    time: float


Notice = SourceLost | SourceRestored | SourceWarned | Quiet
"""What a source may give between two frames; the runtime emits all but `Quiet`."""


class Source(Protocol):
    """Frames in order, with what happened between them.

    A recording gives every frame as fast as it is asked for, then ends. A live source gives the
    newest frame, waits for one where there is none, and never ends by itself.

    Attributes
    ----------
    name
        For people, without passwords.
    live
        Whether frames that nobody asks for in time are dropped.
    began
        When the source's clock was 0, in UTC; None for a recording, whose past nobody knows.
    frame_size
        Width and height in pixels of the first frame; after a `SourceRestored` another may come.

    """

    @property
    def name(self) -> str:
        """What it is called towards people."""
        ...

    @property
    def live(self) -> bool:
        """Whether it is a camera or stream, not a recording."""
        ...

    @property
    def began(self) -> datetime | None:
        """When its clock was 0, in UTC; None: nobody knows."""
        ...

    @property
    def frame_size(self) -> tuple[int, int]:
        """Width and height in pixels of the first frame."""
        ...

    def __iter__(self) -> Iterator[Frame | Notice]:
        """Iterate once over the frames and notices."""
        ...

    def close(self) -> None:
        """Release the camera or file; nothing more is given. May be called twice."""
        ...
