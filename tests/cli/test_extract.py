"""``osg-studio extract``, run as a user runs it."""

import zipfile
from pathlib import Path

import pytest

from app.evaluation.labelled_takes import collect_takes, labelled_files
from app.recognition import Recording
from tests.command_line import OsgStudio
from tests.recognition.damaged_clips import write_clip


@pytest.mark.slow
@pytest.mark.usefixtures("installed_models")
def test_a_folder_is_extracted_for_evaluate_and_copied_by_name(
    osg_studio: OsgStudio, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    kept = tmp_path / "kept"
    monkeypatch.setattr("app.cli.extract.recordings_dir", lambda: kept)
    season = tmp_path / "season"
    (season / "circle").mkdir(parents=True)
    clip = write_clip(season / "circle" / "1.mp4", frames=3)
    with zipfile.ZipFile(season / "circle" / "notes.zip", "w") as archive:
        archive.writestr("notes.txt", "no dive recording")
    (season / "circle" / "seen.csv").touch()
    (season / ".trash.mp4").write_bytes(b"\0\0\0\x18ftypmp42")
    clip.rename(clip := clip.with_name("1.LRV"))
    ended = osg_studio("extract", season, "--workers", 1, "--output", tmp_path / "copies")
    assert ended.code == 0, ended.error
    copy = tmp_path / "copies" / "circle" / "1.LRV.npz"
    assert ended.out == f"{clip}\t{copy}\n"
    assert "1 clips extracted, 0 known" in ended.error
    assert "left out, keypoints already: circle/seen.csv\n" in ended.error
    assert "left out, no clip by its first bytes: circle/notes.zip\n" in ended.error
    (recording,) = kept.iterdir()
    assert copy.read_bytes() == recording.read_bytes()
    written = recording.stat().st_mtime_ns
    (take,) = collect_takes(labelled_files(season), keep_in=kept).takes
    assert (take.label, len(take.poses)) == ("circle", 3)
    assert recording.stat().st_mtime_ns == written
    (season / "circle" / "2.mp4").write_bytes(b"\0\0\0\x18ftypmp42")
    ended = osg_studio("extract", season)
    assert ended.code == 1
    assert "2.mp4: the clip" in "".join(ended.error.splitlines())
    assert "0 clips extracted, 1 known from before, 1 failed" in ended.error


def test_a_folder_without_clips_is_refused_in_one_line(
    osg_studio: OsgStudio, tmp_path: Path
) -> None:
    ended = osg_studio("extract", tmp_path)
    assert ended.code == 2
    assert "holds no video" in ended.error
    assert ended.error.count("\n") == 1


@pytest.mark.slow
@pytest.mark.usefixtures("installed_models")
def test_clips_are_extracted_turned_and_kept_apart_from_those_that_are_not(
    osg_studio: OsgStudio, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    kept = tmp_path / "kept"
    monkeypatch.setattr("app.cli.extract.recordings_dir", lambda: kept)
    season = tmp_path / "season"
    season.mkdir()
    write_clip(season / "1.mp4", frames=3)
    sizes = []
    for turn in (0, 90):
        ended = osg_studio("extract", season, "--workers", 1, "--turn", turn)
        assert ended.code == 0, ended.error
        sizes.append(Recording.load(ended.out.rstrip().split("\t")[1]).poses.frame_size)
    assert sizes == [(64, 48), (48, 64)]
