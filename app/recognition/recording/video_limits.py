"""Video limits: the largest size and length of a clip, checked before and during decoding."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from app.recognition.errors import VideoError


@dataclass(frozen=True)
class VideoLimits:
    """Limits of a clip: a file of few bytes can hold 100 000 frames, or one frame of 1 GB.

    Attributes
    ----------
    pixels
        Most pixels of one frame. The default allows the widest pictures of action cameras (5312 x
        2988).
    frames
        Most frames of one clip. The default allows `seconds` of 60 frames each.
    seconds
        Longest duration of one clip. A gesture lasts seconds; 15 minutes take a whole practice
        session.

    """

    pixels: int = 16_000_000
    frames: int = 54_000
    seconds: float = 900.0

    def require_pixels(self, width: int, height: int) -> None:
        """Raise VideoError when a frame is larger than allowed."""
        if width * height > self.pixels:
            raise VideoError(
                f"frames are {width} x {height} pixels, more than the limit of "
                f"{self.pixels / 1e6:g} million; export the clip in a smaller size"
            )

    def require_frames(self, frames: int) -> None:
        """Raise VideoError when a clip has more frames than allowed."""
        if frames > self.frames:
            raise VideoError(
                f"the clip has at least {frames} frames, more than the limit of {self.frames}; "
                "cut out the part with the gestures"
            )

    def require_seconds(self, seconds: float) -> None:
        """Raise VideoError when a clip lasts longer than allowed."""
        if seconds > self.seconds:
            raise VideoError(
                f"the clip lasts at least {seconds:.0f} s, more than the limit of "
                f"{self.seconds:g} s; cut out the part with the gestures"
            )


TAKE: Final = VideoLimits(pixels=4096 * 2160, frames=3600, seconds=60.0)
"""Limits of one gesture between its two salutes, which somebody who was invited sends: it lasts ten
seconds, and no phone records larger pictures by itself."""
