"""The film of the start page: small, silent, short, and telling how a gesture is made."""

from pathlib import Path

import av
import numpy as np
import numpy.typing as npt

from languages.first_take import CARD, FILM, SIZE

SIZE_LIMIT = 150_000
"""Bytes: the first screen loads it unasked."""


def read(path: Path) -> npt.NDArray[np.uint8]:
    """Return the film's pictures, RGB."""
    with av.open(str(path)) as container:
        pictures = [frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)]
    return np.stack(pictures)


def test_the_film_is_small_silent_and_three_seconds_long() -> None:
    assert FILM.stat().st_size <= SIZE_LIMIT
    with av.open(str(FILM)) as container:
        (stream,) = container.streams
        assert isinstance(stream, av.VideoStream)
        assert (stream.codec_context.name, stream.pix_fmt) == ("h264", "yuv420p")
        assert (stream.width, stream.height) == SIZE
        assert stream.average_rate is not None
        assert 3 <= stream.frames / stream.average_rate <= 4
    content = FILM.read_bytes()
    assert content.find(b"moov") < content.find(b"mdat")


def test_the_drawing_appears_while_the_diver_shows_it_and_its_name_comes_last() -> None:
    pictures = read(FILM)
    left, top, right, bottom = CARD
    drawn = (pictures[:, top:bottom, left:right].min(axis=3) > 200).sum(axis=(1, 2))
    below = pictures[:, bottom : bottom + 60, left:right].min(axis=3) > 180
    named = below.sum(axis=(1, 2))
    grows = np.flatnonzero((drawn > 50) & (drawn < 0.9 * drawn[-1]))
    assert drawn[0] == 0 < len(grows)
    assert named[: grows[-1]].max() == 0 < named[-1]
    # The diver moves until the end stands still.
    moved = np.abs(np.diff(pictures.astype(np.int16), axis=0)).mean(axis=(1, 2, 3))
    assert (moved[: grows[-1]] > 0.3).mean() > 0.9
