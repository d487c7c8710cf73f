"""`osg-studio samples`: an installed package brings what the documentation's commands use."""

from pathlib import Path

from tests.command_line import OsgStudio
from tests.conftest import ROOT


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
