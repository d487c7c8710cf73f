"""`osg-studio recognize FOLDER`: one table of all clips, which goes on where it was interrupted."""

from __future__ import annotations

import csv
import shutil
from pathlib import Path

import pytest

from app.cli import clip_argument
from tests.command_line import OsgStudio
from tests.keypoint_files.files import write_named
from tests.recognition.damaged_clips import write_clip
from tests.recognition.demonstrations import pool
from tests.recognition.strategies import circle, line, recording


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder of two clips, one in a folder of its own, and a file that is none."""
    dives = tmp_path / "dives"
    (dives / "day 2").mkdir(parents=True)
    write_named(dives / "a.csv", recording(circle, frames=50, jitter=0.005))
    write_named(dives / "day 2" / "b.csv", recording(line, frames=50, jitter=0.005))
    (dives / "damaged.csv").write_text("hello\n")
    (dives / "notes.txt").write_text("visibility 5 m")
    pool(circle=circle, line=line).save(tmp_path / "pool.json")
    return dives


@pytest.fixture
def command(folder: Path) -> list[str]:
    language = str(folder.parent / "pool.json")
    table = str(folder / "takes.csv")
    return ["recognize", str(folder), "--language", language, "--table", table]


def read(table: Path) -> list[dict[str, str]]:
    with table.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_every_clip_is_in_the_table_with_its_faults(
    osg_studio: OsgStudio, folder: Path, command: list[str]
) -> None:
    ended = osg_studio(*command)
    assert ended.code == 0, ended.error
    rows = read(folder / "takes.csv")
    assert [(row["clip"], row["take"], row["label"]) for row in rows] == [
        ("a.csv", "1", "circle"),
        ("damaged.csv", "", ""),
        ("day 2/b.csv", "1", "line"),
    ]
    assert rows[1]["faults"]
    assert 0 < float(rows[0]["confidence"]) <= 1
    assert rows[0]["closed"] == "true"
    assert {row["language"] for row in rows} == {"pool"}
    assert "3/3 day 2/b.csv: line" in ended.error
    assert "3 clips, 2 gestures recognised" in ended.error
    assert "left out, no clip by its first bytes: notes.txt\n" in ended.error


def test_copies_of_a_clip_are_not_counted_again(
    osg_studio: OsgStudio, folder: Path, command: list[str]
) -> None:
    clip = write_clip(folder / "clip.mp4").rename(folder / "GL010042.LRV")
    shutil.copy(clip, folder / "dive.mp4.part")
    for name in ("GX010042.MP4", "dive.mp4"):  # damaged, so that the test is fast
        (folder / name).write_bytes(b"\0\0\0\x18ftypmp42")
    ended = osg_studio(*command)
    clips = {row["clip"] for row in read(folder / "takes.csv")}
    assert {"GX010042.MP4", "dive.mp4"} < clips
    assert not {"GL010042.LRV", "dive.mp4.part"} & clips
    copies = "GL010042.LRV, dive.mp4.part"
    assert f"left out, a small or unfinished copy of a clip: {copies}\n" in ended.error


def test_a_batch_of_nothing_but_pairs_recognises_nothing(
    osg_studio: OsgStudio, folder: Path, command: list[str]
) -> None:
    pool(circle=circle, ring=circle).save(folder.parent / "pool.json")
    (folder / "day 2" / "b.csv").unlink()
    ended = osg_studio(*command)
    assert ended.code == 1
    assert "a.csv: circle or ring?" in ended.error
    rows = read(folder / "takes.csv")
    assert (rows[0]["label"], rows[0]["pair"]) == ("", "circle or ring")


def test_an_interrupted_batch_goes_on(
    osg_studio: OsgStudio, folder: Path, command: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    read_clip, seen = clip_argument.read_clip, []

    def interrupt(clip: Path, *how: object) -> clip_argument.ReadClip:
        seen.append(clip.name)
        if clip.name == "b.csv":
            raise KeyboardInterrupt
        return read_clip(clip, *how)  # type: ignore[arg-type]

    monkeypatch.setattr(clip_argument, "read_clip", interrupt)
    assert osg_studio(*command).code != 0
    assert not (folder / "takes.csv").exists()
    monkeypatch.setattr(clip_argument, "read_clip", read_clip)
    journal = folder / "takes.csv.journal"
    journal.write_bytes(journal.read_bytes() + b'{"clip": "day 2/b')  # a crash cuts a line
    ended = osg_studio(*command)
    assert seen == ["a.csv", "damaged.csv", "b.csv"]
    assert "2 of 3 clips are done already" in ended.error
    assert "1/1 day 2/b.csv: line" in ended.error
    assert [row["label"] for row in read(folder / "takes.csv")] == ["circle", "", "line"]


def test_a_clip_that_changed_and_another_language_are_recognised_again(
    osg_studio: OsgStudio, folder: Path, command: list[str]
) -> None:
    osg_studio(*command)
    write_named(folder / "a.csv", recording(line, frames=60, jitter=0.005))
    again = osg_studio(*command)
    assert "2 of 3 clips are done already" in again.error
    assert read(folder / "takes.csv")[0]["label"] == "line"
    pool(circle=circle).save(folder.parent / "pool.json")
    anew = osg_studio(*command)
    assert "begun anew" in anew.error
    assert "done already" not in anew.error


def test_a_table_can_be_parquet(osg_studio: OsgStudio, folder: Path, command: list[str]) -> None:
    parquet = pytest.importorskip("pyarrow.parquet", reason="needs the extra parquet")
    command[-1] = str(folder / "takes.parquet")
    assert osg_studio(*command).code == 0
    table = parquet.read_table(folder / "takes.parquet")
    assert table.column("label").to_pylist() == ["circle", None, "line"]
    assert table.column("take").to_pylist() == [1, None, 1]
    assert str(table.schema.field("start").type) == "double"


def test_what_a_spreadsheet_would_run_is_text(osg_studio: OsgStudio, folder: Path) -> None:
    language = folder.parent / "formula.json"
    pool(**{"=1+1": circle}).save(language)
    table = folder / "takes.csv"
    osg_studio("recognize", folder, "--language", language, "--table", table)
    assert read(table)[0]["nearest"] == "'=1+1"


@pytest.mark.parametrize(
    ("options", "what"),
    [
        (["--json"], "are for one clip"),
        (["--expected", "circle"], "are for one clip"),
        (["--table", "takes.xls"], "end its name in .csv or .parquet"),
        (["--table", "absent/takes.csv"], "absent is no folder"),
    ],
)
def test_bad_use_is_one_line(
    osg_studio: OsgStudio, command: list[str], options: list[str], what: str
) -> None:
    ended = osg_studio(*command, *options)
    assert (ended.code, ended.out) == (2, "")
    assert what in ended.error


def test_a_folder_without_clips_is_refused(
    osg_studio: OsgStudio, tmp_path: Path, command: list[str]
) -> None:
    (tmp_path / "empty").mkdir()
    command[1] = str(tmp_path / "empty")
    ended = osg_studio(*command)
    assert ended.code == 2
    assert "give the folder that holds one of them, or a folder of clips" in ended.error
