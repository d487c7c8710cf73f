"""A received keypoint file: its content, and refusals in the sender's words."""

from __future__ import annotations

from pathlib import Path

import pytest

from app.clip_sources import ReadOptions, Refusal
from app.clip_sources.keypoint_file import DRAWN, NO_HANDS, KeypointFileSource
from app.keypoint_files import Ending
from app.recognition.errors import OsgError
from tests.keypoint_files.files import renamed, write_named, write_numbered
from tests.recognition.strategies import circle, recording


def refused(
    file: Path,
    ending: Ending = ".csv",
    rate: float | None = None,
    size: tuple[int, int] | None = None,
) -> Refusal:
    options = ReadOptions(ending=ending, frame_rate=rate, frame_size=size)
    source = KeypointFileSource()
    with pytest.raises(OsgError) as raised:
        source.record(file, options, video=file.with_name("video.mp4"))
    failed = source.refuse(raised.value, file)
    # Our own names of the file mean nothing to anybody else.
    assert str(file.parent) not in failed.detail
    assert "keypoints-" not in failed.detail
    return failed


def test_what_it_does_not_tell_is_asked_for_by_the_name_of_the_field(tmp_path: Path) -> None:
    file = write_numbered(tmp_path / "received", recording(circle, frames=20))
    failed = refused(file)
    assert failed.code == "frame_rate_needed"
    assert "field frame_rate" in failed.detail
    failed = refused(file, rate=25)
    assert failed.code == "frame_size_needed"
    assert "field frame_size" in failed.detail


def test_a_picture_larger_than_a_clip_s_may_be_is_refused(tmp_path: Path) -> None:
    file = write_numbered(tmp_path / "received", recording(circle, frames=20))
    failed = refused(file, rate=25, size=(20_000, 20_000))
    assert failed.code == "video_unreadable"
    assert "20000 x 20000 pixels" in failed.detail


@pytest.mark.parametrize(
    ("ending", "content", "words"),
    [
        (".csv", b"a,b\n1,2\n", "the file"),
        (".csv", b"time,paw_x,paw_y\n0,1,2\n1,2,3\n", "an option of the command line"),
        (".json", b'{"notes": []}', "list of frames"),
        (".zip", b"PK\x03\x04", "the archive is a damaged"),
    ],
)
def test_what_cannot_be_read_says_why(
    tmp_path: Path, ending: Ending, content: bytes, words: str
) -> None:
    file = tmp_path / "received"
    file.write_bytes(content)
    failed = refused(file, ending)
    assert failed.code == "keypoints_unreadable"
    assert words in failed.detail


def test_what_is_missing_is_told_with_the_recording(tmp_path: Path) -> None:
    poses = renamed(recording(circle, frames=20), {"right_wrist": "paw"})
    file = write_named(tmp_path / "received", poses)
    recorded = KeypointFileSource().record(
        file, ReadOptions(ending=".csv"), video=tmp_path / "video.mp4"
    )
    assert not recorded.has_hands
    warnings = recorded.recording.warnings
    assert (warnings[0], recorded.recording.salute_warnings) == (DRAWN, (NO_HANDS,))
    left_out, missing = warnings[1:]
    assert left_out.startswith("left out, for they mean no landmark here: PAW")
    assert missing == "the file gives no right_wrist"


def test_rounded_times_ask_for_the_frame_rate_and_say_why(tmp_path: Path) -> None:
    file = tmp_path / "received"
    file.write_text("time,nose_x,nose_y\n1,20,30\n1,21,31\n2,22,32\n")
    failed = refused(file, size=(640, 480))
    assert failed.code == "frame_rate_needed"
    assert "times are rounded" in failed.detail
    read = KeypointFileSource().record(
        file, ReadOptions(ending=".csv", frame_rate=25, frame_size=(640, 480))
    )
    assert read.recording.poses.time.tolist() == [0.0, 0.04, 0.08]
