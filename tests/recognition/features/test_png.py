"""Two-tone PNG: exact, the same bytes everywhere, strict with input from outside."""

import struct
import zlib

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.features.contour import BinaryImage
from app.recognition.features.png import decode_png, encode_png


def checkered(height: int, width: int, seed: int = 0) -> BinaryImage:
    noise = np.random.default_rng(seed).integers(0, 2, (height, width))
    return (noise * 255).astype(np.uint8)


@given(st.integers(1, 224), st.integers(1, 224), st.integers(0, 999))
def test_decoding_gives_back_what_was_encoded(height: int, width: int, seed: int) -> None:
    image = checkered(height, width, seed)
    np.testing.assert_array_equal(decode_png(encode_png(image), (height, width)), image)


def test_other_readers_understand_it() -> None:
    image = checkered(224, 224)
    content = np.frombuffer(encode_png(image), dtype=np.uint8)
    np.testing.assert_array_equal(cv2.imdecode(content, cv2.IMREAD_GRAYSCALE), image)


def test_the_bytes_do_not_depend_on_a_compressor() -> None:
    content = encode_png(np.array([[0, 255], [255, 0]], dtype=np.uint8))
    assert content.hex() == (
        "89504e470d0a1a0a"
        "0000000d49484452000000020000000201000000005acd3089"
        "0000000f494441547801010400fbff00400080014400c1c3e62e9e"
        "0000000049454e44ae426082"
    )
    assert zlib.decompress(content[41:-16]) == b"\x00\x40\x00\x80"


def test_a_grey_image_is_split_at_half() -> None:
    grey = np.array([[0, 127, 128, 255]], dtype=np.uint8)
    _, encoded = cv2.imencode(".png", grey)
    decoded = decode_png(encoded.tobytes(), (1, 4))
    np.testing.assert_array_equal(decoded, [[0, 0, 255, 255]])


def test_an_image_of_another_size_is_refused_before_it_is_decoded() -> None:
    header = struct.pack(">II", 65_535, 65_535)
    bomb = encode_png(checkered(2, 2))
    bomb = bomb[:16] + header + bomb[24:]
    with pytest.raises(ValueError, match="65535 x 65535, expected 224 x 224"):
        decode_png(bomb, (224, 224))


@pytest.mark.parametrize("kept", [0, 7, 20, 40, 60])
def test_a_truncated_image_is_refused(kept: int) -> None:
    content = encode_png(checkered(8, 8))[:kept]
    with pytest.raises(ValueError, match="PNG"):
        decode_png(content, (8, 8))
