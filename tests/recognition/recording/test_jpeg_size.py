"""The size in a JPEG's header, whatever stands around it."""

import io

import av
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.recording.jpeg_size import read_jpeg_size


def encoded(width: int, height: int) -> bytes:
    buffer = io.BytesIO()
    with av.open(buffer, "w", format="mjpeg") as container:
        stream = container.add_stream("mjpeg", rate=1)
        stream.width, stream.height, stream.pix_fmt = width, height, "yuvj420p"
        frame = av.VideoFrame.from_ndarray(np.zeros((height, width, 3), np.uint8), "rgb24")
        container.mux(stream.encode(frame))
        container.mux(stream.encode())
    return buffer.getvalue()


@pytest.mark.parametrize("size", [(64, 48), (320, 16), (1, 1)])
def test_the_size_of_an_encoded_picture_is_read(size: tuple[int, int]) -> None:
    assert read_jpeg_size(encoded(*size)) == size


def test_padding_before_a_marker_is_skipped() -> None:
    picture = encoded(64, 48)
    assert read_jpeg_size(picture[:2] + b"\xff\xff" + picture[2:]) == (64, 48)


@given(st.binary(max_size=200))
def test_anything_else_is_read_to_its_end(content: bytes) -> None:
    size = read_jpeg_size(b"\xff\xd8" + content)
    assert size is None or all(0 <= side < 2**16 for side in size)
    assert read_jpeg_size(content.replace(b"\xff\xd8", b"")) is None
