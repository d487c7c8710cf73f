"""Service units: restart, watchdog, and commands that exist."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from collections import defaultdict
from collections.abc import Callable
from pathlib import Path

import pytest
from typer.main import get_command

from app.cli.application import command_line
from app.robot.runtime import HEARTBEAT_SECONDS
from tests.conftest import ROOT
from tests.documented import PAGES

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


SERVICE = (ROOT / "docs" / "robots" / "service.md").read_text(encoding="utf-8")
STATE = "/var/lib/osg"
READ_ONLY = """
mount --make-rprivate / && mount --bind "$STATE" "$STATE" && mount --bind "$TMPDIR" "$TMPDIR" &&
mount -o remount,bind,ro / && cd / && exec "$@"
"""
"""Shell script that starts a command as `ProtectSystem=strict` and `PrivateTmp` do."""


def test_a_page_that_commands_a_vehicle_installs_what_that_needs() -> None:
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        installed = re.findall(r"install .*osg-studio\[(.*?)\]", text)
        if installed and re.search(r"^.*(osg-studio robot|OSG_OPTIONS=).*--mavlink ", text, re.M):
            assert any("mavlink" in extras.split(",") for extras in installed), page


@pytest.mark.parametrize("unit", UNITS, ids=lambda unit: unit.stem)
def test_a_service_leaves_memory_and_processor_to_others(unit: Path) -> None:
    values = read(unit)
    assert int(values["CPUWeight"][0]) < 100
    assert values["MemoryMax"][0].endswith("%")


def is_able_to_mount() -> bool:
    tried = ["unshare", "--map-root-user", "--mount", "mount", "-o", "remount,bind,ro", "/"]
    return bool(shutil.which("unshare")) and not subprocess.call(tried, stderr=subprocess.DEVNULL)


@pytest.mark.slow
@pytest.mark.skipif(not is_able_to_mount(), reason="needs namespaces of mounts")
def test_the_documented_robot_commands_a_vehicle_from_its_unit(
    tmp_path: Path, thin_clip: Callable[[str], Path], sample_clips: Path
) -> None:
    """The example's options in the unit's command, where the unit lets files be written alone."""
    pytest.importorskip("pymavlink", reason="needs the extra mavlink")
    from tests.robot.mavlink.vehicle import sailing

    (unit,) = [each for each in UNITS if each.stem == "osg-robot"]
    values = read(unit)
    assert values["StateDirectory"] == [STATE.removeprefix("/var/lib/")]
    state, private = tmp_path / "state", tmp_path / "private"
    state.mkdir()
    private.mkdir()
    variables = dict(each.split("=", 1) for each in shlex.split(values["Environment"][0]))
    variables |= dict(re.findall(r"^(OSG_\w+)=(.*)$", SERVICE, re.M))
    (table,) = re.findall(rf"--vehicle {STATE}/(\S+)", variables["OSG_OPTIONS"])
    shutil.copy(sample_clips.parent / "osg-table-2.json", state / "language.json")
    (state / "key").write_bytes(bytes(32))
    (state / table).write_text(
        'format = "osg-studio/vehicle-table"\nversion = 1\nemergency = { line = "surface" }\n'
        'vehicle = { key_file = "key" }\nanswers = { show = ["lights"] }\n'
    )
    with sailing(key=bytes(32)) as vehicle:
        command = values["ExecStart"][0].replace("$OSG_OPTIONS", variables["OSG_OPTIONS"])
        variables["OSG_SOURCE"] = str(thin_clip("line-test-1"))
        for name, value in variables.items():
            command = command.replace(f"${{{name}}}", value)
        command = re.sub(r"udpout:\S+", f"udpout:127.0.0.1:{vehicle.port}", command)
        arguments = shlex.split(command.replace(STATE, str(state)))[1:]
        run = subprocess.run(
            [
                *("unshare", "--map-root-user", "--mount", "sh", "-c", READ_ONLY, "sh"),
                *(sys.executable, "-m", "app", *arguments),
            ],
            env={
                **os.environ,
                "STATE": str(state),
                "TMPDIR": str(private),
                "PYTHONPATH": str(ROOT),
            },
            capture_output=True,
            text=True,
            check=False,
        )
    assert run.returncode == 0, run.stderr
    assert "cannot be written" not in run.stderr
    assert "SURFACE" in vehicle.obeyed
    assert (state / "key.time").exists()
    assert not (state / f"{table}.before").exists()
