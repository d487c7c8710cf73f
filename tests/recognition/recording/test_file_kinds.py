"""File kinds: a file that holds no clip is named for what it is, with what to do."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from app.recognition.errors import VideoError
from app.recognition.recording.file_kinds import describe_unreadable, find_file_kind
from app.recognition.recording.video import probe


def picture(path: Path) -> Path:
    cv2.imwrite(str(path), np.zeros((4, 4, 3), np.uint8))
    return path


def array(path: Path) -> Path:
    np.savez(path, a=np.zeros(3))
    return path


def text(content: str, path: Path) -> Path:
    path.write_text(content)
    return path


@pytest.mark.parametrize(
    ("name", "content", "kind"),
    [
        ("a.png", None, "a PNG picture"),
        ("a.jpg", None, "a JPEG picture"),
        ("a.npz", None, "a zip archive"),
        ("a.bvh", "HIERARCHY\nROOT Hips", "a BVH motion file"),
        ("a.xml", '<?xml version="1.0"?>', "an XML file"),
        ("a.flv", "FLV\x01", "a Flash video"),
        ("a.h264", "\0\0\0\x01g", "a raw stream of H.264"),
        ("sei.h264", "\0\0\0\x01\x06\x05", "a raw stream of H.264"),
        ("sei.h265", "\0\0\0\x01N\x01\x05", "a raw stream of H.265"),
        ("a.webp", "RIFF\0\0\0\0WEBPVP8 ", "a WebP picture"),
        ("a.c3d", "\x02P\0\0", "a C3D motion file"),
        ("a.nc", "CDF\x01\0", "a NetCDF file"),
        ("a.mp4", "version https://git-lfs.github.com/spec/v1\n", "a Git LFS pointer"),
        ("b.mp4", "\0" * 5000, "only zeros at its beginning"),
    ],
)
def test_what_is_no_video_is_named_and_ffmpeg_is_not_quoted(
    tmp_path: Path, name: str, content: str | None, kind: str
) -> None:
    path = tmp_path / name
    if content is not None:
        text(content, path)
    else:
        (array if name.endswith(".npz") else picture)(path)
    with pytest.raises(VideoError, match=kind) as raised:
        probe(path)
    assert "Invalid" not in str(raised.value)
    video = name.endswith((".flv", ".h264", ".h265"))
    assert ("convert it to MP4 with H.264" in str(raised.value)) is video


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.txt", "time nose_x nose_y\n0 1 2\n"),
        ("a.jsonl", '{"time": 0}\n{"time": 1}\n'),
        ("a.mp4", "\x07\x05 of no kind"),
    ],
)
def test_only_a_video_may_lack_its_index(tmp_path: Path, name: str, content: str) -> None:
    with pytest.raises(VideoError, match=r"name a table of keypoints \.csv or \.json") as raised:
        probe(text(content, tmp_path / name))
    assert "index" not in str(raised.value)
    with pytest.raises(VideoError, match="its index is cut off, or it is damaged"):
        probe(text("\0\0\0\x18ftypmp42\0\0\0\0", tmp_path / "video.mp4"))


@pytest.mark.parametrize(
    "head",
    [b"", b"visibility 5 m", b"BMX,time", b"\0\0\0\1mdat\0\0\0\0", b"\0\0\0\x18ftypmp42"],
)
def test_an_unknown_kind_and_a_damaged_mp4_have_no_name(head: bytes) -> None:
    assert find_file_kind(head) is None


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"\x1f\x43\xb6\x75 I:", "of which the first piece is missing"),
        (b"\x89HDF\r\n\x1a\n", "if it is of movement, save it as DeepLabCut's CSV"),
        (b"\xff\xd8\xff\xe0" * 9, "ffmpeg -f mjpeg -framerate 25 -i FILE clip.mp4"),
    ],
)
def test_what_neighbours_write_is_named_with_what_reads_it(
    tmp_path: Path, content: bytes, words: str
) -> None:
    path = tmp_path / "a.bin"
    path.write_bytes(content)
    assert words in describe_unreadable(path)
