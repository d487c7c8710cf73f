"""Commands on language files: code, slate, samples."""

from pathlib import Path

from app.cli.robots.channels import describe_event
from app.robot.active_language import ActiveLanguage
from app.robot.events import LanguageChanged
from tests.command_line import OsgStudio
from tests.conftest import ROOT
from tests.recognition.demonstrations import pool
from tests.recognition.strategies import circle


def test_the_code_is_the_robots(osg_studio: OsgStudio, tmp_path: Path) -> None:
    file = tmp_path / "pool.json"
    pool(circle=circle).save(file)
    ended = osg_studio("code", file)
    assert ended.code == 0
    code = ended.out.strip()
    active = ActiveLanguage.load(file)
    started = LanguageChanged(
        time=0.0,
        name=active.name,
        sha256=active.sha256,
        revision=active.revision,
        gestures=("circle",),
        profile="full",
        tuning="",
    )
    assert started.code == code
    assert f"code {code}" in describe_event(started)


def test_a_file_that_is_no_language_is_refused(osg_studio: OsgStudio, tmp_path: Path) -> None:
    file = tmp_path / "none.json"
    file.write_text("{}")
    assert osg_studio("code", file).code == 2


LANGUAGE = ROOT / "languages" / "osg-table-1.json"


def test_the_ending_chooses_the_format(osg_studio: OsgStudio, tmp_path: Path) -> None:
    for name, begins in (("slate.pdf", b"%PDF-"), ("slate.svg", b"<?xml")):
        file = tmp_path / name
        assert osg_studio("slate", LANGUAGE, "--output", file).code == 0
        assert file.read_bytes().startswith(begins)


def test_a_slate_has_the_answers_of_a_vehicle_table(osg_studio: OsgStudio, tmp_path: Path) -> None:
    table, file = tmp_path / "vehicle.toml", tmp_path / "slate.svg"
    head = (
        'format = "osg-studio/vehicle-table"\nversion = 1\n[gestures]\ncircle = { do = "hold" }\n'
    )
    table.write_text(head)
    command = ("slate", LANGUAGE, "--output", file, "--vehicle", table)
    assert "has no [answers]" in osg_studio(*command).error
    table.write_text(head + '[answers]\nshow = ["tilt"]\ndone = 7\n')
    assert osg_studio(*command).code == 0
    words = ["listening", "show it again", "which of two?", "not understood, not done", "done"]
    text = file.read_text("utf-8")
    assert [text.index(f">{each}<") for each in words] == sorted(
        text.index(f">{each}<") for each in words
    )


def test_other_endings_and_folders_that_are_not_there_are_refused(
    osg_studio: OsgStudio, tmp_path: Path
) -> None:
    ended = osg_studio("slate", LANGUAGE, "--output", tmp_path / "slate.png")
    assert (ended.code, "as .pdf or .svg" in ended.error) == (2, True)
    assert osg_studio("slate", LANGUAGE, "--output", tmp_path / "none" / "slate.svg").code == 2


def test_the_samples_are_copied_and_nothing_is_written_over(
    osg_studio: OsgStudio, tmp_path: Path
) -> None:
    folder = tmp_path / "languages"
    assert osg_studio("samples", folder).code == 0
    for name in ("osg-table-2.json", "clips/line-test-1.mp4"):
        assert (folder / name).read_bytes() == (ROOT / "languages" / name).read_bytes()
    assert {path.suffix for path in folder.rglob("*") if path.is_file()} == {".json", ".mp4"}
    again = osg_studio("samples", folder)
    assert again.code == 2
    assert "is there already" in again.error
