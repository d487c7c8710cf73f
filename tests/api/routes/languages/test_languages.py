"""Languages over HTTP: revisions, edit conflicts, import and export."""

import httpx
import pytest

from tests.api.languages import LANGUAGES, add_gesture, listed
from tests.api.running import assert_problem


def test_a_new_language_is_empty_and_listed(client: httpx.Client) -> None:
    made = client.post(LANGUAGES, json={"name": "pool", "author": "Ada"})
    assert made.status_code == 201
    assert made.headers["etag"] == '"1"'
    assert made.json()["gestures"] == []
    assert made.json()["author"] == "Ada"
    entry = listed(client)[made.json()["id"]]
    assert (entry["name"], entry["revision"], entry["labels"]) == ("pool", 1, [])


def test_a_new_name_that_looks_like_another_languages_is_refused(client: httpx.Client) -> None:
    assert client.post(LANGUAGES, json={"name": "pool e\u0301"}).json()["name"] == "pool \u00e9"
    alike = {"name": "p\u043eol \u00e9"}
    assert_problem(client.post(LANGUAGES, json=alike), 409, "name_taken")
    lake = client.post(LANGUAGES, json={"name": "lake"}).json()["id"]
    assert_problem(client.patch(f"{LANGUAGES}/{lake}", json=alike), 409, "name_taken")
    assert client.post(LANGUAGES, json={"name": "pool \u00e9"}).status_code == 201


@pytest.mark.withstands(row="H20")
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
    assert language_id not in listed(client)
    assert client.post(f"{place}/restore").json()["id"] == language_id
    assert client.get(place).status_code == 200


def test_a_body_that_breaks_the_rules_names_each_fault(client: httpx.Client) -> None:
    body = {"name": "", "author": 3, "colour": "red"}
    problem = assert_problem(client.post(LANGUAGES, json=body), 422, "request_invalid")
    errors = problem["errors"]
    assert isinstance(errors, list)
    assert {fault["pointer"] for fault in errors} == {"/name", "/author", "/colour"}


@pytest.mark.withstands(row="H15")
def test_markup_in_a_name_stays_text(client: httpx.Client) -> None:
    name = '<script>alert("x")</script>'
    made = client.post(LANGUAGES, json={"name": name}).json()
    answer = client.get(f"{LANGUAGES}/{made['id']}")
    assert answer.json()["name"] == name
    assert answer.headers["content-type"] == "application/json"
    assert answer.headers["x-content-type-options"] == "nosniff"


def test_a_duplicate_is_a_language_of_its_own(client: httpx.Client, language_id: str) -> None:
    place = f"{LANGUAGES}/{language_id}"
    client.patch(place, json={"author": "Ada"})
    copy = client.post(f"{place}/duplicate").json()
    assert (copy["name"], copy["author"], copy["revision"]) == ("pool (copy)", "Ada", 1)
    assert copy["change"] == "Copy of pool, revision 2"
    assert client.post(f"{place}/duplicate").json()["name"] == "pool (copy 2)"
    earlier = client.post(f"{place}/duplicate", params={"revision": 1}).json()
    assert earlier["author"] == ""
    client.patch(f"{LANGUAGES}/{copy['id']}", json={"name": "sea"})
    assert client.get(place).json()["name"] == "pool"


def test_the_copy_of_a_long_name_is_short_enough(client: httpx.Client) -> None:
    made = client.post(LANGUAGES, json={"name": "x" * 80}).json()
    copy = client.post(f"{LANGUAGES}/{made['id']}/duplicate").json()
    assert copy["name"] == "x" * 73 + " (copy)"


def test_a_list_is_sent_again_only_when_something_changed(
    client: httpx.Client, language_id: str
) -> None:
    for place in (LANGUAGES, "/api/v1/clips"):
        first = client.get(place)
        known = {"If-None-Match": first.headers["etag"]}
        again = client.get(place, headers=known)
        assert (again.status_code, again.content) == (304, b"")
    client.patch(f"{LANGUAGES}/{language_id}", json={"name": "sea"})
    changed = client.get(LANGUAGES, headers=known)
    assert changed.status_code == 200
    (entry,) = (each for each in changed.json() if each["id"] == language_id)
    assert (entry["name"], entry["change"]) == ("sea", "Rename to sea")


def test_an_export_is_described_before_it_is_taken_away(
    client: httpx.Client, language_id: str, circle_clip: str
) -> None:
    add_gesture(client, language_id, circle_clip)
    contents = client.get(f"{LANGUAGES}/{language_id}/export/contents").json()
    assert (contents["schema_format"], contents["schema_version"]) == (
        "osg-studio/gesture-language",
        1,
    )
    assert contents["salient"] == ["right_wrist"]
    assert contents["without_command"] == ["circle"]
    for file in contents["files"]:
        sent = client.get(f"{LANGUAGES}/{language_id}/export", params={"format": file["format"]})
        assert len(sent.content) == file["bytes"]
    assert [file["complete"] for file in contents["files"]] == [True, False, False]


def test_the_share_of_refused_takes_is_a_revision_that_can_be_undone(
    client: httpx.Client, language_id: str
) -> None:
    place = f"{LANGUAGES}/{language_id}"
    assert client.get(place).json()["most_refused"] == 0.05
    changed = client.patch(place, json={"most_refused": 0.1}).json()
    assert (changed["most_refused"], changed["revision"]) == (0.1, 2)
    assert changed["change"] == "Refuse at most 10 % of right takes"
    assert client.get(f"{place}/export").json()["most_refused"] == 0.1
    undone = client.post(f"{place}/revert", json={"revision": 1}).json()
    assert undone["most_refused"] == 0.05
    renamed = client.patch(place, json={"name": "sea", "most_refused": 0.025}).json()
    assert renamed["change"] == "Rename to sea, Refuse at most 2.5 % of right takes"


@pytest.mark.parametrize("share", [0, -0.1, 0.51, "many"])
def test_a_share_of_refused_takes_that_is_none_is_refused(
    client: httpx.Client, language_id: str, share: object
) -> None:
    answer = client.patch(f"{LANGUAGES}/{language_id}", json={"most_refused": share})
    assert_problem(answer, 422, "request_invalid")
    assert answer.json()["errors"][0]["pointer"] == "/most_refused"
