"""Previews over HTTP: a gesture and its estimated rates before it is saved."""

from base64 import b64decode
from typing import Any

import httpx
import pytest

from app.api.services.running_studio import Studio
from tests.api.languages import LANGUAGES, add_gesture
from tests.api.recordings import add_recorded_clip, recording_of
from tests.api.running import assert_problem
from tests.recognition.demonstrations import pool
from tests.recognition.strategies import circle, line


def preview(
    client: httpx.Client, language_id: str, label: str | None = None, **change: Any
) -> httpx.Response:
    body = {"label": label, "change": change}
    return client.post(f"{LANGUAGES}/{language_id}/preview", json=body)


def outlook(
    client: httpx.Client, language_id: str, label: str | None = None, **change: Any
) -> httpx.Response:
    body = {"label": label, "change": change}
    return client.post(f"{LANGUAGES}/{language_id}/preview/health", json=body)


def imported(client: httpx.Client) -> str:
    document = pool(circle=circle, line=line).to_json()
    return str(client.post(f"{LANGUAGES}/import", content=document).json()["id"])


def test_a_preview_is_what_saving_gives_and_writes_nothing(
    client: httpx.Client, language_id: str, circle_clip: str
) -> None:
    shown = preview(client, language_id, demonstration={"clip_id": circle_clip}).json()
    assert client.get(f"{LANGUAGES}/{language_id}").json()["revision"] == 1
    (saved,) = add_gesture(client, language_id, circle_clip).json()["gestures"]
    again = preview(client, language_id, "circle").json()
    assert shown["image"] == again["image"]
    assert shown["salient"] == saved["salient"] == ["right_wrist"]
    assert shown["descriptors"] == again["descriptors"]
    assert "loop" in shown["strokes"]
    assert shown["strokes"] == again["strokes"] == saved["demonstrations"][0]["strokes"]


def test_for_people_the_previews_image_has_a_start_dot_and_an_arrow(
    client: httpx.Client, language_id: str, circle_clip: str
) -> None:
    (saved,) = add_gesture(client, language_id, circle_clip).json()["gestures"]
    marked = client.get(f"{saved['thumbnail']}&marks=true").content
    shown = client.post(
        f"{LANGUAGES}/{language_id}/preview",
        params={"marks": True},
        json={"label": "circle", "change": {}},
    ).json()
    assert b64decode(shown["image"].partition(",")[2]) == marked
    plain = preview(client, language_id, "circle").json()
    assert plain["image"] != shown["image"]


def test_a_preview_proposes_what_moves_far_enough(
    client: httpx.Client, language_id: str, circle_clip: str
) -> None:
    shown = preview(client, language_id, demonstration={"clip_id": circle_clip}).json()
    proposed = [point for point in shown["keypoints"] if point["proposed"]]
    assert [point["landmark"] for point in proposed] == ["right_wrist"]
    moved = {point["landmark"]: point["displacement"] for point in shown["keypoints"]}
    assert moved["right_wrist"] > shown["threshold"] > moved["left_wrist"]


def test_other_keypoints_are_drawn_and_the_proposal_stays(
    client: httpx.Client, language_id: str, circle_clip: str
) -> None:
    where = {"clip_id": circle_clip}
    plain = preview(client, language_id, demonstration=where).json()
    names = ["left_wrist", "right_wrist"]
    more = preview(client, language_id, demonstration=where, salient=names).json()
    assert more["salient"] == names
    assert more["image"] != plain["image"]
    assert more["keypoints"] == plain["keypoints"]


def test_the_transit_is_kept_on_request(
    client: httpx.Client, language_id: str, circle_clip: str
) -> None:
    (take,) = client.get(f"/api/v1/clips/{circle_clip}/takes").json()
    where = {"clip_id": circle_clip, "start": take["start"], "end": take["end"]}
    stroke = preview(client, language_id, demonstration=where).json()
    whole = preview(client, language_id, demonstration={**where, "keep_transit": True}).json()
    assert (stroke["start"], stroke["end"]) == (take["stroke_start"], take["stroke_end"])
    assert (whole["start"], whole["end"]) == (take["start"], take["end"])


