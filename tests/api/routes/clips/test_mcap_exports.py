"""A clip's session over HTTP: an MCAP file that keeps to its own schemas."""

from __future__ import annotations

import json
from pathlib import Path

import httpx
import pytest

from app.settings import Settings
from tests.api.ingest.test_bag_clips import finished, upload
from tests.api.languages import LANGUAGES
from tests.api.recordings import recording_of
from tests.api.running import Running, assert_problem, until
from tests.bags.bag_files import file_of, published_rows, write_bag
from tests.bags.exports import checked

pytestmark = pytest.mark.slow


def test_a_session_holds_what_was_seen_and_recognised(
    client: httpx.Client, settings: Settings, tmp_path: Path, language_id: str
) -> None:
    bag = file_of(write_bag(tmp_path / "dive", published_rows(recording_of("circle", "line"))))
    clip = finished(client, upload(client, bag, "dive é.mcap").json()["id"])
    first, second = client.get(f"/api/v1/clips/{clip['id']}/takes").json()
    span = {"clip_id": clip["id"], "start": first["stroke_start"], "end": first["stroke_end"]}
    saved = client.post(f"{LANGUAGES}/{language_id}/gestures", json={"label": "circle", **span})
    assert saved.status_code == 201, saved.text
    for take, expected in ((first, "circle"), (second, None)):
        body = {"clip_id": clip["id"], "language_id": language_id, "expected": expected}
        body |= {"start": take["stroke_start"], "end": take["stroke_end"]}
        assert client.post("/api/v1/recognitions", json=body).status_code == 201
    answer = client.get(f"/api/v1/clips/{clip['id']}/session.mcap")
    assert answer.status_code == 200
    assert "dive%20%C3%A9.mcap" in answer.headers["content-disposition"]
    (tmp_path / "session.mcap").write_bytes(answer.content)
    found = checked(tmp_path / "session.mcap")
    frames = clip["frames"]
    assert [len(found[topic]) for topic in ("/video", "/keypoints", "/salute")] == [frames] * 3
    assert len(found["/takes"]) == 2
    results = [content for _, content in found["/recognitions"]]
    assert [each["expected"] for each in results] == ["circle", ""]
    assert {(each["language"], each["nearest"]) for each in results} == {("pool", "circle")}
    assert any("the skeleton is drawn" in content["message"] for _, content in found["/log"])
    # The file written for sending is deleted.
    assert {each.name for each in (settings.data_dir / "clips").iterdir()} == {clip["id"]}


def test_a_session_is_written_under_a_name_and_fetched_once(
    client: httpx.Client, settings: Settings, tmp_path: Path, circle_clip: str
) -> None:
    address = f"/api/v1/clips/{circle_clip}/session.mcap"
    partials = settings.data_dir / "clips"
    before = {each.name for each in partials.iterdir()}
    written = {}
    for name in ("first", "second"):
        answer = client.post(address, json={"id": name})
        assert answer.status_code == 201, answer.text
        written[name] = answer.json()
    (kept, other) = sorted(
        partials / each.name for each in partials.iterdir() if each.name not in before
    )
    assert {each["id"] for each in written.values()} == {"first", "second"}
    assert written["first"]["size"] == kept.stat().st_size
    assert written["first"]["name"].endswith(".mcap")

    fetched = client.get(address, params={"export": "first"})
    assert len(fetched.content) == written["first"]["size"]
    (tmp_path / "session.mcap").write_bytes(fetched.content)
    assert len(checked(tmp_path / "session.mcap")["/takes"]) == 1
    # The file that was sent is deleted, the other one waits; another request writes it again.
    until(lambda: kept.exists() != other.exists())
    assert client.get(address, params={"export": "first"}).status_code == 200
    assert client.get(address, params={"export": "second"}).status_code == 200
    until(lambda: {each.name for each in partials.iterdir()} == before)


def test_two_exports_of_one_clip_tell_their_progress_by_their_own_names(
    client: httpx.Client, server: Running, circle_clip: str
) -> None:
    told = []
    with client.stream("GET", "/api/v1/events") as stream:
        lines = stream.iter_lines()
        while "listening" not in next(lines):
            pass
        for name in ("mine", "hers"):
            address = f"{server.address}/api/v1/clips/{circle_clip}/session.mcap"
            assert httpx.post(address, json={"id": name}, timeout=60).status_code == 201
        server.studio.broadcast.publish("clips", id="over")
        kind = ""
        for line in lines:
            kind = line.removeprefix("event:").strip() if line.startswith("event:") else kind
            if line.startswith("data:") and kind == "clips":
                break
            if line.startswith("data:") and kind == "exports":
                told.append(json.loads(line.removeprefix("data:"))["id"])
    assert set(told) == {"mine", "hers"}


def test_a_clip_whose_video_cannot_be_read_any_more_still_has_a_session(
    client: httpx.Client, tmp_path: Path, circle_clip: str
) -> None:
    answer = client.get(f"/api/v1/clips/{circle_clip}/session.mcap")
    assert answer.status_code == 200, answer.text
    (tmp_path / "session.mcap").write_bytes(answer.content)
    found = checked(tmp_path / "session.mcap")
    assert "/video" not in found
    assert len(found["/takes"]) == 1


def test_a_clip_without_poses_has_no_session(client: httpx.Client, small_clip: Path) -> None:
    clip_id = upload(client, small_clip, "dive.mp4").json()["id"]
    client.delete(f"/api/v1/jobs/{client.get(f'/api/v1/clips/{clip_id}').json()['job_id']}")
    assert_problem(client.get(f"/api/v1/clips/{clip_id}/session.mcap"), 409, "clip_not_ready")
    assert_problem(client.get("/api/v1/clips/absent/session.mcap"), 404, "not_found")
