"""Size of a JPEG picture from its header: FFmpeg does not state it for a picture it refuses."""

from __future__ import annotations

_START_OF_FRAME = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
"""Markers that are followed by the size (ITU-T T.81, table B.1)."""

_WITHOUT_LENGTH = frozenset((*range(0xD0, 0xDA), 0x01))
"""Markers without a segment: restarts, start and end of the picture."""


def read_jpeg_size(picture: bytes) -> tuple[int, int] | None:
    """Return width and height in pixels; None where no header states them."""
    at = 2
    while picture[:2] == b"\xff\xd8" and at + 9 <= len(picture) and picture[at] == 0xFF:
        marker = picture[at + 1]
        if marker in _START_OF_FRAME:
            height = int.from_bytes(picture[at + 5 : at + 7], "big")
            return int.from_bytes(picture[at + 7 : at + 9], "big"), height
        if marker == 0xFF:  # padding
            at += 1
        elif marker in _WITHOUT_LENGTH:
            at += 2
        else:
            at += 2 + max(2, int.from_bytes(picture[at + 2 : at + 4], "big"))
    return None
