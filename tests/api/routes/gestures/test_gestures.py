"""Gestures over HTTP: saved from takes and ranges, changed, removed, shown."""

from typing import Any
from urllib.parse import quote

import httpx
import pytest

from app.api.services.running_studio import Studio
from app.recognition.features.png import decode_png
from tests.api.languages import LANGUAGES, add_gesture
from tests.api.recordings import add_recorded_clip, recording_of
from tests.api.running import assert_problem


def place(language_id: str, label: str = "") -> str:
    return f"{LANGUAGES}/{language_id}/gestures{label and '/'}{label}"


def test_a_take_becomes_a_gesture(client: httpx.Client, language_id: str, circle_clip: str) -> None:
    saved = add_gesture(client, language_id, circle_clip)
    assert saved.status_code == 201
    assert saved.headers["etag"] == '"2"'
    (gesture,) = saved.json()["gestures"]
    assert gesture["label"] == "circle"
    assert gesture["salient"] == ["right_wrist"]
    image = client.get(gesture["thumbnail"])
    assert image.headers["content-type"] == "image/png"
    assert decode_png(image.content, (224, 224)).any()


def test_from_salute_to_salute_means_the_stroke_and_any_other_range_itself(
    client: httpx.Client, language_id: str, circle_clip: str
) -> None:
    (take,) = client.get(f"/api/v1/clips/{circle_clip}/takes").json()
    for label, start, end in (
        ("by take", take["start"], take["end"]),
        ("by stroke", take["stroke_start"], take["stroke_end"]),
        ("by hand", take["start"] + 0.2, take["end"] - 0.5),
    ):
        body = {"label": label, "clip_id": circle_clip, "start": start, "end": end}
        assert client.post(place(language_id), json=body).status_code == 201
    images = [
        client.get(gesture["thumbnail"]).content
        for gesture in client.get(f"{LANGUAGES}/{language_id}").json()["gestures"]
    ]
    assert images[0] == images[1]
    assert images[2] != images[0]


def test_a_label_of_any_characters_can_be_addressed(
    client: httpx.Client, language_id: str, circle_clip: str
) -> None:
    label = "../up & 50% away/now?"
    (gesture,) = add_gesture(client, language_id, circle_clip, label).json()["gestures"]
    assert gesture["label"] == label
    assert client.get(gesture["thumbnail"]).status_code == 200
    address = place(language_id, quote(label, safe=""))
    assert client.get(f"{address}/image").status_code == 200
    changed = client.patch(address, json={"label": "plain"}).json()
    assert changed["labels"] == ["plain"]


@pytest.mark.parametrize(
    "label", [".", "..", "/", "//", "%2e", "%2E%2e", "../..", "a/", "\U0001f42c" * 80]
)
@pytest.mark.withstands(row="H13")
def test_no_label_means_anything_in_an_address(
    client: httpx.Client, language_id: str, circle_clip: str, label: str
) -> None:
    (gesture,) = add_gesture(client, language_id, circle_clip, label).json()["gestures"]
    assert gesture["label"] == label
    assert client.get(gesture["thumbnail"]).headers["content-type"] == "image/png"
    named = {"label": label}
    shown = client.get(f"{place(language_id)}/demonstration", params=named)
    assert shown.status_code == 200
    renamed = client.patch(place(language_id), params=named, json={"label": "circle"})
    assert renamed.json()["labels"] == ["circle"]
    back = client.patch(place(language_id), params={"label": "circle"}, json=named)
    assert back.json()["labels"] == [label]
    assert client.delete(place(language_id), params=named).json()["labels"] == []
    assert client.get(f"{LANGUAGES}/{language_id}").status_code == 200


def test_a_gesture_must_be_named_to_be_deleted(
    client: httpx.Client, language_id: str, circle_clip: str
) -> None:
    add_gesture(client, language_id, circle_clip)
    assert_problem(client.delete(place(language_id)), 422, "request_invalid")
    assert client.get(f"{LANGUAGES}/{language_id}").json()["labels"] == ["circle"]


@pytest.mark.parametrize("method", ["DELETE", "PATCH", "PUT"])
@pytest.mark.parametrize("end", ["/", "/gestures/.."])
def test_a_path_that_a_browser_resolves_to_the_language_changes_nothing(
    client: httpx.Client, language_id: str, method: str, end: str
) -> None:
    url = client.base_url.join(f"{LANGUAGES}/{language_id}{end}")
    assert url.path == f"{LANGUAGES}/{language_id}/"  # httpx resolves the dots as browsers do
    before = client.get(f"{LANGUAGES}/{language_id}").json()
    answer = client.request(method, url, json={"author": "nobody"}, follow_redirects=True)
    assert_problem(answer, 404, "not_found")
    assert client.get(f"{LANGUAGES}/{language_id}").json() == before


