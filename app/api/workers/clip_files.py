"""Paths of the files that belong to one clip."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class ClipFiles:
    """Paths of the parts of a clip.

    Attributes
    ----------
    video
        Video that players show: it exists already, or is still to be made of a dive recording.
    recording
        The landmarks.
    poster, filmstrip
        The still picture, and the thumbnails along the clip.

    """

    video: Path
    recording: Path
    poster: Path
    filmstrip: Path

    @property
    def arguments(self) -> list[str]:
        """The same for a command line, in order."""
        return [str(path) for path in (self.video, self.recording, self.poster, self.filmstrip)]
