"""Demonstrations over HTTP: added to a gesture, listed, shown, removed, and undone."""

from __future__ import annotations

from typing import Any

import httpx
import pytest

from app.api.services.running_studio import Studio
from app.recognition import Language
from app.recognition.features.png import decode_png
from tests.api.languages import LANGUAGES, add_gesture
from tests.api.recordings import add_recorded_clip, recording_of
from tests.api.running import assert_problem


@pytest.fixture
def backwards_clip(studio: Studio) -> str:
    return add_recorded_clip(studio, recording_of("circle backwards"), "ben.mp4")


@pytest.fixture
def place(client: httpx.Client, language_id: str, circle_clip: str) -> str:
    """Return the address of the demonstrations in a language that has a circle."""
    body = {"label": "circle", "clip_id": circle_clip, "diver": "Ana", "command": "hold"}
    assert client.post(f"{LANGUAGES}/{language_id}/gestures", json=body).status_code == 201
    return f"{LANGUAGES}/{language_id}/demonstrations"


def add(client: httpx.Client, place: str, clip_id: str, **more: Any) -> httpx.Response:
    return client.post(place, json={"label": "circle", "clip_id": clip_id, **more})


def listed(client: httpx.Client, place: str, **more: Any) -> Any:
    return client.get(place, params={"label": "circle", **more}).json()


def test_a_take_becomes_a_further_demonstration(
    client: httpx.Client, place: str, circle_clip: str, backwards_clip: str
) -> None:
    (before,) = listed(client, place)
    added = add(client, place, backwards_clip, diver="Ben")
    assert added.status_code == 201
    assert added.headers["etag"] == '"3"'
    (gesture,) = added.json()["gestures"]
    assert (gesture["label"], gesture["command"]) == ("circle", "hold")
    first, second = gesture["demonstrations"]
    assert gesture["demonstrations"] == listed(client, place)
    assert gesture["source"] == first["source"] == before["source"]
    assert (first["index"], first["diver"], first["source"]["clip_id"]) == (0, "Ana", circle_clip)
    assert (second["index"], second["diver"]) == (1, "Ben")
    assert second["source"]["clip_id"] == backwards_clip
    assert second["salient"] == ["right_wrist"]
    assert second["seconds"] == pytest.approx(first["seconds"], abs=0.2)
    pictures = [client.get(each["thumbnail"]) for each in (first, second)]
    assert all(decode_png(each.content, (224, 224)).any() for each in pictures)
    assert pictures[0].content == client.get(gesture["thumbnail"]).content
    assert pictures[0].content != pictures[1].content
    marked = client.get(f"{second['thumbnail']}&marks=true").content
    assert marked.startswith(b"\x89PNG")
    assert marked != pictures[1].content


def test_the_document_keeps_it_through_export_copy_and_import(
    client: httpx.Client, language_id: str, place: str, backwards_clip: str
) -> None:
    add(client, place, backwards_clip, diver="Ben")
    exported = client.get(f"{LANGUAGES}/{language_id}/export").content
    language = Language.from_json(exported)
    assert [each.diver for each in language.gesture("circle").single_demonstrations()] == [
        "Ana",
        "Ben",
    ]
    copy = client.post(f"{LANGUAGES}/{language_id}/duplicate").json()
    imported = client.post(f"{LANGUAGES}/import", content=exported).json()
    for each in (copy, imported):
        there = listed(client, f"{LANGUAGES}/{each['id']}/demonstrations")
        assert [one["diver"] for one in there] == ["Ana", "Ben"]
        assert [one["source"]["clip_id"] for one in there][1] == backwards_clip


def test_adding_is_a_revision_with_a_name_that_can_be_undone(
    client: httpx.Client, language_id: str, place: str, backwards_clip: str
) -> None:
    add(client, place, backwards_clip, diver="Ben")
    newest = client.get(f"{LANGUAGES}/{language_id}/revisions").json()[0]
    assert newest["change"] == "Add a demonstration of circle"
    compared = client.get(f"{LANGUAGES}/{language_id}/comparison", params={"older": 2})
    (gesture,) = compared.json()["gestures"]
    assert "1 demonstration added, by \u201cBen\u201d" in gesture["words"]
    client.post(f"{LANGUAGES}/{language_id}/revert", json={"revision": 2})
    assert [each["diver"] for each in listed(client, place)] == ["Ana"]
    older = listed(client, place, revision=3)
    assert [each["diver"] for each in older] == ["Ana", "Ben"]


def test_without_the_first_the_second_takes_its_place(
    client: httpx.Client, place: str, backwards_clip: str
) -> None:
    add(client, place, backwards_clip, diver="Ben")
    removed = client.delete(f"{place}/0", params={"label": "circle"})
    assert removed.status_code == 200
    (gesture,) = removed.json()["gestures"]
    assert gesture["source"]["clip_id"] == backwards_clip
    assert [each["diver"] for each in gesture["demonstrations"]] == ["Ben"]
    only = client.delete(f"{place}/0", params={"label": "circle"})
    assert_problem(only, 409, "demonstration_needed")


