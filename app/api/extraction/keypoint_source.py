"""How a keypoint file that came is to be read, as it is kept beside its clip."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict

from app.keypoint_files import Ending, KeypointOptions


class KeypointSource(BaseModel):
    """What the file does not tell by itself.

    Attributes
    ----------
    ending
        What it is read as.
    frame_rate
        Frames per second of its video, where the sender tells.
    frame_size
        Width and height of its video in pixels, where the sender tells.

    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    ending: Ending
    frame_rate: float | None = None
    frame_size: tuple[int, int] | None = None

    @property
    def options(self) -> KeypointOptions:
        """The same for `app.keypoint_files.read_keypoints`."""
        return KeypointOptions(self.frame_rate, self.frame_size)
