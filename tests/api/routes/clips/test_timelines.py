"""Timelines of clips: one value per frame, and pictures."""

from dataclasses import replace

import httpx
import numpy as np
import pytest

from app.api.routes.clips.clips import wrist_speeds
from app.api.services.running_studio import Studio
from app.recognition import PoseSequence
from tests.api.recordings import add_recorded_clip, recording_of
from tests.api.running import assert_problem
from tests.api.shared_server import server, settings

__all__ = ["server", "settings"]


def test_every_frame_has_its_moment_salute_and_speeds(client: httpx.Client, studio: Studio) -> None:
    recording = recording_of("circle")
    clip_id = add_recorded_clip(studio, recording)
    timeline = client.get(f"/api/v1/clips/{clip_id}/timeline").json()
    frames = len(recording.poses)
    assert timeline["time"] == pytest.approx(recording.poses.time.tolist())
    assert timeline["salute"] == pytest.approx(recording.salute.tolist(), abs=1e-3)
    assert [len(speed) for speed in timeline["speed"].values()] == [frames, frames]
    assert timeline["unit"] == "torso_length"
    assert timeline["thumbnails"] == 0
    assert_problem(client.get(f"/api/v1/clips/{clip_id}/filmstrip"), 404, "no_filmstrip")


def test_a_speed_is_in_torso_lengths_a_second() -> None:
    recording = recording_of("circle")
    poses = recording.poses
    speeds, _ = wrist_speeds(recording)
    torso = poses.torso_length()
    assert torso is not None
    wrist = poses.xy[:, poses.landmarks.index("right_wrist")]
    way = np.hypot(*np.diff(wrist, axis=0).T).sum() / torso
    seconds = np.gradient(poses.time)
    assert (speeds["right_wrist"] * seconds).sum() == pytest.approx(way, rel=0.05)
    assert np.nanmax(speeds["left_wrist"]) < 0.1


def test_without_wrists_there_is_no_speed() -> None:
    recording = recording_of("circle")
    poses = recording.poses
    arms = [poses.landmarks.index(name) for name in ("left_shoulder", "right_elbow")]
    only = PoseSequence(
        landmarks=("left_shoulder", "right_elbow"),
        xy=poses.xy[:, arms],
        confidence=None,
        time=poses.time,
        frame_size=poses.frame_size,
    )
    speeds, _ = wrist_speeds(replace(recording, poses=only))
    assert all(np.isnan(speed).all() for speed in speeds.values())


def test_a_clip_that_is_not_read_yet_has_no_timeline(client: httpx.Client) -> None:
    assert_problem(client.get("/api/v1/clips/nothing/timeline"), 404, "not_found")
