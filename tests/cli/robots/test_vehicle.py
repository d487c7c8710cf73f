"""`osg-studio robot --mavlink`: bad use is one line, and a dive gives the vehicle its commands."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.command_line import OsgStudio
from tests.recognition.damaged_clips import write_clip
from tests.robot.languages import language_of

TABLE = """
format = "osg-studio/vehicle-table"
version = 1
[gestures]
{label} = {{ do = "hold" }}
"""


@pytest.fixture
def command(tmp_path: Path) -> list[str]:
    language_of("circle").save(tmp_path / "pool.json")
    clip = write_clip(tmp_path / "dive.mp4", frames=2)
    return ["robot", "--language", str(tmp_path / "pool.json"), "--source", str(clip)]


def test_the_two_options_need_each_other(osg_studio: OsgStudio, command: list[str]) -> None:
    ended = osg_studio(*command, "--mavlink", "udpout:127.0.0.1:14550")
    assert ended.code == 2
    assert "--mavlink and --vehicle need each other" in " ".join(ended.error.split())


@pytest.mark.usefixtures("installed_models")
@pytest.mark.parametrize(
    ("label", "address", "what"),
    [
        ("wave", "udpout:127.0.0.1:14550", "gestures.wave is not in the language 'pool'"),
        ("circle", "serial:1", "no address of a vehicle"),
    ],
)
def test_what_does_not_fit_is_one_line(
    osg_studio: OsgStudio, tmp_path: Path, command: list[str], label: str, address: str, what: str
) -> None:
    pytest.importorskip("pymavlink", reason="needs the extra mavlink")
    (tmp_path / "vehicle.toml").write_text(TABLE.format(label=label))
    ended = osg_studio(*command, "--mavlink", address, "--vehicle", tmp_path / "vehicle.toml")
    assert (ended.code, ended.out) == (2, "")
    assert ended.error.startswith("osg-studio: ")
    assert what in ended.error
    assert ended.error.count("\n") == 1


@pytest.mark.usefixtures("installed_models")
def test_without_its_library_it_is_said_what_to_install(
    osg_studio: OsgStudio, tmp_path: Path, command: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in [each for each in sys.modules if each.startswith("app.robot.mavlink.")]:
        monkeypatch.delitem(sys.modules, name)
    for name in ["pymavlink", *(each for each in sys.modules if each.startswith("pymavlink."))]:
        monkeypatch.setitem(sys.modules, name, None)
    table = tmp_path / "vehicle.toml"
    ended = osg_studio(*command, "--mavlink", "udpout:127.0.0.1:14550", "--vehicle", table)
    assert ended.code == 2
    assert 'pip install "osg-studio[mavlink]"' in ended.error


@pytest.mark.slow
def test_a_gesture_in_a_clip_commands_a_vehicle(
    osg_studio: OsgStudio,
    tmp_path: Path,
    sample_clips: Path,
    thin_clip: Callable[[str], Path],
) -> None:
    pytest.importorskip("pymavlink", reason="needs the extra mavlink")
    from tests.robot.mavlink.vehicle import sailing

    table = tmp_path / "vehicle.toml"
    table.write_text(
        'format = "osg-studio/vehicle-table"\nversion = 1\n[emergency]\nline = "surface"\n'
    )
    language = sample_clips.parent / "osg-table-2.json"
    dive = ("robot", "--language", language, "--source", thin_clip("line-test-1"))
    with sailing(loss=0.2) as vehicle:
        bridge = ("--mavlink", f"udpout:127.0.0.1:{vehicle.port}", "--vehicle", table)
        ended = osg_studio(*dive, *bridge)
    assert ended.code == 0
    assert "vehicle: done: surface" in ended.error
    assert vehicle.obeyed == ["SURFACE"]
