"""`osg-studio code`: the code that the robot's start line shows too."""

from pathlib import Path

from app.cli.robots.events import describe_event
from app.robot.active_language import ActiveLanguage
from app.robot.events import LanguageChanged
from tests.command_line import OsgStudio
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
