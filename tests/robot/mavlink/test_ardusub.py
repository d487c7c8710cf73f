"""Versions of ArduSub: what each takes is done, and what it refuses is told."""

from __future__ import annotations

import re
from itertools import product
from typing import get_args

import pytest

pytest.importorskip("pymavlink", reason="needs the extra mavlink")

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from app.robot.mavlink.actions import describe_refusal
from app.robot.mavlink.table import Mode, parse_vehicle_table
from tests.conftest import ROOT
from tests.robot.mavlink.diver import TABLE, diving
from tests.robot.mavlink.vehicle import MODES, needs_position

PAGE = (ROOT / "docs" / "robots" / "mavlink.md").read_text(encoding="utf-8")
VERSIONS = [(4, 0, 3), (4, 1, 2), (4, 5, 3), (4, 6, 0), (4, 7, 0)]


def number_of(version: tuple[int, int, int]) -> int:
    return version[0] << 24 | version[1] << 16 | version[2] << 8


@pytest.mark.parametrize("version", VERSIONS)
def test_what_a_version_refuses_is_known_before_it_is_asked(version: tuple[int, int, int]) -> None:
    for mode in get_args(Mode.model_fields["mode"].annotation):
        told = describe_refusal(mode, number_of(version))
        assert told.endswith("only with a position") == needs_position(mode, version)
        assert told.endswith(f"has no {mode}") == (mode == "SURFTRAK" and version < (4, 5, 0))
        assert mode in MODES.values()


def test_the_examples_emergency_ends_with_what_every_version_takes() -> None:
    block = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)[0]
    example = parse_vehicle_table(block.encode(), "vehicle.toml")
    assert example.emergency
    for emergency, version in product(example.emergency.values(), VERSIONS):
        assert not describe_refusal(emergency[-1].mode, number_of(version))
    assert any(len(emergency) > 1 for emergency in example.emergency.values())


def test_what_the_vehicle_will_refuse_is_told_at_the_start() -> None:
    told = "ArduSub 4.5 takes SURFACE only with a position"
    with diving(version=(4, 5, 3)) as diver:
        assert diver.wait_for("ArduSub") == told
    assert told in diver.vehicle.texts


def test_an_emergency_that_a_version_refuses_is_followed_by_the_next_one() -> None:
    either = {"emergency": {"help": ["surface", "hold"]}, "answers": {"show": ["lights"]}}
    with diving(changes=either, version=(4, 5, 3)) as diver:
        diver.show("help")
        assert diver.wait_for("EMERGENCY") == "EMERGENCY: surface, else hold"
        assert diver.wait_for("refused", "done") == "refused (FAILED), now hold: surface"
        assert diver.wait_for("refused", "done") == "done: hold"
    assert diver.vehicle.obeyed[:1] == ["ALT_HOLD"]


@pytest.mark.parametrize("version", [(4, 0, 3), (4, 1, 2), (4, 5, 3), (4, 7, 0)])
def test_a_depth_is_reached_by_every_version_of_ardusub(version: tuple[int, int, int]) -> None:
    with diving(version=version) as diver:
        diver.confirm("deep")
        assert diver.wait_for("done", "NOT DONE") == "done: depth 5 m"
        # A pilot's GUIDED meanwhile must not make the vehicle swim anywhere.
        diver.confirm("free")
        diver.wait_for("done")
        diver.vehicle.pilot = mavlink.SUB_MODE_GUIDED
        diver.confirm("deep")
        assert diver.wait_for("done", "NOT DONE").startswith("NOT DONE")
    assert diver.vehicle.obeyed[:2] == ["ALT_HOLD", "depth 5"]
    assert not [each for each in diver.vehicle.obeyed if each.startswith("swims")]


@pytest.mark.parametrize(
    ("version", "mode", "said"),
    [
        ((4, 5, 3), "SURFACE", "refused (FAILED)"),
        ((4, 1, 2), "SURFACE", "done"),
        ((4, 7, 0), "SURFACE", "done"),
        ((4, 7, 0), "POSHOLD", "refused (FAILED)"),
        ((4, 7, 0), "SURFTRAK", "done"),
        ((4, 0, 3), "SURFTRAK", "refused (UNSUPPORTED)"),
    ],
)
def test_what_ardusub_refuses_is_told_as_refused(
    version: tuple[int, int, int], mode: str, said: str
) -> None:
    modes = {"gestures": {**TABLE["gestures"], "free": {"do": "mode", "mode": mode}}}
    with diving(changes=modes, version=version) as diver:
        diver.confirm("free")
        assert diver.wait_for("done", "refused", "NOT DONE").startswith(f"{said}: ")


def test_lights_with_a_function_of_their_own_are_told_as_refused() -> None:
    with diving(function=181) as diver:  # Lights1
        diver.confirm("bright")
        assert diver.wait_for("done", "refused") == "refused (FAILED): lights 50 %"
