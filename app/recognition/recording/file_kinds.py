"""File kinds: what a file is by its first bytes, for those that hold no clip for us."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

CONVERT: Final = "convert it to MP4 with H.264"
SEND_VIDEO: Final = "give the video that it belongs to"
UNPACK: Final = "unpack it, and give the clip that is in it"


@dataclass(frozen=True)
class FileKind:
    """A kind of file that holds no clip.

    Attributes
    ----------
    name
        In words, with its article.
    remedy
        What to do instead, as an imperative.

    """

    name: str
    remedy: str


_PICTURE = "give a video: a single picture shows no gesture"
_H264 = "a raw stream of H.264, without a container"
_H265 = "a raw stream of H.265, without a container"
_PICKLE = "a pickled Python object, which is never opened"

_MARKS: Final = (
    (0, b"GIF8", "a GIF picture", CONVERT),
    (0, b"\x89PNG", "a PNG picture", _PICTURE),
    (0, b"\xff\xd8\xff", "a JPEG picture", _PICTURE),
    (4, b"ftypheic", "an HEIC picture", _PICTURE),
    (4, b"ftypheix", "an HEIC picture", _PICTURE),
    (4, b"ftypmif1", "an HEIF picture", _PICTURE),
    (4, b"ftypavif", "an AVIF picture", _PICTURE),
    (0, b"\x30\x26\xb2\x75\x8e\x66\xcf\x11", "a Windows Media file (WMV)", CONVERT),
    (0, b"FLV\x01", "a Flash video (FLV)", CONVERT),
    (0, b".RMF", "a RealMedia file", CONVERT),
    (0, b"\0\0\1\xb3", "an MPEG video stream", CONVERT),
    # The type of the first unit follows: boxes of MP4 may begin with the same four bytes.
    (0, b"\0\0\0\1\x67", _H264, CONVERT),
    (0, b"\0\0\0\1\x27", _H264, CONVERT),
    (0, b"\0\0\0\1\x09", _H264, CONVERT),
    (0, b"\0\0\0\1\x40\1", _H265, CONVERT),
    (0, b"\0\0\0\1\x46\1", _H265, CONVERT),
    (0, b"OggS", "an Ogg file", CONVERT),
    (0, b"ID3", "an MP3 file, which has no pictures", SEND_VIDEO),
    (8, b"WAVE", "a WAV file, which has no pictures", SEND_VIDEO),
    (0, b"HIERARCHY", "a BVH motion file", SEND_VIDEO),
    (0, b"PathFileType", "a TRC motion file", SEND_VIDEO),
    (0, b"<?xml", "an XML file", SEND_VIDEO),
    (0, b"\xef\xbb\xbf<?xml", "an XML file", SEND_VIDEO),
    (0, b"<!DOCTYPE html", "a web page", SEND_VIDEO),
    (0, b"<html", "a web page", SEND_VIDEO),
    (0, b"%PDF", "a PDF", SEND_VIDEO),
    (0, b"\x93NUMPY", "a NumPy array", SEND_VIDEO),
    (0, b"\x80\x04\x95", _PICKLE, SEND_VIDEO),
    (0, b"\x80\x05\x95", _PICKLE, SEND_VIDEO),
    (0, b"PK\x03\x04", "a zip archive", UNPACK),
    (0, b"\x1f\x8b", "a gzip archive", UNPACK),
    (0, b"7z\xbc\xaf\x27\x1c", "a 7z archive", UNPACK),
    (0, b"Rar!", "a RAR archive", UNPACK),
)
"""Place and bytes of each mark, with the kind's name and remedy."""


def find_file_kind(head: bytes) -> FileKind | None:
    """Return what a file that begins with `head` is; None for an unknown kind."""
    found = ((name, do) for at, mark, name, do in _MARKS if head[at : at + len(mark)] == mark)
    kind = next(found, None)
    return None if kind is None else FileKind(*kind)
