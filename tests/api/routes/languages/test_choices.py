"""Choices over HTTP: which takes to make gestures of, and another movement for a gesture."""

import shutil
from base64 import b64decode
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

from app.api.routes.languages.choices import SIGNS
from app.api.services.running_studio import Studio
from app.recognition import Language
from app.recognition.features.png import decode_png
from app.settings import Settings
from tests.api.languages import LANGUAGES, add_gesture, many_gestures
from tests.api.recordings import add_recorded_clip, recording_of
from tests.api.running import assert_problem
from tests.conftest import ROOT


@pytest.fixture
def samples(settings: Settings) -> Iterator[Path]:
    """Put the sample languages into the server's folder for one test, and return it."""
    settings.samples_dir.mkdir(exist_ok=True)
    files = [settings.samples_dir / f"{name}.json" for name in ("osg-table-2", SIGNS)]
    for file in files:
        file.write_bytes((ROOT / "languages" / file.name).read_bytes())
    yield settings.samples_dir
    for file in files:
        file.unlink()


@pytest.fixture
def alike(client: httpx.Client, studio: Studio, language_id: str) -> str:
    """Return the address of a language in which a rounded square is nearly the square."""
    for shape in ("square", "rounded square", "line"):
        clip = add_recorded_clip(studio, recording_of(shape))
        assert add_gesture(client, language_id, clip, shape).status_code == 201
    words = {"description": "a soft box", "command": {"action": "stop"}}
    address = f"{LANGUAGES}/{language_id}"
    client.patch(f"{address}/gestures", params={"label": "rounded square"}, json=words)
    return address


def drafts(studio: Studio, *shapes: str) -> list[dict[str, str]]:
    return [
        {"label": shape, "clip_id": add_recorded_clip(studio, recording_of(shape))}
        for shape in shapes
    ]


def propose(client: httpx.Client, address: str, label: str, **more: Any) -> dict[str, Any]:
    answer = client.post(f"{address}/replacements", json={"label": label, **more})
    assert answer.status_code == 200, answer.text
    found: dict[str, Any] = answer.json()
    return found


def test_of_takes_that_are_alike_one_is_left_out_and_its_rival_named(
    client: httpx.Client, studio: Studio
) -> None:
    rows = drafts(studio, "square", "line", "rounded square")
    body = {"keep": 2, "gestures": rows}
    chosen = client.post(f"{LANGUAGES}/choice", json=body).json()
    (left_out,) = chosen["left_out"]
    assert 1 in chosen["keep"]
    assert sorted([*chosen["keep"], left_out["index"]]) == [0, 1, 2]
    assert {left_out["other"], rows[left_out["index"]]["label"]} == {
        "square",
        "rounded square",
    }
    assert "nearly alike" in left_out["words"]
    assert "one person" in chosen["people"]


def test_gestures_of_the_language_stay_and_count(
    client: httpx.Client, studio: Studio, language_id: str
) -> None:
    (square,) = drafts(studio, "square")
    add_gesture(client, language_id, square["clip_id"], "box")
    # Labels of rows that are no names yet may be equal: only what is saved needs names of its own.
    rows = [each | {"label": "box"} for each in drafts(studio, "rounded square", "line")]
    body = {"keep": 1, "gestures": rows, "language_id": language_id}
    chosen = client.post(f"{LANGUAGES}/choice", json=body).json()
    assert chosen["keep"] == [1]
    assert [(each["index"], each["other"]) for each in chosen["left_out"]] == [(0, "box")]


def test_a_take_that_cannot_be_a_gesture_is_named_by_its_row(
    client: httpx.Client, studio: Studio
) -> None:
    rows = [*drafts(studio, "line"), {"label": "x", "clip_id": "gone"}]
    body = {"keep": 1, "gestures": rows}
    assert_problem(client.post(f"{LANGUAGES}/choice", json=body), 404, "not_found")
    rows[1]["clip_id"] = add_recorded_clip(studio, recording_of())
    refused = client.post(f"{LANGUAGES}/choice", json=body)
    assert_problem(refused, 422, refused.json()["code"])
    assert refused.json()["errors"][0]["pointer"] == "/gestures/1"


