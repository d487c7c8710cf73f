"""Control of a run: what signals and uploads may do, and when."""

from __future__ import annotations

import signal
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import pytest

from app.cli.robots.run import Control, handle_signals
from app.recognition.phrases.grammar import Grammar
from app.recognition.phrases.phrase import OneOf, Phrase
from app.recognition.triggers.trigger import Trigger, TriggerKind
from tests.command_line import OsgStudio
from tests.recognition.damaged_clips import write_clip
from tests.robot.languages import language_of
from tests.robot.mavlink.diver import diving
from tests.robot.mavlink.vehicle import sailing

pytest.importorskip("pymavlink", reason="needs the extra mavlink")


class Stoppable:
    """A runtime and a watcher that are only stopped."""

    stopped = False

    def stop(self) -> None:
        self.stopped = True


def test_a_vehicle_table_is_not_replaced_during_an_emergency() -> None:
    control, run = Control(), Stoppable()
    with diving() as diver:
        control.begin(cast("Any", run), cast("Any", run), diver.bridge)
        assert control.find_obstacle("vehicle") == ""
        diver.vehicle.is_slow = True
        diver.show("help")
        assert control.find_obstacle("vehicle").startswith("an emergency is in progress")
        assert control.find_obstacle("language") == ""
        diver.vehicle.is_slow = False
        diver.wait_for("done: surface")
        assert control.find_obstacle("vehicle") == ""
    control.take_file("vehicle")
    assert run.stopped


@pytest.mark.parametrize("first", [signal.SIGINT, signal.SIGTERM])
def test_a_second_signal_of_any_kind_ends_at_once(first: signal.Signals) -> None:
    before = [signal.getsignal(kind) for kind in (signal.SIGINT, signal.SIGTERM)]
    stops: list[bool] = []
    with handle_signals(lambda: stops.append(True), lambda: None):
        assert signal.getsignal(first) not in before
        signal.raise_signal(first)
        after = [signal.getsignal(kind) for kind in (signal.SIGINT, signal.SIGTERM)]
    assert stops == [True]
    assert after == before


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
@pytest.mark.parametrize("trigger", ["none", "salute"])
def test_without_salutes_no_gesture_alone_moves_a_vehicle(
    osg_studio: OsgStudio, tmp_path: Path, command: list[str], trigger: TriggerKind
) -> None:
    pytest.importorskip("pymavlink", reason="needs the extra mavlink")
    made = replace(language_of("circle", "line"), trigger=Trigger(trigger))
    made.save(tmp_path / "pool.json")
    (tmp_path / "vehicle.toml").write_text(TABLE.format(label="circle"))
    table = str(tmp_path / "vehicle.toml")
    options = ["--mavlink", "udpout:127.0.0.1:14550", "--vehicle", table]
    switch = ["--without-salutes"] if trigger == "salute" else []
    ended = osg_studio(*command, *switch, *options)
    assert (ended.code, ended.out) == (2, "")
    assert "no commands without salutes: there are no phrases" in ended.error
    photo = Phrase("photo", (OneOf(("line",)),), {}, "take a photo")
    replace(made, grammar=Grammar((photo,))).save(tmp_path / "pool.json")
    assert "circle would act alone" in osg_studio(*command, *switch, *options).error
    (tmp_path / "vehicle.toml").write_text(
        TABLE.partition("[gestures]")[0] + '[phrases]\nphoto = { do = "camera" }\n'
    )
    ended = osg_studio(*command, *switch, *options)
    assert ended.code == 1  # nothing was recognised in a clip that shows nobody


@pytest.mark.usefixtures("installed_models")
def test_a_key_that_is_missing_or_that_mavlink2rest_cannot_use_is_one_line(
    osg_studio: OsgStudio, tmp_path: Path, command: list[str]
) -> None:
    pytest.importorskip("pymavlink", reason="needs the extra mavlink")
    table = tmp_path / "vehicle.toml"
    table.write_text(TABLE.format(label="circle") + '[vehicle]\nkey_file = "vehicle.key"\n')
    ended = osg_studio(*command, "--mavlink", "udpout:127.0.0.1:14550", "--vehicle", table)
    assert (ended.code, ended.error.count("\n")) == (2, 1)
    assert "vehicle.key" in ended.error
    (tmp_path / "vehicle.key").write_text("a passphrase\n")
    ended = osg_studio(*command, "--mavlink", "http://127.0.0.1:6040", "--vehicle", table)
    assert (ended.code, ended.error.count("\n")) == (2, 1)
    assert "mavlink2rest signs no messages" in ended.error


def test_the_page_takes_files_only_where_there_is_one(
    osg_studio: OsgStudio, command: list[str]
) -> None:
    ended = osg_studio(*command, "--upload")
    assert ended.code == 2
    assert "--upload needs --page" in " ".join(ended.error.split())


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


ANSWERS = """
format = "osg-studio/vehicle-table"
version = 1
[gestures]
circle = { do = "hold" }
[answers]
show = ["lights"]
"""


@pytest.mark.slow
def test_the_answers_are_tried_on_the_bench(
    osg_studio: OsgStudio, tmp_path: Path, command: list[str]
) -> None:
    table = tmp_path / "vehicle.toml"
    table.write_text(ANSWERS)
    with sailing() as vehicle:
        link = ("--mavlink", f"udpout:127.0.0.1:{vehicle.port}", "--vehicle", table)
        ended = osg_studio(*command, *link, "--answers", "try")
    assert (ended.code, ended.out) == (0, "")
    assert [line[0] for line in ended.error.splitlines()] == ["1", "2", "3", "4", "5"]
    assert len(vehicle.shown) == 2 * (1 + 2 + 3 + 4 + 5)
    assert vehicle.pulse == vehicle.lights


def test_answers_that_cannot_be_tried_are_one_line(
    osg_studio: OsgStudio, tmp_path: Path, command: list[str]
) -> None:
    table = tmp_path / "vehicle.toml"
    table.write_text(TABLE.format(label="circle"))
    ended = osg_studio(*command, "--answers", "try")
    assert "--answers needs --mavlink and --vehicle" in " ".join(ended.error.split())
    link = ("--mavlink", "udpout:127.0.0.1:14550", "--vehicle", table)
    ended = osg_studio(*command, *link, "--answers", "try")
    assert (ended.code, ended.error.count("\n")) == (2, 1)
    assert "has no [answers]" in ended.error


def test_the_profile_of_stages_names_its_benchmark(osg_studio: OsgStudio) -> None:
    ended = osg_studio("robot", "--language", "language.json", "--profile-stages")
    assert ended.code == 2
    assert "benchmarks.cost.stages in a clone" in " ".join(ended.error.split())
