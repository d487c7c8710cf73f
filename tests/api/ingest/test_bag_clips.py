"""Dive recordings over HTTP: a topic becomes a clip, or one line says why it cannot."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

from app.recognition.recording.video import probe
from app.settings import Limits, Settings
from tests.api.recordings import recording_of
from tests.api.running import assert_problem, client_of, running, until
from tests.bags.bag_files import (
    START,
    Row,
    Storage,
    file_of,
    message,
    published_rows,
    raw,
    write_bag,
    zip_of,
    zipped,
)
from tests.recognition.damaged_clips import picture, write_clip

pytestmark = pytest.mark.slow

CLIPS = "/api/v1/clips"


def upload(
    client: httpx.Client, path: Path, name: str = "dive.mcap", **fields: str
) -> httpx.Response:
    with path.open("rb") as file:
        return client.post(CLIPS, files={"file": (name, file)}, data=fields)


def finished(client: httpx.Client, clip_id: str) -> dict[str, Any]:
    """Wait for a clip's job to end, and return the clip."""
    until(lambda: clip_of(client, clip_id)["status"] in ("done", "failed"))
    return clip_of(client, clip_id)


def clip_of(client: httpx.Client, clip_id: str) -> dict[str, Any]:
    clip: dict[str, Any] = client.get(f"{CLIPS}/{clip_id}").json()
    return clip


def assert_nothing_kept(client: httpx.Client, settings: Settings) -> None:
    assert client.get(CLIPS).json() == []
    assert list((settings.data_dir / "clips").iterdir()) == []
    assert client.get("/healthz").status_code == 200


def two_divers() -> Iterator[Row]:
    """Give keypoints of two divers: the buddy draws a line, the leader a circle."""
    rows: list[Row] = []
    for diver, shape in (("buddy", "line"), ("leader", "circle")):
        rows += [
            (f"/{diver}{topic}", content, received)
            for topic, content, received in published_rows(recording_of(shape))
        ]
    return iter(sorted(rows, key=lambda row: row[2]))


@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
def test_a_recording_with_one_usable_topic_becomes_a_clip(
    client: httpx.Client, settings: Settings, tmp_path: Path, storage: Storage
) -> None:
    recording = recording_of("circle", "line")
    folder = write_bag(tmp_path / "dive", published_rows(recording), storage)
    path = file_of(folder) if storage == "mcap" else zipped(folder)
    answer = upload(client, path, "../dive.zip")
    assert answer.status_code == 202, answer.text
    clip = finished(client, answer.json()["id"])
    assert (clip["status"], clip["topic"]) == ("done", "/pose_keypoints")
    assert (clip["name"], clip["width"], clip["height"]) == ("dive.zip", 640, 480)
    assert clip["frames"] == len(recording.poses)
    assert clip["duration"] == pytest.approx(recording.poses.duration)
    assert [topic["use"] for topic in clip["topics"]] == ["keypoints"]
    assert any("the skeleton is drawn" in warning for warning in clip["warnings"])
    takes = client.get(f"{CLIPS}/{clip['id']}/takes").json()
    assert len(takes) == 2
    poses = client.get(f"{CLIPS}/{clip['id']}/poses").json()
    assert np.allclose(poses["time"], recording.poses.time, atol=1e-6)
    for part in ("poster", "filmstrip", "timeline"):
        assert client.get(f"{CLIPS}/{clip['id']}/{part}").status_code == 200
    # The bytes sent are a video of the topic, also in ranges, and the recording is kept unpacked.
    video = client.get(f"{CLIPS}/{clip['id']}/video")
    assert video.headers["content-type"] == "video/mp4"
    (tmp_path / "video").write_bytes(video.content)
    assert probe(tmp_path / "video").frames == len(recording.poses)
    ranged = client.get(f"{CLIPS}/{clip['id']}/video", headers={"Range": "bytes=4-7"})
    assert (ranged.status_code, ranged.content) == (206, b"ftyp")
    kept = {each.name for each in (settings.data_dir / "clips" / clip["id"]).iterdir()}
    assert kept == {"bag", "video", "recording.npz", "poster.jpg", "filmstrip.jpg"}


def test_of_several_topics_one_is_chosen_after_the_upload(
    client: httpx.Client, tmp_path: Path
) -> None:
    bag = file_of(write_bag(tmp_path / "dive", two_divers()))
    clip_id = upload(client, bag).json()["id"]
    clip = clip_of(client, clip_id)
    assert (clip["status"], clip["error_code"], clip["topic"]) == ("failed", "topic_needed", None)
    assert [topic["name"] for topic in clip["topics"]] == [
        "/buddy/pose_keypoints",
        "/leader/pose_keypoints",
    ]
    assert_problem(client.get(f"{CLIPS}/{clip_id}/video"), 409, "clip_not_ready")
    assert_problem(client.post(f"{CLIPS}/{clip_id}/jobs"), 409, "topic_needed")
    place = f"{CLIPS}/{clip_id}/topic"
    assert_problem(client.post(place, json={"topic": "/nobody"}), 422, "topic_unusable")
    assert client.post(place, json={"topic": "/leader/pose_keypoints"}).status_code == 202
    clip = finished(client, clip_id)
    assert (clip["status"], clip["topic"]) == ("done", "/leader/pose_keypoints")
    again = client.post(place, json={"topic": "/buddy/pose_keypoints"})
    assert_problem(again, 409, "job_not_needed")


