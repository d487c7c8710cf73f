"""The registry: which source reads a file, and what the page, messages and database say of it."""

from __future__ import annotations

import mimetypes
import re
import shutil
from pathlib import Path
from zipfile import ZipFile

import pytest

from app.clip_sources import (
    SOURCES,
    ReadOptions,
    is_take,
    source_named,
    source_of,
    sources_of_upload,
    supported_kinds,
)
from app.recognition.errors import BagError, KeypointFileError, VideoError
from app.recognition.poses.skeletons import BODY_25
from tests.api.recordings import recording_of
from tests.bags.bag_files import published_rows, write_bag
from tests.conftest import ROOT
from tests.keypoint_files.files import write_numbered, write_openpose
from tests.recognition.damaged_clips import write_clip
from tests.recognition.strategies import circle, recording


def test_files_and_folders_are_read_by_the_source_of_their_content(tmp_path: Path) -> None:
    poses = recording(circle, frames=20)
    files = {
        write_clip(tmp_path / "clip.mp4").rename(tmp_path / "renamed.dat"): "video",
        write_bag(tmp_path / "dive", published_rows(recording_of("line"))): "bag",
        write_numbered(tmp_path / "dive.csv", poses): "keypoints",
        write_openpose(tmp_path / "json", poses, BODY_25): "keypoints",
    }
    assert {path: source_of(path).name for path in files} == files
    assert {source_named(source.name) for source in SOURCES} == set(SOURCES)


def test_an_archive_is_read_by_the_names_in_it(tmp_path: Path) -> None:
    poses = recording(circle, frames=20)
    packed = {
        "keypoints": write_openpose(tmp_path / "json", poses, BODY_25),
        "bag": write_bag(tmp_path / "dive", published_rows(recording_of("line"))),
    }
    for name, folder in packed.items():
        archive = Path(shutil.make_archive(str(folder), "zip", folder))
        assert source_of(archive).name == name
    options = ReadOptions(frame_rate=30.0)
    frames = tmp_path / "json.zip"
    assert len(source_of(frames).record(frames, options).recording.poses) == len(poses)
    other = tmp_path / "other.zip"
    with ZipFile(other, "w") as archived:
        archived.writestr("notes.txt", "no clip")
    with pytest.raises(VideoError, match="and no video that is read here; unpack it"):
        source_of(other).probe(other, ReadOptions())


def test_a_named_topic_means_a_dive_recording(tmp_path: Path) -> None:
    clip = write_clip(tmp_path / "clip.mp4")
    options = ReadOptions(topic="/left")
    with pytest.raises(BagError, match="is no dive recording"):
        source_of(clip, "/left").shows_pictures(clip, options)


def test_what_no_source_knows_says_what_would_be_read(tmp_path: Path) -> None:
    with pytest.raises(VideoError, match="is not a file"):
        source_of(tmp_path / "absent.mp4")
    with pytest.raises(VideoError, match=r"neither .*metadata\.yaml.* nor .*_keypoints\.json"):
        source_of(tmp_path)
    text = tmp_path / "notes.txt"
    text.write_text("no clip")
    with pytest.raises(VideoError):
        source_of(text).probe(text, ReadOptions())
    assert "neither a video, a dive recording nor a keypoint file" in supported_kinds()


def test_an_archive_may_be_of_several_sources_and_a_dive_recording_first() -> None:
    names = [source.name for source in sources_of_upload(b"PK\x03\x04", "dive.zip")]
    assert names == ["bag", "keypoints"]


def test_a_source_without_pictures_opens_none(tmp_path: Path) -> None:
    file = write_numbered(tmp_path / "dive.csv", recording(circle, frames=20))
    with pytest.raises(KeypointFileError, match="osg-studio recognize"):
        source_of(file).open_frames(file, ReadOptions())


def test_takes_are_known_by_name_and_a_dive_recording_is_none(tmp_path: Path) -> None:
    names = ("circle.MOV", "circle.csv", "circle.mcap", "circle.txt")
    for name in names:
        (tmp_path / name).touch()
    assert [is_take(tmp_path / name) for name in names] == [True, True, False, False]


def test_the_page_accepts_the_endings_of_every_source() -> None:
    page = (ROOT / "static" / "index.html").read_text(encoding="utf-8")
    match = re.search(r'<input[^>]*id="file"[^>]*accept="([^"]*)"', page)
    assert match is not None
    accepted = set(match[1].split(","))
    endings = {ending for source in SOURCES for ending in source.endings}
    types = {ending: mimetypes.guess_type(f"clip{ending}")[0] or "" for ending in endings}
    videos = {ending for ending, kind in types.items() if kind.startswith("video/")}
    assert "video/*" in accepted
    assert endings - videos <= accepted


def test_a_copy_without_its_clip_beside_it_is_a_take(tmp_path: Path) -> None:
    copy = write_clip(tmp_path / "clip.mp4").rename(tmp_path / "GL010042.LRV")
    assert is_take(copy)
    (tmp_path / "GX010042.MP4").touch()
    assert not is_take(copy)
