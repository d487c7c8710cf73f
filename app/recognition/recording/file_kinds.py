"""File kinds: what a file is by its first bytes: a video, or what holds no clip for us."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Final

CONVERT: Final = "convert it to MP4 with H.264"
SEND_VIDEO: Final = "give the video that it belongs to"
UNPACK: Final = "unpack it, and give the clip that is in it"

COPIES: Final = frozenset({".lrv", ".lrf", ".part", ".crdownload"})
"""Endings of copies that cameras (small) and browsers (unfinished) write beside a clip."""


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

_DUMP = "a dump becomes one by `ffmpeg -f mjpeg -framerate 25 -i FILE clip.mp4`"
_MOVEMENT = "if it is of movement, save it as DeepLabCut's CSV (save_poses.to_dlc_file)"

_MARKS: Final = (
    (rb"GIF8", "a GIF picture", CONVERT),
    (rb"\x89PNG", "a PNG picture", _PICTURE),
    (rb"\xff\xd8\xff", "a JPEG picture, or a dump of many", f"{_PICTURE}; {_DUMP}"),
    (rb".{8}WEBP", "a WebP picture", _PICTURE),
    (rb"II\*\0", "a TIFF picture", _PICTURE),
    (rb".{4}ftyphei[cx]", "an HEIC picture", _PICTURE),
    (rb".{4}ftypmif1", "an HEIF picture", _PICTURE),
    (rb".{4}ftypavif", "an AVIF picture", _PICTURE),
    (rb"\x30\x26\xb2\x75\x8e\x66\xcf\x11", "a Windows Media file (WMV)", CONVERT),
    (rb"FLV\x01", "a Flash video (FLV)", CONVERT),
    (rb"\.RMF", "a RealMedia file", CONVERT),
    (rb"\0\0\x01\xb3", "an MPEG video stream", CONVERT),
    (rb"\0\0\0?\x01[\x67\x27\x09\x06]", "a raw stream of H.264, without a container", CONVERT),
    (rb"\0\0\0\x01[\x40\x46\x4e]\x01", "a raw stream of H.265, without a container", CONVERT),
    (rb"OggS", "an Ogg file", CONVERT),
    (rb"ID3", "an MP3 file, which has no pictures", SEND_VIDEO),
    (rb".{8}WAVE", "a WAV file, which has no pictures", SEND_VIDEO),
    (rb"fLaC", "a FLAC file, which has no pictures", SEND_VIDEO),
    (rb"HIERARCHY", "a BVH motion file", SEND_VIDEO),
    (rb"PathFileType", "a TRC motion file", SEND_VIDEO),
    (rb"\x02\x50", "a C3D motion file", SEND_VIDEO),
    (rb"CDF[\x01\x02\x05]", "a NetCDF file", _MOVEMENT),
    (
        rb"\x1f\x43\xb6\x75",
        "a piece of a WebM recording, of which the first piece is missing",
        "write all pieces of the recorder into one file, beginning with the first one",
    ),
    (rb"MATLAB 5\.0", "a MATLAB file", SEND_VIDEO),
    (rb"PAR1", "a Parquet table", SEND_VIDEO),
    (rb"version https://git-lfs", "a Git LFS pointer in place of the file", "run `git lfs pull`"),
    (rb"(\xef\xbb\xbf)?<\?xml", "an XML file", SEND_VIDEO),
    (rb"<!DOCTYPE html|<html", "a web page", SEND_VIDEO),
    (rb"%PDF", "a PDF", SEND_VIDEO),
    (rb"\x93NUMPY", "a NumPy array", SEND_VIDEO),
    (rb"\x80[\x04\x05]\x95", "a pickled Python object, which is never opened", SEND_VIDEO),
    (rb"PK\x03\x04", "a zip archive", UNPACK),
    (rb"\x1f\x8b", "a gzip archive", UNPACK),
    (rb"\x28\xb5\x2f\xfd", "a Zstandard archive", UNPACK),
    (rb"\xfd7zXZ\0", "an xz archive", UNPACK),
    (rb"BZh", "a bzip2 archive", UNPACK),
    (rb"7z\xbc\xaf\x27\x1c", "a 7z archive", UNPACK),
    (rb"Rar!", "a RAR archive", UNPACK),
)
"""Place and bytes of each mark, with the kind's name and remedy."""


def find_file_kind(head: bytes) -> FileKind | None:
    """Return what a file that begins with `head` is; None for a video or an unknown kind."""
    if head and not head.strip(b"\0"):
        return FileKind("only zeros at its beginning", "copy it again")
    found = (kind for mark, *kind in _MARKS if re.match(mark, head, re.DOTALL))
    kind = next(found, None)
    return None if kind is None else FileKind(*kind)


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
    if head[:4] == b"\0\0\1\xba":
        return "video/mpeg"
    return "video/mp2t" if _is_transport_stream(head) else None


FEW_PACKETS, MANY_PACKETS = 3, 8
"""Packets that tell a transport stream, where a file begins with one, and where it does not."""


def _is_transport_stream(head: bytes) -> bool:
    """Return whether MPEG transport packets begin within the first one, as in a broken-off start.

    Camcorders (AVCHD) and Blu-ray write a time stamp of four bytes before each packet.
    """
    for size in (_MPEG_TS_PACKET, _MPEG_TS_PACKET + 4):
        for first in range(min(size, len(head))):
            packets = head[first::size]
            # A file that begins in mid packet needs more of them: other bytes may be alike.
            least = FEW_PACKETS if first in (0, 4) else MANY_PACKETS
            if len(packets) >= least and set(packets) == {0x47}:
                return True
    return False


def read_head(path: Path) -> bytes:
    """Return the first `HEAD_BYTES` of a file.

    Raises
    ------
    OSError
        When it cannot be read.

    """
    with path.open("rb") as file:
        return file.read(HEAD_BYTES)


def describe_unreadable(path: Path) -> str:
    """Return, in a sentence, why a file cannot be read as a video, and what to do."""
    try:
        head = read_head(path)
    except OSError as error:
        return f"{path.name} cannot be read ({error.strerror}); check the path"
    kind = find_file_kind(head)
    if head.startswith(b"\x89HDF"):
        kind = FileKind("an HDF5 or NetCDF file", _MOVEMENT)
    if kind is not None:
        return f"{path.name} is {kind.name}, and no video that is read here; {kind.remedy}"
    if video_type(head) is not None:
        return (
            f"{path.name} is not a readable video: its index is cut off, or it is damaged; record "
            "or export it again"
        )
    return (
        f"{path.name} is not a readable video: it begins as no MP4, MOV, MKV, WebM, AVI, MPEG-TS "
        "or MPG file does; export it as one of them, or name a table of keypoints .csv or .json"
    )
