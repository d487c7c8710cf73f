"""Clip sources: the type of a video is told by its first bytes."""

from pathlib import Path

import pytest

from app.clip_sources import VIDEO, ReadOptions
from app.recognition.errors import VideoError
from app.recognition.recording.file_kinds import HEAD_BYTES, video_type
from app.recognition.recording.video import probe
from tests.recognition.damaged_clips import write_clip


@pytest.mark.parametrize(
    ("ending", "codec", "media_type"),
    [
        ("mp4", "libx264", "video/mp4"),
        ("mov", "libx264", "video/quicktime"),
        ("webm", "libvpx", "video/webm"),
        ("mkv", "libx264", "video/x-matroska"),
        ("avi", "mpeg4", "video/x-msvideo"),
        ("ts", "libx264", "video/mp2t"),
    ],
)
def test_every_container_we_open_is_known(
    tmp_path: Path, ending: str, codec: str, media_type: str
) -> None:
    path = write_clip(tmp_path / f"clip.{ending}", codec=codec)
    assert video_type(path.read_bytes()[:HEAD_BYTES]) == media_type


@pytest.mark.parametrize("begins_at", [0, 100])
@pytest.mark.parametrize("stamped", [False, True])
def test_streams_of_camcorders_and_those_that_begin_in_mid_packet_are_known(
    tmp_path: Path, stamped: bool, begins_at: int
) -> None:
    content = write_clip(tmp_path / "clip.ts", codec="libx264", frames=30).read_bytes()
    packets = [content[at : at + 188] for at in range(0, len(content), 188)]
    stream = b"".join(b"\0\1\2\3" + packet if stamped else packet for packet in packets)
    path = tmp_path / "clip.mts"
    path.write_bytes(stream[begins_at:])
    assert video_type(path.read_bytes()[:HEAD_BYTES]) == "video/mp2t"
    assert probe(path).width > 0


@pytest.mark.parametrize(
    "head", [b"", b"G", b"G" * 100, b"RIFF\0\0\0\0WAVE", b"\x1aE\xdf", b"ftyp"]
)
def test_what_only_resembles_one_is_not(head: bytes) -> None:
    assert video_type(head) is None


def test_a_take_that_does_not_say_how_long_it_is_ends_while_it_is_read(tmp_path: Path) -> None:
    whole = write_clip(tmp_path / "take.webm", codec="libvpx", frames=70, times=[*range(70)])
    silent = tmp_path / "silent.webm"
    # The element with the duration (Matroska, RFC 9559) becomes a void one.
    silent.write_bytes(whole.read_bytes().replace(b"\x44\x89\x88", b"\xec\x89\x00", 1))
    options = ReadOptions(one_take=True)
    assert VIDEO.probe(silent, options).duration is None
    with pytest.raises(VideoError, match="more than the limit of 60 s"):
        list(VIDEO.open_frames(silent, options).frames)
    assert len(list(VIDEO.open_frames(silent, ReadOptions()).frames)) == 70