def test_what_cannot_be_saved_says_why_and_still_shows_what_moves(
    client: httpx.Client, language_id: str, circle_clip: str
) -> None:
    where = {"clip_id": circle_clip, "start": 0.0, "end": 0.5}
    shown = preview(client, language_id, demonstration=where).json()
    assert "nothing moves" in shown["problem"]
    assert shown["image"] is None
    assert shown["keypoints"]
    refused = outlook(client, language_id, demonstration=where)
    assert_problem(refused, 422, "gesture_unusable")


def test_a_new_gesture_needs_a_demonstration(client: httpx.Client, language_id: str) -> None:
    assert_problem(preview(client, language_id), 422, "request_invalid")
    assert_problem(preview(client, language_id, "none"), 404, "not_found")


def test_the_outlook_is_that_of_the_health_report(client: httpx.Client) -> None:
    language_id = imported(client)
    seen = outlook(client, language_id, "circle").json()
    report = client.get(f"{LANGUAGES}/{language_id}/check").json()
    (near,) = seen["nearest"]
    wanted = report["gestures"][0]["nearest"]
    assert (near["label"], near["same"]) == (wanted["label"], False) == ("line", False)
    assert near["distance"] == pytest.approx(wanted["distance"], abs=1e-4)


def test_the_outlook_says_what_automatic_switches_come_to(
    client: httpx.Client, studio: Studio, language_id: str, circle_clip: str
) -> None:
    add_gesture(client, language_id, circle_clip)
    back = add_recorded_clip(studio, recording_of("circle backwards"))
    seen = outlook(client, language_id, demonstration={"clip_id": back}).json()
    direction = seen["switches"]["direction"]
    assert (direction["position"], direction["counts"]) == ("auto", True)
    assert "in reverse" in direction["words"]
    alone = outlook(client, language_id, "circle").json()["switches"]["direction"]
    assert alone["counts"] is False
    never = outlook(client, language_id, demonstration={"clip_id": back}, direction="off")
    assert never.json()["switches"]["direction"]["counts"] is False


def test_a_demonstration_can_be_drawn_without_its_clip(
    client: httpx.Client, language_id: str, circle_clip: str
) -> None:
    add_gesture(client, language_id, circle_clip)
    place = f"{LANGUAGES}/{language_id}/gestures/circle/demonstration"
    drawn = client.get(place).json()
    width, height = drawn["frame_size"]
    points = [point for row in drawn["xy"] for point in row if point[0] is not None]
    assert len(drawn["time"]) == len(drawn["xy"])
    assert all(0 < x < width and 0 < y < height for x, y in points)


def test_an_imported_drawing_has_an_image_and_no_keypoints_to_choose(
    client: httpx.Client, language_id: str, circle_clip: str
) -> None:
    add_gesture(client, language_id, circle_clip)
    exported = client.get(
        f"{LANGUAGES}/{language_id}/export", params={"format": "osg-reference"}
    ).content
    drawing = client.post(f"{LANGUAGES}/import", content=exported).json()["id"]
    shown = preview(client, drawing, "circle").json()
    assert shown["image"]
    assert shown["keypoints"] == []
    assert outlook(client, drawing, "circle").json()["nearest"] is None
    place = f"{LANGUAGES}/{drawing}/gestures/circle/demonstration"
    assert_problem(client.get(place), 404, "no_demonstration")


def test_a_new_gesture_is_saved_with_its_switches(
    client: httpx.Client, language_id: str, circle_clip: str
) -> None:
    switches = {"direction": "on", "tempo": "off", "mirror": "on", "hand_shape": "off"}
    body = {"label": "circle", "clip_id": circle_clip, **switches}
    saved = client.post(f"{LANGUAGES}/{language_id}/gestures", json=body).json()
    assert switches.items() <= saved["gestures"][0].items()