def test_a_replacement_keeps_what_the_gesture_means_and_undo_takes_it_back(
    client: httpx.Client, samples: Path, alike: str
) -> None:
    found = propose(client, alike, "rounded square")
    first, *others = found["replacements"]
    assert "one person" in found["people"]
    assert 0 <= first["after"] < first["before"] <= 1
    assert all(first["after"] <= each["after"] for each in others)
    assert first["alike"] == []
    assert first["nearest"]["gestures"][0] == "rounded square"
    assert first["nearest"]["words"].startswith("told apart, distance")
    assert {each["sign"] for each in found["replacements"]} == {None}
    assert b64decode(first["image"].partition(",")[2]).startswith(b"\x89PNG")
    before = client.get(alike).json()
    body = {"label": "rounded square", "sample": first["sample"], "gesture": first["gesture"]}
    matching = {"If-Match": f'"{before["revision"]}"'}
    taken = client.put(f"{alike}/replacements", json=body, headers=matching)
    assert taken.json()["revision"] == before["revision"] + 1
    own = taken.json()["gestures"][1]
    assert (own["label"], own["description"]) == ("rounded square", "a soft box")
    assert own["command"] == {"action": "stop"}
    assert own["source"] is None
    sample = Language.load(samples / f"{first['sample']}.json").gesture(first["gesture"])
    image = decode_png(client.get(own["thumbnail"]).content, sample.image.shape)
    assert np.array_equal(image, sample.image)
    # The language holds this movement now, so nobody is offered it for another gesture.
    again = propose(client, alike, "square")["replacements"]
    assert first["gesture"] not in [each["gesture"] for each in again]
    late = client.put(f"{alike}/replacements", json=body, headers=matching)
    assert_problem(late, 412, late.json()["code"])
    back = client.post(f"{alike}/revert", json={"revision": before["revision"]}).json()
    assert back["gestures"][1]["source"] == before["gestures"][1]["source"]


def test_takes_of_the_former_movement_are_set_aside_until_undo_or_one_press(
    client: httpx.Client, studio: Studio, samples: Path, alike: str
) -> None:
    shown = [add_recorded_clip(studio, recording_of(shape)) for shape in ("corner", "line")]
    takes = [
        {"clip_id": shown[0], "expected": "rounded square"},
        {"clip_id": shown[1], "expected": "square"},
    ]
    tests = f"{alike}/test-set"
    assert client.post(tests, json={"takes": takes}).status_code == 201
    before = client.get(alike).json()["revision"]

    def replaced(label: str) -> dict[str, bool]:
        first = propose(client, alike, label)["replacements"][0]
        body = {"label": label, "sample": first["sample"], "gesture": first["gesture"]}
        client.put(f"{alike}/replacements", json=body).raise_for_status()
        return set_aside()

    def set_aside() -> dict[str, bool]:
        return {each["expected"]: each["set_aside"] for each in client.get(tests).json()["takes"]}

    assert replaced("rounded square") == {"rounded square": True, "square": False}
    found = client.post(f"{tests}/run").json()
    assert (found["overall"]["asked"], found["overall"]["untestable"]) == (1, 0)
    client.post(f"{alike}/revert", json={"revision": before}).raise_for_status()
    assert set_aside() == {"rounded square": False, "square": False}
    assert replaced("rounded square")["rounded square"]
    take = next(each for each in client.get(tests).json()["takes"] if each["set_aside"])
    client.patch(f"{tests}/{take['id']}", json={"expected": take["expected"]}).raise_for_status()
    assert set_aside() == {"rounded square": False, "square": False}
    assert client.get(tests).json()["waiting"] == 2


