"""Video types: the media type by the first bytes, because names and stated types prove nothing."""

from __future__ import annotations

HEAD_BYTES = 4096
"""Bytes from the beginning of a file that `video_type` needs."""

_MPEG_TS_PACKET = 188

_ISO_BOXES = frozenset({b"ftyp", b"moov", b"mdat", b"wide", b"free", b"skip", b"pnot"})
"""First boxes of an ISO or QuickTime file; old cameras write no ``ftyp``."""


def video_type(head: bytes) -> str | None:
    """Return the media type of a video that begins with `head`, or None when it is no video.

    The kinds are those that `recording.video` opens: MP4 and QuickTime, Matroska and WebM,
    AVI, MPEG transport streams.
    """
    if head[4:8] in _ISO_BOXES:
        return "video/quicktime" if head[4:12] == b"ftypqt  " else "video/mp4"
    if head[:4] == b"\x1aE\xdf\xa3":
        return "video/webm" if b"webm" in head[:64] else "video/x-matroska"
    if head[:4] == b"RIFF" and head[8:12] == b"AVI ":
        return "video/x-msvideo"
    packets = head[::_MPEG_TS_PACKET]
    if len(packets) >= 3 and set(packets) == {0x47}:
        return "video/mp2t"
    return None
