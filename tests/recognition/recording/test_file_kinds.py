"""File kinds: a file that holds no clip is named for what it is, with what to do."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from app.recognition.errors import VideoError
from app.recognition.recording.file_kinds import find_file_kind
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
    video = name in ("a.flv", "a.h264")
    assert ("convert it to MP4 with H.264" in str(raised.value)) is video


@pytest.mark.parametrize(
    "head",
    [b"", b"visibility 5 m", b"BMX,time", b"\0\0\0\1mdat\0\0\0\0", b"\0\0\0\x18ftypmp42"],
)
def test_an_unknown_kind_and_a_damaged_mp4_have_no_name(head: bytes) -> None:
    assert find_file_kind(head) is None