def test_a_take_of_a_clip_takes_the_place_of_a_gesture(
    client: httpx.Client, studio: Studio, alike: str
) -> None:
    empty = {"label": "none", "clip_id": add_recorded_clip(studio, recording_of())}
    takes = [empty, {"label": "x", "clip_id": "gone"}, *drafts(studio, "corner", "square")]
    found = propose(client, alike, "rounded square", gestures=takes)
    assert [each["index"] for each in found["replacements"]] == [2]
    taken = {"clip_id": takes[2]["clip_id"]}
    body = {"label": "rounded square", "demonstration": taken}
    own = client.put(f"{alike}/replacements", json=body).json()["gestures"][1]
    assert own["source"]["clip_id"] == takes[2]["clip_id"]
    assert own["description"] == "a soft box"


def test_known_takes_of_other_gestures_count(
    client: httpx.Client, studio: Studio, alike: str
) -> None:
    def find_corner() -> list[dict[str, Any]]:
        corner = propose(client, alike, "rounded square", gestures=drafts(studio, "corner"))
        found: list[dict[str, Any]] = corner["replacements"]
        return found

    assert find_corner()
    clip = add_recorded_clip(studio, recording_of("corner"), "line.mp4")
    takes = [{"clip_id": clip, "expected": "line"}]
    assert client.post(f"{alike}/test-set", json={"takes": takes}).status_code == 201
    assert not find_corner(), "a line that looks like a corner would be read as one"


@pytest.mark.usefixtures("samples")
def test_a_stroke_of_the_palette_can_take_a_place(
    client: httpx.Client, settings: Settings, alike: str
) -> None:
    palette = settings.samples_dir / "palette" / "strokes.json"
    palette.parent.mkdir()
    palette.write_bytes((ROOT / "languages" / "palette" / "strokes.json").read_bytes())
    found = propose(client, alike, "rounded square")["replacements"]
    shutil.rmtree(palette.parent)
    assert "strokes" in [each["sample"] for each in found]
    # The palette is no language that somebody would add.
    listed = [each["name"] for each in client.get("/api/v1/samples/languages").json()]
    assert "strokes" not in listed


def test_signs_of_divers_are_proposed_for_their_own_meaning_or_where_nothing_else_is(
    client: httpx.Client, samples: Path, alike: str
) -> None:
    (samples / "osg-table-2.json").write_bytes(Language("none", []).to_json().encode())
    signs = propose(client, alike, "rounded square")["replacements"]
    assert "I am out of air" in [each["sign"] for each in signs]
    body = {"label": "Out of air"}
    client.patch(f"{alike}/gestures", params={"label": "rounded square"}, json=body)
    (own,) = propose(client, alike, "Out of air")["replacements"]
    assert (own["gesture"], own["sign"]) == ("out of air", None)


def test_what_is_not_there_cannot_take_a_place(client: httpx.Client, alike: str) -> None:
    unknown = client.post(f"{alike}/replacements", json={"label": "spiral"})
    assert_problem(unknown, 404, "not_found")
    of_none = {"label": "square", "sample": "atlantis", "gesture": "square"}
    assert_problem(client.put(f"{alike}/replacements", json=of_none), 404, "not_found")
    for body in ({}, {"sample": "osg-table-2"}, of_none | {"demonstration": {"clip_id": "x"}}):
        answer = client.put(f"{alike}/replacements", json={"label": "square", **body})
        assert_problem(answer, 422, "request_invalid")


def test_more_than_can_be_compared_while_somebody_waits_is_refused(client: httpx.Client) -> None:
    crowd = client.post(f"{LANGUAGES}/import", content=many_gestures(301)).json()["id"]
    answer = client.post(f"{LANGUAGES}/{crowd}/replacements", json={"label": "circle 0"})
    assert_problem(answer, 422, "too_many_gestures")
    body = {"keep": 1, "gestures": [{"label": "x", "clip_id": "gone"}], "language_id": crowd}
    assert_problem(client.post(f"{LANGUAGES}/choice", json=body), 422, "too_many_gestures")
