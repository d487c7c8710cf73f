"""Phrases over HTTP: stored with the language, checked, simulated, consistent with its gestures."""

from __future__ import annotations

from typing import Any

import httpx
import pytest

from tests.api.languages import LANGUAGES
from tests.api.running import assert_problem
from tests.robot.languages import language_of

GRAMMAR: dict[str, Any] = {
    "end": "circle",
    "timeout": 10,
    "slot_types": [
        {"name": "number", "reads_as": "number", "values": [{"gesture": "line", "value": 1}]}
    ],
    "phrases": [
        {
            "name": "photo",
            "parts": [{"gestures": ["line"]}, {"slot": "times", "type": "number", "least": 0}],
            "command": {"do": "photo", "times": "{times}"},
            "says": "photo[, {times} times]",
        }
    ],
}


def parts(*parts: dict[str, Any]) -> dict[str, Any]:
    return {"phrases": [{"name": "x", "parts": list(parts)}]}


@pytest.fixture
def place(client: httpx.Client) -> str:
    """Return the address of a language of a circle and a line, with a phrase."""
    imported = client.post(f"{LANGUAGES}/import", content=language_of("circle", "line").to_json())
    place = f"{LANGUAGES}/{imported.json()['id']}"
    answer = client.patch(place, json={"grammar": GRAMMAR}, headers={"If-Match": '"1"'})
    assert answer.status_code == 200, answer.text
    return place


def shown(client: httpx.Client, place: str, *gestures: str, **query: str) -> dict[str, Any]:
    answer = client.get(f"{place}/phrases", params={"gesture": list(gestures), **query})
    assert answer.status_code == 200, answer.text
    view: dict[str, Any] = answer.json()
    return view


def test_phrases_are_a_revision_of_the_language(client: httpx.Client, place: str) -> None:
    language = client.get(place).json()
    assert language["revision"] == 2
    assert language["change"] == "Change the phrases"
    (phrase,) = language["grammar"]["phrases"]
    assert phrase["parts"][1]["slot"] == "times"
    exported = client.get(f"{place}/export").json()
    assert exported["grammar"]["phrases"][0]["name"] == "photo"
    lost = client.patch(place, json={"grammar": GRAMMAR}, headers={"If-Match": '"1"'})
    assert_problem(lost, 412, "revision_conflict")
    # A grammar that was read can be sent back unchanged.
    again = client.patch(place, json={"grammar": language["grammar"]})
    assert again.json()["grammar"] == language["grammar"]
    longer = {**GRAMMAR, "timeout": 20, "phrases": [{**GRAMMAR["phrases"][0], "says": "photo"}]}
    client.patch(place, json={"grammar": longer})
    words = client.get(f"{place}/comparison", params={"older": 3, "newer": 4}).json()["words"]
    assert len(words) == 2
    assert "photo" in words[0]
    assert "frames the phrases" in words[1]
    client.patch(place, json={"name": "renamed"})
    assert client.get(place).json()["grammar"] is not None
    assert client.patch(place, json={"grammar": None}).json()["grammar"] is None
    words = client.get(f"{place}/comparison", params={"older": 1, "newer": 2}).json()["words"]
    assert words == ["phrases were added"]


def test_gestures_are_simulated_without_leaving_anything_behind(
    client: httpx.Client, place: str
) -> None:
    begun = shown(client, place)
    assert (begun["ambiguities"], begun["events"], begun["expected"]) == ([], [], ["line"])
    assert begun["examples"] == {"photo": ["line", "line", "circle"]}
    view = shown(client, place, "line", "", "line", "circle")
    assert [event["kind"] for event in view["events"]] == [
        "continues",
        "repeat",
        "continues",
        "complete",
    ]
    last = view["events"][-1]
    assert last["text"] == "mission: photo, 1 times"
    assert last["mission"][0]["command"] == {"do": "photo", "times": 1}
    assert shown(client, place, "line", then="pause")["events"][-1]["kind"] == "timed_out"
    assert client.get(place).json()["revision"] == 2


def test_a_pair_is_asked_for_its_place(client: httpx.Client, place: str) -> None:
    view = shown(client, place, "line", "circle\tline")
    asked = view["events"][-1]
    assert (asked["kind"], asked["label"]) == ("repeat", None)
    assert asked["pair"] == ["circle", "line"]
    assert asked["text"] == "gesture 2: circle or line? show it again"
    assert view["may_end"] is False
    assert shown(client, place, "line", "circle\tline", "circle")["events"][-1]["mission"]
    assert shown(client, place, "line", "circle\tline", "a\tb")["events"][-1]["pair"] is None
    assert shown(client, place, "line", "\tline")["events"][-1]["pair"] is None


def test_ambiguities_are_told_as_the_phrases_change(client: httpx.Client, place: str) -> None:
    client.patch(place, json={"grammar": {**GRAMMAR, "end": None}})
    view = shown(client, place, "line")
    (found,) = view["ambiguities"]
    assert (found["kind"], found["phrases"], found["gestures"]) == ("prefix", ["photo"], ["line"])
    assert view["may_end"]
    report = client.get(f"{place}/check").json()
    kinds = [each["kind"] for each in report["warnings"] if each["error"]]
    assert "phrases_prefix" in kinds
    client.patch(place, json={"grammar": GRAMMAR})
    assert shown(client, place)["ambiguities"] == []


@pytest.mark.parametrize(
    ("change", "pointer"),
    [
        ({"start": "wave"}, "/grammar/start"),
        (parts({"gestures": ["wave"]}), "/grammar/phrases/0/parts/0/gestures/0"),
        (parts({}), "/grammar/phrases/0/parts/0"),
    ],
)
def test_what_contradicts_itself_is_refused_with_a_pointer(
    client: httpx.Client, place: str, change: dict[str, Any], pointer: str
) -> None:
    answer = client.patch(place, json={"grammar": {**GRAMMAR, **change}})
    assert answer.status_code == 422
    (fault,) = answer.json()["errors"]
    assert fault["pointer"] == pointer
    assert client.get(place).json()["revision"] == 2


def test_a_renamed_gesture_stays_in_its_phrases(client: httpx.Client, place: str) -> None:
    client.patch(f"{place}/gestures/line", json={"label": "stroke"})
    view = shown(client, place, "stroke", "stroke", "circle")
    assert view["events"][-1]["kind"] == "complete"


def test_a_gesture_that_a_phrase_needs_is_not_deleted(client: httpx.Client, place: str) -> None:
    problem = assert_problem(client.delete(f"{place}/gestures/line"), 409, "gesture_needed")
    assert "the phrase 'photo'" in str(problem["detail"])
    assert "the end gesture" in str(client.delete(f"{place}/gestures/circle").json()["detail"])
    client.patch(place, json={"grammar": None})
    assert client.delete(f"{place}/gestures/line").status_code == 200


def test_the_language_leaves_as_a_proteus_file(client: httpx.Client, place: str) -> None:
    answer = client.get(f"{place}/export", params={"format": "proteus"})
    assert answer.headers["content-type"] == "application/xml"
    assert "pool.ldf" in answer.headers["content-disposition"]
    assert 'name="line" id="line" call_type="quantity"' in answer.text
    listed = client.get(f"{place}/export/contents").json()["files"]
    sizes = {file["format"]: file["bytes"] for file in listed}
    assert sizes["proteus"] == len(answer.content)