def test_a_lost_race_is_refused(client: httpx.Client, place: str, backwards_clip: str) -> None:
    old = {"If-Match": '"1"'}
    body = {"label": "circle", "clip_id": backwards_clip}
    assert_problem(client.post(place, json=body, headers=old), 412, "revision_conflict")
    add(client, place, backwards_clip)
    refused = client.delete(f"{place}/1", params={"label": "circle"}, headers=old)
    assert_problem(refused, 412, "revision_conflict")
    assert len(listed(client, place)) == 2


@pytest.mark.parametrize(
    ("body", "status", "code"),
    [
        ({"label": "wave"}, 404, "not_found"),
        ({"start": 0.0, "end": 0.5}, 422, "gesture_unusable"),
        ({"start": 3.0, "end": 1.0}, 422, "range_empty"),
        ({"salient": ["third_hand"]}, 422, "gesture_unusable"),
        ({"diver": "x" * 81}, 422, "request_invalid"),
        ({"diver": "a\nb"}, 422, "request_invalid"),
        ({"clip_id": "none"}, 404, "not_found"),
        ({"colour": "blue"}, 422, "request_invalid"),
    ],
    ids=lambda value: str(value)[:30],
)
def test_what_cannot_be_added_changes_nothing(
    client: httpx.Client,
    place: str,
    backwards_clip: str,
    body: dict[str, Any],
    status: int,
    code: str,
) -> None:
    given = {"label": "circle", "clip_id": backwards_clip} | body
    assert_problem(client.post(place, json=given), status, code)
    assert len(listed(client, place)) == 1


def test_a_ninth_demonstration_is_refused(
    client: httpx.Client, place: str, backwards_clip: str
) -> None:
    for _ in range(7):
        assert add(client, place, backwards_clip).status_code == 201
    refused = assert_problem(add(client, place, backwards_clip), 422, "gesture_unusable")
    assert "the limit is 8" in str(refused["detail"])


@pytest.mark.parametrize(
    ("index", "label", "status", "code"),
    [
        (1, "circle", 404, "not_found"),
        (8, "circle", 422, "request_invalid"),
        (-1, "circle", 422, "request_invalid"),
        (0, "wave", 404, "not_found"),
    ],
)
def test_a_demonstration_that_there_is_not_is_not_found(
    client: httpx.Client, place: str, index: int, label: str, status: int, code: str
) -> None:
    for answer in (
        client.get(f"{place}/{index}/image", params={"label": label}),
        client.delete(f"{place}/{index}", params={"label": label}),
    ):
        assert_problem(answer, status, code)


def test_a_label_of_any_characters_has_demonstrations(
    client: httpx.Client, language_id: str, circle_clip: str, backwards_clip: str
) -> None:
    place = f"{LANGUAGES}/{language_id}/demonstrations"
    for label in ("..", "a/demonstrations/0", "50% & more?"):
        add_gesture(client, language_id, circle_clip, label)
        added = add(client, place, backwards_clip, label=label)
        assert added.status_code == 201
        removed = client.delete(f"{place}/1", params={"label": label})
        assert removed.status_code == 200
        assert len(listed(client, place, label=label)) == 1


def test_showing_the_first_anew_keeps_the_others(
    client: httpx.Client, language_id: str, place: str, backwards_clip: str, line_clip: str
) -> None:
    add(client, place, backwards_clip, diver="Ben")
    address = f"{LANGUAGES}/{language_id}/gestures/circle"
    body = {"demonstration": {"clip_id": line_clip, "diver": "Cleo"}}
    assert client.patch(address, json=body).status_code == 200
    shown = listed(client, place)
    assert [each["diver"] for each in shown] == ["Cleo", "Ben"]
    assert [each["source"]["clip_id"] for each in shown] == [line_clip, backwards_clip]
    assert client.patch(address, json={"diver": "Dora"}).status_code == 200
    assert [each["diver"] for each in listed(client, place)] == ["Dora", "Ben"]


def test_a_change_of_the_gesture_may_add_a_demonstration(
    client: httpx.Client, language_id: str, place: str, circle_clip: str, backwards_clip: str
) -> None:
    change = {"demonstration": {"clip_id": backwards_clip, "diver": "Ben"}, "further": True}
    tried = client.post(
        f"{LANGUAGES}/{language_id}/preview", json={"label": "circle", "change": change}
    )
    assert tried.json()["problem"] is None
    assert len(listed(client, place)) == 1
    address = f"{LANGUAGES}/{language_id}/gestures/circle"
    (gesture,) = client.patch(address, json=change | {"command": "stay"}).json()["gestures"]
    assert gesture["command"] == "stay"
    assert [each["diver"] for each in gesture["demonstrations"]] == ["Ana", "Ben"]
    sources = [each["source"]["clip_id"] for each in gesture["demonstrations"]]
    assert sources == [circle_clip, backwards_clip]
