"""Video writer: what the encoder cannot write is refused before it is asked."""

from __future__ import annotations

from pathlib import Path

import pytest

from app.bags.video_writer import VideoFile
from app.recognition.errors import VideoError


@pytest.mark.parametrize(("size", "side"), [((64, 16_386), "height"), ((16_386, 64), "width")])
def test_a_picture_that_would_end_the_process_is_refused(
    tmp_path: Path, size: tuple[int, int], side: str
) -> None:
    with pytest.raises(VideoError, match=f"a {side} of more than 16384"):
        VideoFile(tmp_path / "video.mp4", *size)
    assert not (tmp_path / "video.mp4").exists()
