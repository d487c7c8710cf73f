"""Other programs' keypoint files over HTTP: they become clips without pictures."""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

from app.recognition.landmark_sets import BODY_25
from app.recognition.landmarks import POSE_LANDMARKS
from app.recognition.video import probe
from app.settings import Settings
from tests.api.running import assert_problem
from tests.api.test_bag_clips import CLIPS, assert_nothing_kept, finished, upload
from tests.keypoint_files.files import (
    renamed,
    write_deeplabcut,
    write_named,
    write_numbered,
    write_openpose,
)
from tests.recognition.demonstrations import pool
from tests.recognition.strategies import BODY, circle, line, recording

FRAMES = 40

INVALID = "field_invalid"

BOTH = {"frame_rate": "30", "frame_size": "640x480"}


def packed(folder: Path, *, prefix: str = "dive/") -> Path:
    """Pack a folder as a person would, into the zip beside it."""
    path = folder.with_suffix(".zip")
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in sorted(folder.iterdir()):
            archive.write(file, f"{prefix}{file.name}")
    return path


def written(folder: Path, form: str) -> Path:
    """Write a circle the way another program would."""
    poses, arms = (
        recording(circle, frames=FRAMES, landmarks=names) for names in (POSE_LANDMARKS, tuple(BODY))
    )
    match form:
        case "openpose":
            return packed(write_openpose(folder / "json", arms, BODY_25))
        case "deeplabcut":
            return write_deeplabcut(folder / "dive.csv", {"diver": arms})
        case "numbered":
            return write_numbered(folder / "dive.csv", poses)
    return write_named(folder / "dive.csv", poses)


@pytest.fixture
def language(client: httpx.Client, tmp_path: Path) -> str:
    """Import a language of a circle and a line, and return its id."""
    file = tmp_path / "pool.json"
    pool(circle=circle, line=line).save(file)
    answer = client.post("/api/v1/languages/import", content=file.read_bytes())
    assert answer.status_code == 201, answer.text
    return str(answer.json()["id"])


def recognised(client: httpx.Client, clip_id: str, language: str) -> httpx.Response:
    body = {"clip_id": clip_id, "language_id": language}
    return client.post("/api/v1/recognitions", json=body)


def added(client: httpx.Client, path: Path, **fields: str) -> dict[str, Any]:
    answer = upload(client, path, path.name, **fields)
    assert answer.status_code == 202, answer.text
    return finished(client, answer.json()["id"])


@pytest.mark.parametrize("form", ["openpose", "deeplabcut"])
def test_a_keypoint_file_becomes_a_clip_that_is_recognised(
    client: httpx.Client, language: str, tmp_path: Path, form: str
) -> None:
    path = written(tmp_path, form)
    clip = added(client, path, **BOTH)
    assert (clip["status"], clip["name"], clip["frames"]) == ("done", path.name, FRAMES)
    assert clip["shows_pictures"] is False
    assert clip["warnings"][0] == "there is no picture in this file: the skeleton is drawn"
    assert "choose the range of a gesture by hand" in clip["warnings"][1]
    place = f"{CLIPS}/{clip['id']}"
    assert client.get(f"{place}/takes").json() == []
    for part in ("poster", "filmstrip", "timeline"):
        assert client.get(f"{place}/{part}").status_code == 200
    (tmp_path / "video").write_bytes(client.get(f"{place}/video").content)
    shown = probe(tmp_path / "video")
    assert shown.frames == FRAMES
    poses = client.get(f"{place}/poses").json()
    assert poses["time"][-1] == pytest.approx(clip["duration"], abs=1e-6)
    column = poses["landmarks"].index("right_wrist")
    wrist = np.array([frame[column] for frame in poses["xy"]], dtype=np.float64)
    shown_at = recording(circle, frames=FRAMES, landmarks=tuple(BODY)).column("right_wrist")
    assert np.allclose(wrist, shown_at, atol=0.01)
    answer = recognised(client, clip["id"], language)
    assert answer.status_code == 201, answer.text
    assert answer.json()["label"] == "circle"


def test_a_keypoint_clip_can_become_a_gesture(client: httpx.Client, tmp_path: Path) -> None:
    clip = added(client, written(tmp_path, "openpose"), frame_rate="30")
    language = client.post("/api/v1/languages", json={"name": "theirs"}).json()["id"]
    body = {"label": "ring", "clip_id": clip["id"], "start": 0.2, "end": 1.1}
    answer = client.post(f"/api/v1/languages/{language}/gestures", json=body)
    assert answer.status_code == 201, answer.text
    assert recognised(client, clip["id"], language).json()["nearest"] == "ring"


def test_what_a_file_does_not_tell_is_asked_for_by_name(
    client: httpx.Client, settings: Settings, tmp_path: Path
) -> None:
    path = written(tmp_path, "numbered")
    problem = assert_problem(upload(client, path, "dive.csv"), 422, "frame_rate_needed")
    assert "field frame_rate" in str(problem["detail"])
    answer = upload(client, path, "dive.csv", frame_rate="25")
    assert_problem(answer, 422, "frame_size_needed")
    assert_nothing_kept(client, settings)
    clip = added(client, path, frame_rate="25", frame_size="1280 x 720")
    assert (clip["width"], clip["height"]) == (1280, 720)
    assert clip["duration"] == pytest.approx((FRAMES - 1) / 25)


def test_fields_that_say_what_they_cannot_are_refused(
    client: httpx.Client, settings: Settings, tmp_path: Path
) -> None:
    path = written(tmp_path, "numbered")
    for name, text in (("frame_rate", "fast"), ("frame_rate", "0"), ("frame_size", "wide")):
        problem = assert_problem(upload(client, path, "dive.csv", **{name: text}), 422, INVALID)
        assert name in str(problem["detail"])
    assert_nothing_kept(client, settings)


def test_a_language_that_needs_other_landmarks_is_refused_by_their_name(
    client: httpx.Client, language: str, tmp_path: Path
) -> None:
    poses = renamed(recording(circle, frames=FRAMES), {"right_wrist": "paw"})
    clip = added(client, write_named(tmp_path / "paws.csv", poses))
    assert any("left out" in warning and "PAW" in warning for warning in clip["warnings"])
    problem = assert_problem(recognised(client, clip["id"], language), 422, "landmark_missing")
    assert "paws.csv gives no landmark 'right_wrist'" in str(problem["detail"])


def test_what_is_no_keypoint_file_is_refused_and_nothing_is_kept(
    client: httpx.Client, settings: Settings, tmp_path: Path
) -> None:
    unreadable, unknown = "keypoints_unreadable", "unsupported_media_type"
    for name, content, code, words in (
        ("table.csv", b"a,b\n1,2\n", unreadable, "table.csv"),
        ("notes.json", b'{"notes": []}', unreadable, "list of frames"),
        ("notes.txt", b"x0,y0\n1,2\n", unknown, "OpenPose's folder as zip"),
        ("zeros.csv", bytes(100), unknown, "neither a video"),
    ):
        path = tmp_path / name
        path.write_bytes(content)
        status = 415 if code == unknown else 422
        problem = assert_problem(upload(client, path, name, **BOTH), status, code)
        assert words in str(problem["detail"])
        # Our own name of the file means nothing to whoever sent it.
        assert "keypoints-" not in str(problem["detail"])
    assert_nothing_kept(client, settings)
