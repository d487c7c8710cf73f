"""The still pictures of a clip."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from app.api.workers.pictures import (
    POSTER_WIDTH,
    THUMBNAIL_HEIGHT,
    Thumbnails,
    thumbnails_in,
    write_poster,
)
from tests.recognition.damaged_clips import write_clip


def test_the_poster_is_the_upright_picture_made_small(tmp_path: Path) -> None:
    clip = write_clip(tmp_path / "clip.mp4", size=(640, 480), frames=30)
    write_poster(clip, tmp_path / "poster.jpg")
    picture = cv2.imread(str(tmp_path / "poster.jpg"))
    assert picture is not None
    assert picture.shape == (POSTER_WIDTH * 3 // 4, POSTER_WIDTH, 3)
    # The clip's top left quarter is red, the rest blue (OpenCV reads BGR).
    assert int(np.argmax(picture[20, 20])) == 2
    assert int(np.argmax(picture[-20, -20])) == 0


@pytest.mark.parametrize("frames", [1, 5, 63, 64, 65, 500, 1000])
def test_thumbnails_lie_at_even_distances_in_order(tmp_path: Path, frames: int) -> None:
    thumbnails = Thumbnails()
    for index in range(frames):
        grey = round(255 * index / frames)
        thumbnails.add(
            index, np.full((2 * THUMBNAIL_HEIGHT, 3 * THUMBNAIL_HEIGHT, 3), grey, np.uint8)
        )
    thumbnails.write(tmp_path / "filmstrip.jpg")
    strip = cv2.imread(str(tmp_path / "filmstrip.jpg"))
    assert strip is not None
    count, width = thumbnails_in(frames), THUMBNAIL_HEIGHT * 3 // 2
    assert strip.shape == (THUMBNAIL_HEIGHT, count * width, 3)
    assert count < 64
    greys = strip[20, width // 2 :: width, 0]
    np.testing.assert_allclose(greys, 255 * np.arange(count) / count, atol=6)


def test_a_clip_without_frames_has_no_thumbnails(tmp_path: Path) -> None:
    Thumbnails().write(tmp_path / "filmstrip.jpg")
    assert not (tmp_path / "filmstrip.jpg").exists()
