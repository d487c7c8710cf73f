"""`osg-studio phrase`: what gestures mean in words, in JSON and in the exit code."""

import json
from pathlib import Path

import pytest

from app.recognition import Language
from tests.command_line import OsgStudio
from tests.conftest import ROOT
from tests.documented import documented

LANGUAGE = ROOT / "languages" / "osg-table-2.json"


def test_a_complete_message_is_spoken_back(
    osg_studio: OsgStudio, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(ROOT)
    (command,) = documented("phrase", page="robots/without-ros.md")
    ended = osg_studio(*command)
    assert (ended.code, ended.out) == (0, "mission: align yourself, 3 times\n")
    assert "circle, square: then circle, three or infinity" in " ".join(ended.error.split())


def test_json_is_one_object_for_each_gesture(osg_studio: OsgStudio) -> None:
    ended = osg_studio("phrase", LANGUAGE, "circle", "sweep", "circle", "--json")
    events = [json.loads(line) for line in ended.out.splitlines()]
    assert [event["kind"] for event in events] == ["continues", "continues", "complete"]
    assert events[-1]["mission"][0]["command"] == {"do": "come_here"}


@pytest.mark.parametrize(
    ("gestures", "told"),
    [
        (["circle", "sweep"], "waited too long for circle"),
        (["circle", "sweep", "three"], "three does not follow circle, sweep, circle does"),
        (["circle", "sweep", "line"], "cancelled"),
        (["sweep"], "no message has begun"),
    ],
)
def test_what_is_no_message_ends_with_one_and_says_why(
    osg_studio: OsgStudio, gestures: list[str], told: str
) -> None:
    ended = osg_studio("phrase", LANGUAGE, *gestures)
    assert (ended.code, ended.out) == (1, "")
    assert told in " ".join(ended.error.split())


def test_without_gestures_every_phrase_is_listed_as_it_is_shown(osg_studio: OsgStudio) -> None:
    ended = osg_studio("phrase", LANGUAGE)
    assert ended.code == 0
    for line in ended.out.splitlines():
        name, _, shown = line.partition(": ")
        understood = osg_studio("phrase", LANGUAGE, "--json", *shown.split())
        (*_, last) = understood.out.splitlines()
        assert json.loads(last)["mission"][0]["phrase"] == name
    listed = osg_studio("phrase", LANGUAGE, "--json").out.splitlines()
    assert json.loads(listed[0]) == {
        "phrase": "come here",
        "example": ["circle", "sweep", "circle"],
    }


def test_an_unknown_gesture_and_a_language_without_phrases_are_bad_input(
    osg_studio: OsgStudio, tmp_path: Path
) -> None:
    ended = osg_studio("phrase", LANGUAGE, "circle", "wave")
    assert (ended.code, ended.out) == (2, "")
    assert "no gesture 'wave'" in ended.error
    ended = osg_studio("phrase", ROOT / "languages" / "osg-table-1.json", "circle")
    assert ended.code == 2
    assert "has no phrases" in ended.error


def test_the_suffix_ldf_asks_for_a_proteus_file(osg_studio: OsgStudio, tmp_path: Path) -> None:
    for arguments in (["out.ldf"], ["out.xml", "--format", "proteus"]):
        target = tmp_path / arguments[0]
        assert osg_studio("convert", LANGUAGE, target, *arguments[1:]).code == 0
        assert '<symbol name="three" id="three" call_type="quantity"' in target.read_text()
    # A copy keeps the phrases to the byte.
    copy = tmp_path / "copy.json"
    assert osg_studio("convert", LANGUAGE, copy).code == 0
    assert copy.read_bytes() == LANGUAGE.read_bytes()
    assert Language.load(copy).grammar is not None
