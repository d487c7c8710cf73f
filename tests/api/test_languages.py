"""Languages over HTTP: revisions, lost races, import and export."""

import json

import httpx
import pytest

from app.recognition import Language
from tests.api.running import assert_problem

LANGUAGES = "/api/v1/languages"


def add_gesture(
    client: httpx.Client, language_id: str, clip_id: str, label: str = "circle"
) -> httpx.Response:
    return client.post(
        f"{LANGUAGES}/{language_id}/gestures", json={"label": label, "clip_id": clip_id}
    )


def test_a_new_language_is_empty_and_listed(client: httpx.Client) -> None:
    made = client.post(LANGUAGES, json={"name": "pool", "author": "Ada"})
    assert made.status_code == 201
    assert made.headers["etag"] == '"1"'
    assert made.json()["gestures"] == []
    assert made.json()["author"] == "Ada"
    (listed,) = client.get(LANGUAGES).json()
    assert (listed["name"], listed["revision"], listed["labels"]) == ("pool", 1, [])


def test_every_change_is_a_revision_with_its_story(
    client: httpx.Client, language_id: str, circle_clip: str
) -> None:
    add_gesture(client, language_id, circle_clip)
    client.patch(f"{LANGUAGES}/{language_id}", json={"name": "sea"})
    history = client.get(f"{LANGUAGES}/{language_id}/revisions").json()
    assert [(row["revision"], row["change"]) for row in history] == [
        (3, "Change name"),
        (2, "Add circle"),
        (1, "New language"),
    ]
    older = client.get(f"{LANGUAGES}/{language_id}", params={"revision": 2})
    assert older.json()["name"] == "pool"


def test_going_back_is_a_new_revision_and_keeps_what_was_undone(
    client: httpx.Client, language_id: str, circle_clip: str
) -> None:
    add_gesture(client, language_id, circle_clip)
    reverted = client.post(f"{LANGUAGES}/{language_id}/revert", json={"revision": 1})
    assert reverted.json()["revision"] == 3
    assert reverted.json()["labels"] == []
    again = client.post(f"{LANGUAGES}/{language_id}/revert", json={"revision": 2})
    assert again.json()["labels"] == ["circle"]
    exported = client.get(f"{LANGUAGES}/{language_id}/export").content
    assert Language.from_json(exported).revision == 4


def test_a_lost_race_is_412_with_the_newer_revision(client: httpx.Client, language_id: str) -> None:
    place = f"{LANGUAGES}/{language_id}"
    first = client.patch(place, json={"name": "one"}, headers={"If-Match": '"1"'})
    assert first.headers["etag"] == '"2"'
    second = client.patch(place, json={"name": "two"}, headers={"If-Match": '"1"'})
    problem = assert_problem(second, 412, "revision_conflict")
    assert problem["current_revision"] == 2
    assert second.headers["etag"] == '"2"'
    assert client.get(place).json()["name"] == "one"
    assert_problem(client.delete(place, headers={"If-Match": '"1"'}), 412, "revision_conflict")
    unread = client.patch(place, json={"name": "x"}, headers={"If-Match": "yesterday's"})
    assert_problem(unread, 412, "revision_conflict")
    assert client.patch(place, json={"name": "x"}, headers={"If-Match": "*"}).status_code == 200


def test_a_deleted_language_can_be_restored(client: httpx.Client, language_id: str) -> None:
    place = f"{LANGUAGES}/{language_id}"
    assert client.delete(place).status_code == 204
    assert_problem(client.get(place), 404, "not_found")
    assert client.get(LANGUAGES).json() == []
    assert client.post(f"{place}/restore").json()["id"] == language_id
    assert client.get(place).status_code == 200


def test_an_exported_file_loads_and_imports_to_the_same_bytes(
    client: httpx.Client, language_id: str, circle_clip: str
) -> None:
    add_gesture(client, language_id, circle_clip)
    exported = client.get(f"{LANGUAGES}/{language_id}/export")
    assert exported.headers["content-disposition"].startswith("attachment;")
    assert "pool.json" in exported.headers["content-disposition"]
    assert Language.from_json(exported.content).labels == ("circle",)
    imported = client.post(f"{LANGUAGES}/import", content=exported.content)
    assert imported.status_code == 201
    assert imported.json()["revision"] == 2
    again = client.get(f"{LANGUAGES}/{imported.json()['id']}/export")
    assert again.content == exported.content


def test_the_published_file_goes_out_and_comes_in_without_trajectories(
    client: httpx.Client, language_id: str, circle_clip: str
) -> None:
    add_gesture(client, language_id, circle_clip)
    exported = client.get(f"{LANGUAGES}/{language_id}/export", params={"format": "osg-reference"})
    entry = json.loads(exported.content)["circle"]
    assert entry["salient_keypoints"] == ["RIGHT_WRIST"]
    imported = client.post(
        f"{LANGUAGES}/import", params={"name": "published"}, content=exported.content
    )
    assert imported.json()["name"] == "published"
    assert imported.json()["gestures"][0]["has_trajectory"] is False


@pytest.mark.parametrize(
    ("content", "pointer"),
    [
        (b"", ""),
        (b"no json", ""),
        (b"[" * 10_000, ""),
        (b'{"format": "osg-studio/gesture-language", "version": 99}', "/version"),
        (b'{"format": "osg-studio/gesture-language", "version": NaN}', "/version"),
        (b'{"circle": {"image": 3, "salient_keypoints": []}}', "/circle/image"),
        (b"\xff\xfe", ""),
    ],
    ids=["empty", "text", "deep", "newer", "nan", "reference", "utf16"],
)
def test_a_file_that_is_no_language_is_422_and_names_the_place(
    client: httpx.Client, content: bytes, pointer: str
) -> None:
    answer = client.post(f"{LANGUAGES}/import", content=content)
    problem = assert_problem(answer, 422, "language_invalid")
    errors = problem["errors"]
    assert isinstance(errors, list)
    assert errors[0]["pointer"] == pointer
    assert client.get(LANGUAGES).json() == []


def test_a_body_that_breaks_the_rules_names_each_fault(client: httpx.Client) -> None:
    body = {"name": "", "author": 3, "colour": "red"}
    problem = assert_problem(client.post(LANGUAGES, json=body), 422, "request_invalid")
    errors = problem["errors"]
    assert isinstance(errors, list)
    assert {fault["pointer"] for fault in errors} == {"/name", "/author", "/colour"}


def test_markup_in_a_name_stays_text(client: httpx.Client) -> None:
    name = '<script>alert("x")</script>'
    made = client.post(LANGUAGES, json={"name": name}).json()
    answer = client.get(f"{LANGUAGES}/{made['id']}")
    assert answer.json()["name"] == name
    assert answer.headers["content-type"] == "application/json"
    assert answer.headers["x-content-type-options"] == "nosniff"
