"""A clip's session over HTTP: an MCAP file that keeps to its own schemas."""

from __future__ import annotations

from pathlib import Path

import httpx
import pytest

from app.settings import Settings
from tests.api.ingest.test_bag_clips import finished, upload
from tests.api.languages import LANGUAGES
from tests.api.recordings import recording_of
from tests.api.running import assert_problem
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
    # What was written to be sent is gone.
    assert {each.name for each in (settings.data_dir / "clips").iterdir()} == {clip["id"]}


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
