"""Vehicle table: closed, and an error in it is reported with its key."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import get_args

import pytest
from pydantic import ValidationError

from app.recognition.errors import VehicleError
from app.recognition.phrases.grammar import Grammar
from app.recognition.phrases.phrase import OneOf, Phrase
from app.robot.commands.replies import Reply
from app.robot.mavlink.table import (
    Camera,
    Depth,
    Hold,
    Lights,
    Mode,
    Replies,
    Surface,
    VehicleTable,
    read_vehicle_table,
)
from tests.conftest import ROOT
from tests.robot.languages import language_of

KINDS = (Hold, Surface, Mode, Lights, Camera, Depth)

HEAD = 'format = "osg-studio/vehicle-table"\nversion = 1\n'


def read(tmp_path: Path, text: str) -> VehicleTable:
    file = tmp_path / "vehicle.toml"
    file.write_text(HEAD + text)
    return read_vehicle_table(file)


def test_an_action_of_a_table_cannot_be_changed() -> None:
    depth = Depth(do="depth", metres=2.0)
    with pytest.raises(ValidationError, match="frozen"):
        depth.metres = 20.0


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("", "it has no action"),
        ("[gestures", "cannot be read"),
        ('[gestures]\na = { do = "arm" }', "gestures.a"),
        ('[gestures]\na = { do = "mode", mode = "ACRO" }', "gestures.a.mode.mode"),
        ('[gestures]\na = { do = "hold", fast = true }', "gestures.a.hold.fast: Extra inputs"),
        ('[gestures]\na = { do = "lights", percent = 101 }', "less than or equal to 100"),
        ('[gestures]\na = { do = "depth", metres = -1 }', "gestures.a.depth.metres"),
        ('[gestures]\na = { do = "depth", metres = 31 }', "deeper than 30"),
        ('[gestures]\na = { do = "depth", metres = { slot = "m" } }', "has no slots; give metres"),
        ('[emergency]\na = "camera"', "emergency.a: Input should be 'hold' or 'surface'"),
        ("[emergency]\na = []", "emergency.a: Input should be 'hold' or 'surface'"),
        ('[emergency]\na = ["hold", {}]', "emergency.a: Input should be 'hold' or 'surface'"),
        ('[gestures]\na = { do = "hold" }\n[emergency]\na = "hold"', "['a'] have two meanings"),
        ('cancel = ["a"]\n[gestures]\na = { do = "hold" }', "['a'] have two meanings"),
        ('[gestures]\na = { do = "hold" }\n[vehicle]\nsystem = 256', "vehicle.system"),
        ('confirm_seconds = "20"\n[emergency]\na = "hold"', "confirm_seconds"),
        ('least_confidence = true\n[emergency]\na = "hold"', "least_confidence"),
        ('stale_seconds = inf\n[emergency]\na = "hold"', "stale_seconds"),
        ('emergency_confidence = nan\n[emergency]\na = "hold"', "emergency_confidence"),
        ('[gestures]\na = { do = "depth", metres = true }', "gestures.a.depth.metres"),
        ('[gestures]\na = { do = "lights", percent = "80" }', "gestures.a.lights.percent"),
        ('confirmed = false\n[gestures]\na = { do = "hold" }', "confirmed: Extra inputs"),
    ],
)
def test_a_wrong_table_is_refused_by_its_key(tmp_path: Path, text: str, what: str) -> None:
    with pytest.raises(VehicleError) as refused:
        read(tmp_path, text)
    assert what in str(refused.value)
    assert "vehicle.toml" in str(refused.value)
    assert "\n" not in str(refused.value).partition("cannot be read")[0]


def test_the_documented_table_is_one(tmp_path: Path) -> None:
    page = (ROOT / "docs" / "robots" / "mavlink.md").read_text(encoding="utf-8")
    block, answers = re.findall(r"```toml\n(.*?)```", page, re.DOTALL)
    file = tmp_path / "vehicle.toml"
    file.write_text(block)
    assert len(read_vehicle_table(file).gestures) == 5
    file.write_text(block + answers)
    assert read_vehicle_table(file).answers == Replies(show=("lights",))
    listed = re.findall(r"^\| `(\w+)` \| (\d) \|", page, re.MULTILINE)
    assert listed == [(answer.value, str(answer.pulses)) for answer in Reply]
    actions = set(re.findall(r"^\| `(\w+)` \| (?:`MAV|the same|`ALT)", page, re.MULTILINE))
    assert actions == {get_args(kind.model_fields["do"].annotation)[0] for kind in KINDS}


def test_toml_and_json_say_the_same(tmp_path: Path) -> None:
    table = read(tmp_path, 'cancel = ["no"]\n[gestures]\ndown = { do = "depth", metres = 5 }')
    file = tmp_path / "vehicle.json"
    down = {"do": "depth", "metres": 5}
    content = {"format": "osg-studio/vehicle-table", "version": 1, "gestures": {"down": down}}
    file.write_text(json.dumps(content | {"cancel": ["no"]}))
    assert read_vehicle_table(file) == table
    assert table.find_actions("down") == (Depth(do="depth", metres=5),)
    assert table.find_actions("no") == ()


def test_emergencies_are_actions_that_need_no_repetition(tmp_path: Path) -> None:
    table = read(tmp_path, '[emergency]\nhelp = "hold"\nup = ["surface", "hold"]')
    assert table.find_actions("help") == (Hold(),)
    assert table.find_actions("up") == (Surface(), Hold())
    assert table.rules.emergency == {"help", "up"}
    assert table.rules.confirmed


@pytest.mark.parametrize("shown", [None, "deep", 0, -1, 31, [5], "nan", True, "inf", 10**400])
def test_a_depth_that_is_none_is_not_gone_to(tmp_path: Path, shown: object) -> None:
    table = read(tmp_path, '[phrases]\ngo = { do = "depth", metres = { slot = "m" } }')
    with pytest.raises(VehicleError, match="no depth"):
        table.resolve_mission([{"phrase": "go", "slots": {"m": shown}}])
    with pytest.raises(VehicleError, match="'stay' is not in the table"):
        table.resolve_mission([{"phrase": "stay", "slots": {}}])
    (action,) = table.resolve_mission([{"phrase": "go", "slots": {"m": "7.5"}}])
    assert action == Depth(do="depth", metres=7.5)


WORDS = Phrase("go", (OneOf(("circle",)), OneOf(("line",))), {}, "go")


@pytest.mark.parametrize(
    ("table", "grammar", "faults"),
    [
        ('[gestures]\nline = { do = "hold" }', None, []),
        (
            '[gestures]\nline = { do = "hold" }',
            Grammar((WORDS,)),
            [(False, "gestures.line counts within phrases only")],
        ),
        (
            '[emergency]\ncircle = "surface"',
            Grammar((WORDS,)),
            [(True, "no commands: emergency.circle begins messages")],
        ),
        (
            '[emergency]\nsquare = "surface"',
            Grammar((WORDS,), start="square"),
            [(True, "no commands: emergency.square begins messages")],
        ),
        ('[emergency]\nsquare = "surface"', Grammar((WORDS,), cancel="square"), []),
        (
            '[phrases]\nstay = { do = "hold" }',
            Grammar((WORDS,)),
            [(False, "phrases.stay is not in the language 'pool'")],
        ),
    ],
)
def test_what_a_table_cannot_do_in_a_language_is_known_before_the_dive(
    tmp_path: Path, table: str, grammar: Grammar | None, faults: list[tuple[bool, str]]
) -> None:
    language = replace(language_of("circle", "line", "square"), grammar=grammar)
    assert [*read(tmp_path, table).list_faults(language)] == faults