def test_a_gesture_changes_in_what_is_given_only(
    client: httpx.Client, language_id: str, circle_clip: str
) -> None:
    add_gesture(client, language_id, circle_clip)
    body = {"description": "round", "command": {"move": [1, 0]}}
    client.patch(place(language_id, "circle"), json=body)
    changed = client.patch(place(language_id, "circle"), json={"command": None})
    (gesture,) = changed.json()["gestures"]
    assert gesture["description"] == "round"
    assert gesture["command"] is None
    assert changed.json()["revision"] == 4


def test_other_salient_keypoints_give_another_image(
    client: httpx.Client, language_id: str, circle_clip: str
) -> None:
    (before,) = add_gesture(client, language_id, circle_clip).json()["gestures"]
    body = {"salient": ["right_wrist", "left_wrist"]}
    changed = client.patch(place(language_id, "circle"), json=body)
    (after,) = changed.json()["gestures"]
    assert set(after["salient"]) == {"right_wrist", "left_wrist"}
    images = [client.get(gesture["thumbnail"]).content for gesture in (before, after)]
    assert images[0] != images[1]


def test_a_removed_gesture_is_gone_from_the_newest_revision_only(
    client: httpx.Client, language_id: str, circle_clip: str
) -> None:
    add_gesture(client, language_id, circle_clip)
    assert client.delete(place(language_id, "circle")).json()["labels"] == []
    assert_problem(client.delete(place(language_id, "circle")), 404, "not_found")
    older = client.get(f"{LANGUAGES}/{language_id}", params={"revision": 2})
    assert older.json()["labels"] == ["circle"]


def test_a_label_cannot_be_taken_twice(
    client: httpx.Client, language_id: str, circle_clip: str
) -> None:
    add_gesture(client, language_id, circle_clip, "one")
    add_gesture(client, language_id, circle_clip, "two")
    assert_problem(add_gesture(client, language_id, circle_clip, "one"), 409, "label_taken")
    renamed = client.patch(place(language_id, "two"), json={"label": "one"})
    assert_problem(renamed, 409, "label_taken")
    same = client.patch(place(language_id, "two"), json={"label": "two"})
    assert same.status_code == 200


def test_labels_that_differ_in_joiners_alone_are_the_same(
    client: httpx.Client, language_id: str, circle_clip: str
) -> None:
    joined, apart = "میروم", "می\u200cروم"
    assert add_gesture(client, language_id, circle_clip, joined).status_code == 201
    assert_problem(add_gesture(client, language_id, circle_clip, apart), 409, "label_taken")
    spelled = client.patch(place(language_id, joined), json={"label": apart})
    assert spelled.json()["labels"] == [apart]


@pytest.mark.withstands(row="H34")
def test_a_new_label_that_looks_like_another_one_is_refused(
    client: httpx.Client, language_id: str, circle_clip: str
) -> None:
    look_alike = "d\u043ewn"
    assert add_gesture(client, language_id, circle_clip, "down").status_code == 201
    refused = assert_problem(
        add_gesture(client, language_id, circle_clip, look_alike), 409, "label_taken"
    )
    assert "looks like 'down'" in str(refused["detail"])
    assert add_gesture(client, language_id, circle_clip, "up").status_code == 201
    renamed = client.patch(place(language_id, "up"), json={"label": look_alike})
    assert_problem(renamed, 409, "label_taken")


@pytest.mark.parametrize(
    ("body", "code"),
    [
        ({"start": 3.0, "end": 1.0}, "range_empty"),
        ({"start": 500.0, "end": 501.0}, "range_empty"),
        ({"start": 1.0, "end": 1.01}, "gesture_unusable"),
        ({"start": 0.0, "end": 0.5}, "gesture_unusable"),
        ({"salient": ["third_hand"]}, "gesture_unusable"),
        ({"label": "\u202e"}, "gesture_unusable"),
        ({"label": " "}, "request_invalid"),
        ({"start": -1}, "request_invalid"),
    ],
    ids=["reversed", "behind", "one frame", "still", "landmark", "direction", "blank", "negative"],
)
def test_a_demonstration_that_is_none_is_refused_and_changes_nothing(
    client: httpx.Client, language_id: str, circle_clip: str, body: dict[str, Any], code: str
) -> None:
    refused = client.post(place(language_id), json={"label": "x", "clip_id": circle_clip, **body})
    assert_problem(refused, 422, code)
    assert client.get(f"{LANGUAGES}/{language_id}").json()["revision"] == 1


