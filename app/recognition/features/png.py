"""PNG images in two tones, with the same bytes on every machine."""

from __future__ import annotations

import struct
import zlib
from base64 import b64encode

import cv2
import numpy as np

from app.recognition.features.contour import BinaryImage

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_HEADER = struct.Struct(">IIBBBBB")


def encode_png(image: BinaryImage) -> bytes:
    """Return an image of 0 and 255, at most 65 535 bytes at a bit a pixel, as PNG.

    Stored with one bit a pixel and without compression: compressed bytes differ between builds
    of zlib, and a language file must have the same bytes everywhere.
    """
    height, width = image.shape
    rows = np.packbits(image > 0, axis=1)
    unfiltered = np.concatenate([np.zeros((height, 1), dtype=np.uint8), rows], axis=1).tobytes()
    size = struct.pack("<HH", len(unfiltered), len(unfiltered) ^ 0xFFFF)
    stored = b"\x78\x01\x01" + size + unfiltered + struct.pack(">I", zlib.adler32(unfiltered))
    header = _HEADER.pack(width, height, 1, 0, 0, 0, 0)
    chunks = (_chunk(b"IHDR", header), _chunk(b"IDAT", stored), _chunk(b"IEND", b""))
    return _SIGNATURE + b"".join(chunks)


def to_data_url(content: bytes) -> str:
    """Return a PNG as data URI."""
    return f"data:image/png;base64,{b64encode(content).decode('ascii')}"


def decode_png(content: bytes, size: tuple[int, int]) -> BinaryImage:
    """Read a PNG of the given height and width; pixels brighter than half become 255.

    Raises
    ------
    ValueError
        When it is no PNG or of another size; the size is checked before decoding.

    """
    if content[:8] != _SIGNATURE or content[12:16] != b"IHDR" or len(content) < 33:
        raise ValueError("not a PNG image")
    width, height = struct.unpack(">II", content[16:24])
    if (height, width) != size:
        raise ValueError(f"the image is {width} x {height}, expected {size[1]} x {size[0]}")
    decoded = cv2.imdecode(np.frombuffer(content, dtype=np.uint8), cv2.IMREAD_GRAYSCALE)
    if decoded is None:
        raise ValueError("a damaged PNG image")
    return np.where(decoded > 127, 255, 0).astype(np.uint8)


def _chunk(kind: bytes, content: bytes) -> bytes:
    checksum = zlib.crc32(kind + content)
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", checksum)
