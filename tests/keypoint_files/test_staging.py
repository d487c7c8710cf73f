"""Staging of keypoint files: deceptive archives are refused."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest
from pydantic import ValidationError

from app.clip_sources.source import ReadOptions
from app.keypoint_files import keypoint_ending, stage
from app.keypoint_files.deeplabcut import DEEPLABCUT
from app.keypoint_files.keypoint_table import KeypointFormat
from app.keypoint_files.mediapipe_table import MEDIAPIPE_TABLE
from app.keypoint_files.registry import find_format
from app.recognition.errors import KeypointFileError, VideoError
from app.recognition.recording.video_limits import VideoLimits


def archive_of(path: Path, **entries: str) -> Path:
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in entries.items():
            archive.writestr(name, content)
    return path


@pytest.mark.parametrize(
    ("head", "name", "ending"),
    [
        (b"PK\x03\x04", "dive.csv", ".zip"),
        (b"\x89HDF\r\n\x1a\n", "dive.SLP", ".slp"),
        (b"\x89HDF\r\n\x1a\n", "dive", ".h5"),
        (b"\x89HDF\r\n\x1a\n", "dive.hdf5", ".hdf5"),
        (b"frame,x0", "Dive.CSV", ".csv"),
        (b"[]", "dive.json", ".json"),
        (b"[]", "dive.slp", None),
        (b"a\0b", "dive.csv", None),
        (b"frame,x0", "dive.txt", None),
    ],
)
def test_what_a_file_is_read_as_follows_from_its_bytes_first(
    head: bytes, name: str, ending: str | None
) -> None:
    assert keypoint_ending(head, name) == ending


def test_a_file_gets_its_ending_back_and_stays_where_it_is(tmp_path: Path) -> None:
    file = tmp_path / "received"
    file.write_text("x")
    with stage(file, ".csv") as place:
        assert (place.suffix, place.read_text()) == (".csv", "x")
    assert not place.exists()
    assert file.read_text() == "x"


def test_only_frames_are_unpacked_and_no_name_becomes_a_path(tmp_path: Path) -> None:
    entries = {"../../a_1_keypoints.json": "{}", "__MACOSX/._a.json": "", "notes.txt": "x"}
    with stage(archive_of(tmp_path / "z", **entries), ".zip") as place:
        assert [each.name for each in place.iterdir()] == ["a_1_keypoints.json"]


@pytest.mark.parametrize(
    ("entries", "words"),
    [
        ({"notes.txt": "x"}, "no frames of OpenPose"),
        ({"one/1.json": "{}", "two/1.json": "{}"}, "'1.json' twice"),
        ({"1.json": " " * 5_000_000}, "more than frames of OpenPose can be"),
    ],
)
def test_other_archives_are_refused(tmp_path: Path, entries: dict[str, str], words: str) -> None:
    path = archive_of(tmp_path / "z", **entries)
    with pytest.raises(KeypointFileError, match=words), stage(path, ".zip"):
        pytest.fail("it was unpacked")


def test_damaged_archives_and_those_of_too_many_frames_are_refused(tmp_path: Path) -> None:
    path = archive_of(tmp_path / "z", **{f"{n}.json": "{}" for n in range(3)})
    with pytest.raises(VideoError, match="limit of 2"), stage(path, ".zip", VideoLimits(frames=2)):
        pytest.fail("it was unpacked")
    path.write_bytes(path.read_bytes()[:-30])
    with pytest.raises(KeypointFileError, match="damaged"), stage(path, ".zip"):
        pytest.fail("it was unpacked")


@pytest.mark.parametrize(
    ("head", "name", "form"),
    [
        (b"scorer,DLC,DLC", "dive.csv", DEEPLABCUT),
        (b"\xef\xbb\xbfScorer\tDLC", "dive.tsv", DEEPLABCUT),
        (b"frame,x0", "dive.csv", MEDIAPIPE_TABLE),
        (b"{}", "dive.csv", MEDIAPIPE_TABLE),
    ],
)
def test_of_two_formats_with_one_ending_the_one_that_recognises_the_file_reads_it(
    tmp_path: Path, head: bytes, name: str, form: KeypointFormat
) -> None:
    file = tmp_path / name
    file.write_bytes(head)
    assert find_format(file) is form


def test_an_ending_without_a_format_is_refused() -> None:
    assert ReadOptions(ending=".hdf5").ending == ".hdf5"
    with pytest.raises(ValidationError, match=r"one of \.csv, "):
        ReadOptions(ending=".txt")
