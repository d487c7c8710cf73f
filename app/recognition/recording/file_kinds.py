"""File kinds: the name of a file's kind by its first bytes, for those that hold no clip for us."""

from __future__ import annotations

from typing import Final

KINDS: Final = (
    (0, b"GIF8", "a GIF picture"),
    (0, b"\x89PNG", "a PNG picture"),
    (0, b"\xff\xd8\xff", "a JPEG picture"),
    (0, b"BM", "a BMP picture"),
    (4, b"ftyphei", "an HEIC picture"),
    (4, b"ftypmif1", "an HEIF picture"),
    (4, b"ftypavif", "an AVIF picture"),
    (0, b"\x30\x26\xb2\x75\x8e\x66\xcf\x11", "a Windows Media file (WMV)"),
    (0, b"FLV\x01", "a Flash video (FLV)"),
    (0, b".RMF", "a RealMedia file"),
    (0, b"\0\0\1\xba", "an MPEG program stream (MPG, VOB)"),
    (0, b"\0\0\1\xb3", "an MPEG video stream"),
    (0, b"\0\0\0\1", "a raw stream of H.264 or H.265, without a container"),
    (0, b"OggS", "an Ogg file"),
    (0, b"ID3", "an MP3 file"),
    (8, b"WAVE", "a WAV file"),
    (0, b"HIERARCHY", "a BVH motion file"),
    (0, b"PathFileType", "a TRC motion file"),
    (0, b"c3d", "a C3D motion file"),
    (0, b"<?xml", "an XML file"),
    (0, b"<!DOCTYPE html", "a web page"),
    (0, b"<html", "a web page"),
    (0, b"%PDF", "a PDF"),
    (0, b"\x93NUMPY", "a NumPy array"),
    (0, b"PK\x03\x04", "a zip archive"),
    (0, b"\x1f\x8b", "a gzip archive"),
    (0, b"7z\xbc\xaf\x27\x1c", "a 7z archive"),
    (0, b"Rar!", "a RAR archive"),
    (0, b"\x80\x04\x95", "a pickled Python object, which is never opened"),
    (0, b"#ROSBAG V", "a recording of ROS 1"),
    (0, b"\x89MCAP", "an MCAP file"),
    (0, b"\x89HDF", "an HDF5 file"),
    (0, b"SQLite format 3", "an SQLite database"),
)
"""Place, bytes and name of each kind."""


def name_file_kind(head: bytes) -> str | None:
    """Return what a file that begins with `head` is, with its article; None for an unknown kind."""
    return next((name for at, mark, name in KINDS if head[at : at + len(mark)] == mark), None)
