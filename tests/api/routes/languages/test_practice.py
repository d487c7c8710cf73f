"""Practice over HTTP: the feedback to a diver, and the record as evidence of acceptance."""

from __future__ import annotations

import json
import threading
from typing import Any

import httpx
import pytest

from app.api.routes.languages import takes
from app.api.services.running_studio import Studio
from app.api.services.stored_recognitions import recognize_range
from tests.api.http.test_connection import begin
from tests.api.languages import LANGUAGES, add_ambiguous_language, add_gesture
from tests.api.recordings import add_recorded_clip, recording_of
from tests.api.running import PATIENCE_SECONDS, Running, assert_problem, until


@pytest.fixture
def place(client: httpx.Client, language_id: str, circle_clip: str, line_clip: str) -> str:
    add_gesture(client, language_id, circle_clip, "circle")
    add_gesture(client, language_id, line_clip, "line")
    return f"{LANGUAGES}/{language_id}/practice"


def test_a_diver_is_told_what_to_change_and_has_a_record(
    client: httpx.Client, studio: Studio, place: str, language_id: str
) -> None:
    assert client.get(place).json() == []
    circle = add_recorded_clip(studio, recording_of("circle"), "circle.mp4")
    line = add_recorded_clip(studio, recording_of("line"), "line.mp4")
    right = client.post(place, json={"diver": "Ana", "expected": "circle", "clip_id": circle})
    assert right.status_code == 201
    record = right.json()["record"]
    assert (record["takes"], record["errors"], record["more"]) == (1, 0, 58)
    assert not record["reached"]
    wrong = client.post(place, json={"diver": "Ana", "expected": "circle", "clip_id": line}).json()
    assert (wrong["take"]["label"], wrong["take"]["right"]) == ("line", False)
    assert len(wrong["sentence"].split()) <= 15
    assert wrong["details"]
    assert (wrong["record"]["errors"], wrong["record"]["more"]) == (1, 91)
    # The same take sent again is not further evidence.
    again = client.post(place, json={"diver": "Ana", "expected": "circle", "clip_id": circle})
    assert again.json()["record"]["takes"] == 2
    (left,) = client.delete(f"{place}/{wrong['take']['id']}").json()
    assert (left["takes"], left["errors"]) == (1, 0)
    # Another revision counts as another language.
    client.patch(f"{LANGUAGES}/{language_id}", json={"name": "sea"}).raise_for_status()
    (older,) = client.get(place).json()
    assert (older["takes"], older["older"]) == (0, 1)


def test_a_pair_with_the_gesture_meant_is_neither_right_nor_an_error(
    client: httpx.Client, studio: Studio
) -> None:
    place = f"{add_ambiguous_language(client)}/practice"
    clip = add_recorded_clip(studio, recording_of("circle"), "circle.mp4")
    shown = {"diver": "Ana", "expected": "circle", "clip_id": clip}
    asked = client.post(place, json=shown).json()
    assert (asked["take"]["label"], asked["take"]["right"]) == (None, False)
    assert set(asked["take"]["pair"]) == {"circle", "ring"}
    assert "are nearly alike" in asked["sentence"]
    record = asked["record"]
    assert (record["takes"], record["errors"], record["pairs"]) == (0, 0, 1)
    again = add_recorded_clip(studio, recording_of("circle"), "again.mp4")
    other = client.post(place, json={**shown, "expected": "line", "clip_id": again})
    record = other.json()["record"]
    assert (record["takes"], record["errors"], record["pairs"]) == (1, 1, 1)
    (listed,) = client.get(place).json()
    assert [take["pair"] for take in listed["shown"]] == [asked["take"]["pair"]] * 2


def test_a_take_whose_client_leaves_is_in_the_audit_log(
    server: Running,
    client: httpx.Client,
    studio: Studio,
    place: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    circle = add_recorded_clip(studio, recording_of("circle"), "circle.mp4")
    began, go_on = threading.Event(), threading.Event()

    def recognize_slowly(*given: Any, **named: Any) -> Any:
        began.set()
        assert go_on.wait(PATIENCE_SECONDS)
        return recognize_range(*given, **named)

    monkeypatch.setattr(takes, "recognize_range", recognize_slowly)
    body = json.dumps({"diver": "Ana", "expected": "circle", "clip_id": circle}).encode()
    with begin(server, "POST", place, body):
        until(began.is_set)
    go_on.set()
    until(lambda: client.get(place).json())
    until(lambda: client.get("/api/v1/audit").json()[0]["path"] == place)


def test_what_is_no_evidence_is_refused(
    client: httpx.Client, studio: Studio, place: str, circle_clip: str
) -> None:
    shown = {"diver": "Ana", "expected": "circle", "clip_id": circle_clip}
    assert_problem(client.post(place, json=shown), 409, "is_demonstration")
    own = add_recorded_clip(studio, recording_of("circle"), "own.mp4")
    unknown = {**shown, "clip_id": own, "expected": "wave"}
    assert_problem(client.post(place, json=unknown), 404, "not_found")
    assert_problem(client.delete(f"{place}/none"), 404, "not_found")