def test_several_takes_want_a_choice(
    client: httpx.Client, studio: Studio, language_id: str
) -> None:
    clip_id = add_recorded_clip(studio, recording_of("circle", "line"))
    problem = assert_problem(add_gesture(client, language_id, clip_id), 422, "take_ambiguous")
    assert "2 takes" in str(problem["detail"])
    takes = client.get(f"/api/v1/clips/{clip_id}/takes").json()
    body = {"label": "line", "clip_id": clip_id}
    body |= {"start": takes[1]["start"], "end": takes[1]["end"]}
    assert client.post(place(language_id), json=body).status_code == 201


def test_an_imported_gesture_keeps_its_salient_keypoints(
    client: httpx.Client, language_id: str, circle_clip: str
) -> None:
    add_gesture(client, language_id, circle_clip)
    parameters = {"format": "osg-reference"}
    exported = client.get(f"{LANGUAGES}/{language_id}/export", params=parameters).content
    imported = client.post(f"{LANGUAGES}/import", content=exported).json()["id"]
    changed = client.patch(place(imported, "circle"), json={"salient": ["left_wrist"]})
    assert_problem(changed, 422, "gesture_unusable")


def test_the_switches_of_a_gesture_can_be_set(
    client: httpx.Client, language_id: str, circle_clip: str
) -> None:
    (gesture,) = add_gesture(client, language_id, circle_clip).json()["gestures"]
    names = ("direction", "tempo", "mirror", "hand_shape")
    assert [gesture[name] for name in names] == ["auto"] * 4
    address = place(language_id, "circle")
    change = {"direction": "off", "mirror": "on", "hand_shape": "off"}
    (changed,) = client.patch(address, json=change).json()["gestures"]
    assert [changed[name] for name in names] == ["off", "auto", "on", "off"]
    assert client.patch(address, json={"tempo": "fast"}).status_code == 422


def test_a_gesture_can_be_shown_anew_and_keeps_what_it_says(
    client: httpx.Client, language_id: str, circle_clip: str, line_clip: str
) -> None:
    (before,) = add_gesture(client, language_id, circle_clip).json()["gestures"]
    address = place(language_id, "circle")
    client.patch(address, json={"command": "Go", "direction": "on"})
    body = {"demonstration": {"clip_id": line_clip}}
    (after,) = client.patch(address, json=body).json()["gestures"]
    assert (after["label"], after["command"], after["direction"]) == ("circle", "Go", "on")
    pictures = [client.get(each["thumbnail"]).content for each in (before, after)]
    assert pictures[0] != pictures[1]


def test_several_gestures_are_one_revision(
    client: httpx.Client, studio: Studio, language_id: str, circle_clip: str
) -> None:
    line_clip = add_recorded_clip(studio, recording_of("line"), "line.mp4")
    body = {
        "gestures": [
            {"label": "circle", "clip_id": circle_clip},
            {"label": "line", "clip_id": line_clip},
        ]
    }
    before = client.get(f"{LANGUAGES}/{language_id}").json()["revision"]
    saved = client.post(f"{place(language_id)}/batch", json=body)
    assert saved.status_code == 201
    language = saved.json()
    assert language["revision"] == before + 1
    assert language["labels"] == ["circle", "line"]
    sources = [gesture["source"]["clip_id"] for gesture in language["gestures"]]
    assert sources == [circle_clip, line_clip]


def test_of_several_gestures_none_is_saved_when_one_cannot_be(
    client: httpx.Client, studio: Studio, language_id: str, circle_clip: str
) -> None:
    still = add_recorded_clip(studio, recording_of(), "still.mp4")
    for second, code in (
        ({"label": "circle", "clip_id": circle_clip}, "label_taken"),
        ({"label": "still", "clip_id": still}, "gesture_unusable"),
        ({"label": "empty", "clip_id": circle_clip, "start": 900.0, "end": 901.0}, "range_empty"),
    ):
        body = {"gestures": [{"label": "circle", "clip_id": circle_clip}, second]}
        refused = client.post(f"{place(language_id)}/batch", json=body)
        assert refused.json()["code"] == code, refused.text
        assert refused.json()["errors"][0]["pointer"].startswith("/gestures/1")
    assert client.get(f"{LANGUAGES}/{language_id}").json()["labels"] == []
