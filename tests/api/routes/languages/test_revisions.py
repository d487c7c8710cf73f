"""A language's history over HTTP: reverting, and the differences of two revisions."""

from typing import Any

import httpx

from app.recognition import Language
from tests.api.languages import LANGUAGES, add_gesture
from tests.api.running import assert_problem


def test_every_change_is_a_revision_with_its_story(
    client: httpx.Client, language_id: str, circle_clip: str
) -> None:
    add_gesture(client, language_id, circle_clip)
    client.patch(f"{LANGUAGES}/{language_id}", json={"name": "sea"})
    history = client.get(f"{LANGUAGES}/{language_id}/revisions").json()
    assert [(row["revision"], row["change"]) for row in history] == [
        (3, "Rename to sea"),
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


def compared(client: httpx.Client, language_id: str, **revisions: int) -> dict[str, Any]:
    answer = client.get(f"{LANGUAGES}/{language_id}/comparison", params=revisions)
    assert answer.status_code == 200, answer.text
    comparison: dict[str, Any] = answer.json()
    return comparison


def test_two_revisions_are_told_apart_gesture_by_gesture(
    client: httpx.Client, language_id: str, circle_clip: str, line_clip: str
) -> None:
    place = f"{LANGUAGES}/{language_id}"
    add_gesture(client, language_id, circle_clip)
    add_gesture(client, language_id, line_clip, "line")
    client.delete(f"{place}/gestures/line")
    client.patch(f"{place}/gestures/circle", json={"label": "ring", "description": "wide"})
    add_gesture(client, language_id, line_clip, "stroke")
    comparison = compared(client, language_id, older=3, newer=6)
    assert (comparison["older"]["revision"], comparison["newer"]["revision"]) == (3, 6)
    ring, stroke = comparison["gestures"]
    assert ring["kind"] == "changed"
    assert ring["words"] == [
        "label was “circle”, is “ring”",
        "description was empty, is “wide”",
    ]
    assert "revision=3" in ring["before"]["thumbnail"]
    assert "revision=6" in ring["after"]["thumbnail"]
    # The same demonstration under another label: renamed, not removed and added.
    assert stroke["words"] == ["label was “line”, is “stroke”"]


def test_what_came_and_what_went_is_said(
    client: httpx.Client, language_id: str, circle_clip: str, line_clip: str
) -> None:
    add_gesture(client, language_id, circle_clip)
    add_gesture(client, language_id, line_clip, "line")
    client.delete(f"{LANGUAGES}/{language_id}/gestures/circle")
    kinds = {
        (change["after"] or change["before"])["label"]: change["kind"]
        for change in compared(client, language_id, older=2, newer=4)["gestures"]
    }
    assert kinds == {"line": "added", "circle": "removed"}


def test_with_nothing_to_compare_all_is_new(
    client: httpx.Client, language_id: str, circle_clip: str
) -> None:
    add_gesture(client, language_id, circle_clip)
    comparison = compared(client, language_id)
    assert comparison["older"] is None
    assert [change["kind"] for change in comparison["gestures"]] == ["added"]


def test_a_renamed_language_is_said_to_be(client: httpx.Client, language_id: str) -> None:
    client.patch(f"{LANGUAGES}/{language_id}", json={"name": "sea", "author": "Ada"})
    comparison = compared(client, language_id, older=1)
    assert comparison["words"] == ["name was “pool”, is “sea”", "author was empty, is “Ada”"]
    assert comparison["newer"]["author"] == "Ada"
    assert comparison["newer"]["change"] == "Rename to sea, Name Ada as author"


def test_a_revision_that_is_not_there_is_404(client: httpx.Client, language_id: str) -> None:
    for revisions in ({"older": 9}, {"newer": 9}):
        answer = client.get(f"{LANGUAGES}/{language_id}/comparison", params=revisions)
        assert_problem(answer, 404, "not_found")
