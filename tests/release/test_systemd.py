"""Service units: restart, watchdog, and commands that exist."""

from __future__ import annotations

import shlex
import shutil
import subprocess
from collections import defaultdict
from pathlib import Path

import pytest
from typer.main import get_command

from app.cli.application import command_line
from app.robot.runtime import HEARTBEAT_SECONDS
from tests.conftest import ROOT

UNITS = sorted((ROOT / "release" / "systemd").glob("*.service"))
PROGRAM = "/opt/osg/bin/osg-studio"


def read(unit: Path) -> dict[str, list[str]]:
    """Return the values of each key of a unit, which may be repeated."""
    values = defaultdict(list)
    for line in unit.read_text(encoding="utf-8").splitlines():
        if "=" in line and not line.startswith("#"):
            key, _, value = line.partition("=")
            values[key].append(value)
    return values


def test_there_is_a_unit_for_robot_and_studio() -> None:
    assert [unit.stem for unit in UNITS] == ["osg-robot", "osg-studio"]


@pytest.mark.parametrize("unit", UNITS, ids=lambda unit: unit.stem)
def test_a_service_is_started_again_and_watched(unit: Path) -> None:
    values = read(unit)
    assert values["Type"] == ["notify"]
    assert values["Restart"] == ["always"]
    assert int(values["WatchdogSec"][0]) > 2 * HEARTBEAT_SECONDS
    assert values["User"] != ["root"]
    assert values["ProtectSystem"] == ["strict"]


@pytest.mark.parametrize("unit", UNITS, ids=lambda unit: unit.stem)
def test_what_it_starts_is_a_command(unit: Path) -> None:
    (started,) = read(unit)["ExecStart"]
    program, name, *arguments = shlex.split(started)
    assert program == PROGRAM
    group = get_command(command_line)
    with group.make_context("osg-studio", [name], resilient_parsing=True) as context:
        command = group.get_command(context, name)  # type: ignore[attr-defined]
    options = [each for each in arguments if each != "$OSG_OPTIONS"]
    command.make_context(name, options)


@pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="needs systemd-analyze")
@pytest.mark.parametrize("unit", UNITS, ids=lambda unit: unit.stem)
def test_systemd_understands_it(unit: Path, tmp_path: Path) -> None:
    copy = tmp_path / unit.name
    # The program is not where the unit says on this machine.
    copy.write_text(unit.read_text(encoding="utf-8").replace(PROGRAM, "/bin/true"))
    verified = subprocess.run(
        ["systemd-analyze", "verify", "--man=no", copy], capture_output=True, text=True, check=False
    )
    assert [line for line in verified.stderr.splitlines() if unit.stem in line] == []
