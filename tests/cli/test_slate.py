"""`osg-studio slate`: a page as PDF or SVG, by the file's ending."""

from pathlib import Path

from tests.command_line import OsgStudio
from tests.conftest import ROOT

LANGUAGE = ROOT / "languages" / "osg-table-1.json"


def test_the_ending_chooses_the_format(osg_studio: OsgStudio, tmp_path: Path) -> None:
    for name, begins in (("slate.pdf", b"%PDF-"), ("slate.svg", b"<?xml")):
        file = tmp_path / name
        assert osg_studio("slate", LANGUAGE, "--output", file).code == 0
        assert file.read_bytes().startswith(begins)


def test_other_endings_and_folders_that_are_not_there_are_refused(
    osg_studio: OsgStudio, tmp_path: Path
) -> None:
    ended = osg_studio("slate", LANGUAGE, "--output", tmp_path / "slate.png")
    assert (ended.code, "as .pdf or .svg" in ended.error) == (2, True)
    assert osg_studio("slate", LANGUAGE, "--output", tmp_path / "none" / "slate.svg").code == 2
