"""`osg-studio check`: the verdict in words and in the exit code."""

import json
from pathlib import Path

import pytest

from app.cli.check import format_report
from app.recognition import Gesture, Language
from app.recognition.health.check import check_health
from app.recognition.health.finding import Verdict
from app.recognition.phrases.grammar import Grammar
from app.recognition.phrases.phrase import OneOf, Phrase
from tests.command_line import OsgStudio
from tests.posed import posed_language
from tests.recognition.demonstrations import pool, shown_by
from tests.recognition.strategies import circle, line


def told_of(language: Language) -> str:
    report = check_health(language)
    return format_report(report, Verdict.of(report.errors, language.labels))


@pytest.fixture
def healthy(tmp_path: Path) -> Path:
    file = tmp_path / "healthy.json"
    pool(circle=circle, line=line).save(file)
    return file


@pytest.fixture
def confused(tmp_path: Path) -> Path:
    file = tmp_path / "confused.json"
    pool(circle=circle, ring=circle).save(file)
    return file


def test_a_language_with_nothing_below_the_bar_ends_with_zero(
    osg_studio: OsgStudio, tmp_path: Path
) -> None:
    (drawn,) = pool(circle=circle).gestures
    picture = Gesture(label="old", salient=("right_wrist",), image=drawn.image)
    file = tmp_path / "pictures.json"
    Language("pool", [picture]).save(file)
    ended = osg_studio("check", file)
    assert ended.code == 0
    assert ended.out.splitlines()[0] == "pool, revision 1: no errors, old untested"
    assert "came without its demonstration" in ended.out


def test_an_ambiguity_of_the_phrases_is_below_the_bar(
    osg_studio: OsgStudio, tmp_path: Path
) -> None:
    (drawn,) = pool(circle=circle).gestures
    picture = Gesture(label="old", salient=("right_wrist",), image=drawn.image)
    grammar = Grammar((Phrase("photo", (OneOf(("old",), most=2),)),))
    file = tmp_path / "pictures.json"
    Language("pool", [picture], grammar=grammar).save(file)
    ended = osg_studio("check", file)
    assert ended.code == 1
    assert "ERROR: after old the message is complete, but may continue" in ended.out


def test_a_language_below_the_bar_ends_with_one_and_says_what_to_do(
    osg_studio: OsgStudio, confused: Path
) -> None:
    ended = osg_studio("check", confused)
    assert ended.code == 1
    assert "NOT READY" in ended.out
    assert "circle and ring are the same movement" in ended.out
    assert "change or remove one of them" in ended.out


def test_json_is_one_object_with_the_verdict(osg_studio: OsgStudio, healthy: Path) -> None:
    ended = osg_studio("check", healthy, "--json")
    report = json.loads(ended.out)
    assert ended.code == (0 if report["ok"] else 1)
    assert report["forecast"]["people"] == 1


def test_a_file_that_is_no_language_is_bad_input(osg_studio: OsgStudio, tmp_path: Path) -> None:
    file = tmp_path / "other.json"
    file.write_text("{}")
    ended = osg_studio("check", file)
    assert ended.code == 2
    assert len(ended.error.splitlines()) == 1


def test_columns_are_aligned_and_fit_a_terminal() -> None:
    text = told_of(pool(circle=circle, line=line))
    lines = text.splitlines()
    head = next(index for index, row in enumerate(lines) if row.startswith("gesture"))
    starts = {row.index("right_wrist") for row in lines[head + 1 : head + 3]}
    assert starts == {lines[head].index("depends on")}
    assert max(map(len, lines[: head + 3])) <= 100


def test_the_rates_of_an_arm_trigger_are_told_above_the_gestures() -> None:
    lines = told_of(posed_language()).splitlines()
    assert "takes lie between two poses of the arms (left hand before the body)" in lines
    (rates,) = (line for line in lines if line.startswith("trigger: missed of 0% (0%-"))
    assert len(rates) <= 100


def test_what_others_will_reach_stands_first_or_who_must_be_asked() -> None:
    lines = told_of(shown_by(("Ann", "Bo", "Cy"))).splitlines()
    assert lines[1].startswith("Other people's demonstrations are read right in ")
    assert ", n 12). The last person raised the" in lines[1]
    assert lines[3].startswith("asked back with the right one ")
    alone = told_of(pool(circle=circle)).splitlines()
    assert "nothing can be foretold" in alone[1]
    assert alone[2].endswith("Ask two more people to show it, and name the divers.")


def test_the_limit_is_one_line_with_both_costs_or_says_that_one_person_has_shown_it() -> None:
    lines = told_of(shown_by(("Ann", "Bo", "Cy"))).splitlines()
    (costs,) = (line for line in lines if line.startswith("limit"))
    assert costs.startswith("limit of 3 people, dial 5%: refuses 8% (1%-35%, n 12) of right takes")
    assert costs.endswith("accepts 0% (0%-24%, n 12) of missing gestures")
    alone = told_of(pool(circle=circle)).splitlines()
    assert "limit: a cautious constant, because one person has shown this language" in alone


def test_a_vehicle_table_that_does_not_fit_is_an_error(
    osg_studio: OsgStudio, tmp_path: Path
) -> None:
    (drawn,) = pool(circle=circle).gestures
    file, table = tmp_path / "pictures.json", tmp_path / "vehicle.toml"
    Language("pool", [Gesture(label="old", salient=("right_wrist",), image=drawn.image)]).save(file)
    head = 'format = "osg-studio/vehicle-table"\nversion = 1\n'
    text = head + '[gestures]\n{label} = { do = "hold" }\n'
    table.write_text(text.replace("{label}", "old"))
    assert osg_studio("check", file, "--vehicle", table).code == 0
    table.write_text(text.replace("{label}", "new"))
    ended = osg_studio("check", file, "--vehicle", table)
    told = "gestures.new is not in the language 'pool'"
    assert (ended.code, f"error: vehicle table: {told}" in ended.out) == (1, True)
    ended = osg_studio("check", file, "--vehicle", table, "--json")
    assert (ended.code, json.loads(ended.out)["vehicle"]) == (1, [told])
