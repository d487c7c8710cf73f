"""Chapters of one recording, named on the command line."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from app.recognition import Recording
from app.recognition.recording.video import probe
from tests.command_line import OsgStudio
from tests.conftest import ROOT
from tests.recognition.damaged_clips import write_clip
from tests.short_clips import in_chapters

LANGUAGE = ROOT / "languages" / "osg-table-2.json"


@pytest.mark.slow
def test_a_take_across_two_chapters_is_read_from_their_folder(
    osg_studio: OsgStudio, thin_clip: Callable[[str], Path], tmp_path: Path
) -> None:
    folder = tmp_path / "dive"
    folder.mkdir()
    names = ("GX010042.MP4", "GX020042.MP4")
    first, _ = in_chapters(thin_clip("line-test-2"), *(folder / name for name in names))
    ended = osg_studio("recognize", first, "--language", LANGUAGE)
    assert ended.code == 1
    assert "may go on in GX020042.MP4" in " ".join(ended.error.split())
    ended = osg_studio("recognize", folder, "--language", LANGUAGE)
    assert ended.code == 0, ended.error
    assert ended.out.split("\t")[2] == "line"


@pytest.mark.slow
@pytest.mark.usefixtures("installed_models")
def test_chapters_are_extracted_as_one_clip_once_they_lie_alone(
    osg_studio: OsgStudio, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.cli.extract.recordings_dir", lambda: tmp_path / "kept")
    season = tmp_path / "season"
    (season / "dive").mkdir(parents=True)
    for number, frames in ((1, 4), (2, 3)):
        write_clip(season / "dive" / f"GX0{number}0042.MP4", frames=frames)
    other = write_clip(season / "dive" / "other.mp4", frames=2)
    ended = osg_studio("extract", season, "--workers", 1)
    assert len(ended.out.splitlines()) == 3
    other.unlink()
    ended = osg_studio("extract", season, "--workers", 1, "--output", tmp_path / "copies")
    assert ended.out == f"{season / 'dive'}\t{tmp_path / 'copies' / 'dive.npz'}\n"
    assert len(Recording.load(tmp_path / "copies" / "dive.npz").poses) == 7
    ended = osg_studio("extract", season, "--workers", 1)
    assert "0 clips extracted, 1 known from before" in ended.error


def test_a_session_of_chapters_shows_their_pictures(tmp_path: Path) -> None:
    from app.clip_sources import ReadOptions, source_of

    folder = tmp_path / "dive"
    folder.mkdir()
    for number in (1, 2):
        write_clip(folder / f"GX0{number}0042.MP4", frames=5)
    source = source_of(folder)
    copy = tmp_path / "copy"
    assert source.playable_video(folder, ReadOptions(), copy) == copy
    assert probe(copy).frames == 10
    assert source.playable_video(folder, ReadOptions(turn=90), copy) == copy
    assert (probe(copy).frames, probe(copy).width) == (10, 48)