def test_the_topic_may_be_named_with_the_upload(client: httpx.Client, tmp_path: Path) -> None:
    bag = file_of(write_bag(tmp_path / "dive", two_divers()))
    problem = assert_problem(upload(client, bag, topic="/nobody"), 422, "topic_unusable")
    topics = problem["topics"]
    assert isinstance(topics, list)
    assert [topic["name"] for topic in topics] == [
        "/buddy/pose_keypoints",
        "/leader/pose_keypoints",
    ]
    answer = upload(client, bag, topic="/buddy/pose_keypoints")
    clip = finished(client, answer.json()["id"])
    assert (clip["status"], clip["topic"]) == ("done", "/buddy/pose_keypoints")


def test_a_video_has_no_topics(client: httpx.Client, small_clip: Path, tmp_path: Path) -> None:
    assert_problem(upload(client, small_clip, topic="/camera"), 422, "topic_unusable")
    long_name = upload(client, small_clip, topic="/" + "x" * 300)
    assert_problem(long_name, 400, "malformed_upload")
    assert upload(client, write_clip(tmp_path / "plain.mp4"), topic="").status_code == 202


def test_a_recording_that_cannot_be_used_is_refused_and_nothing_is_kept(
    client: httpx.Client, settings: Settings, tmp_path: Path
) -> None:
    text = message("std_msgs/msg/String", "hello")
    depth = raw(picture(0), "32FC1", START)
    whole = file_of(write_bag(tmp_path / "whole", published_rows(recording_of("line"))))
    cut = tmp_path / "cut"
    cut.write_bytes(whole.read_bytes()[:-5000])
    other = tmp_path / "contacts"
    with sqlite3.connect(other) as database:
        database.execute("CREATE TABLE person (name TEXT)")
    database.close()
    cases = {
        "no usable topic": (
            file_of(write_bag(tmp_path / "text", [("/log", text, START)])),
            "dive.mcap: the clip holds nothing to recognise gestures in, only /log",
        ),
        "unknown encoding": (
            file_of(write_bag(tmp_path / "depth", [("/depth", depth, START)])),
            "encoded as '32FC1', which is not known",
        ),
        "cut short": (cut, "damaged or cut short"),
        "repair": (cut, "`ros2 bag reindex` or `mcap recover`"),
        "other database": (other, "missing tables"),
        "leads out": (zip_of(tmp_path / "out.zip", {"../x.mcap": b"x"}), "leads out of its folder"),
    }
    for name, (path, words) in cases.items():
        problem = assert_problem(upload(client, path), 422, "bag_unreadable")
        assert words in str(problem["detail"]), name
        assert "\n" not in str(problem["detail"])
        assert str(settings.data_dir) not in str(problem["detail"])
    photos = zip_of(tmp_path / "photos.zip", {"one.jpg": b"x"})
    assert_problem(upload(client, photos), 415, "unsupported_media_type")
    assert_nothing_kept(client, settings)


def test_what_packs_to_nothing_does_not_fill_the_disk(tmp_path: Path) -> None:
    settings = Settings(
        data_dir=tmp_path / "data",
        samples_dir=tmp_path / "samples",
        limits=Limits(worker_file_bytes=1_000_000),
    )
    bomb = zip_of(tmp_path / "dive.zip", {"dive.mcap": bytes(50_000_000)})
    with running(settings) as server, client_of(server.address) as client:
        problem = assert_problem(upload(client, bomb), 422, "decoder")
        assert "more room on the disk than a job may use" in str(problem["detail"])
        assert_nothing_kept(client, settings)


@pytest.mark.usefixtures("installed_models")
def test_a_topic_of_pictures_is_looked_at_like_a_video(
    client: httpx.Client, tmp_path: Path
) -> None:
    rows: list[Row] = [
        ("/camera", raw(picture(index), "bgr8", START + stamp), START + stamp)
        for index, stamp in enumerate((0, 40_000_000, 95_000_000, 300_000_000))
    ]
    clip_id = upload(client, file_of(write_bag(tmp_path / "dive", rows))).json()["id"]
    clip = finished(client, clip_id)
    assert clip["status"] == "done", clip["error"]
    assert any("no person in 4 of 4 frames" in warning for warning in clip["warnings"])
    times = client.get(f"{CLIPS}/{clip_id}/poses").json()["time"]
    assert times == [0, 0.04, 0.095, 0.3]
    assert client.get(f"{CLIPS}/{clip_id}/poster").content[:2] == b"\xff\xd8"
