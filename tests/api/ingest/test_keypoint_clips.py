"""Other programs' keypoint files over HTTP: they become clips without pictures."""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

from app.recognition.poses.skeletons import BODY_25, HALPE_26
from app.recognition.recording.video import probe
from app.settings import Settings
from tests.api.ingest.test_bag_clips import CLIPS, assert_nothing_kept, finished, upload
from tests.api.running import assert_problem
from tests.keypoint_files.files import (
    renamed,
    write_named,
    write_numbered,
    write_openpose,
    write_rows,
)
from tests.keypoint_files.test_keypoint_sets import WHOLE, alphapose, mmpose, points_of, wide
from tests.recognition.demonstrations import pool
from tests.recognition.strategies import BODY, circle, line, recording

pytestmark = pytest.mark.slow

FRAMES = 40

INVALID = "field_invalid"

BOTH = {"frame_rate": "30", "frame_size": "640x480"}


def packed(folder: Path, *, prefix: str = "dive/") -> Path:
    """Pack a folder into a zip beside it, as a person would."""
    path = folder.with_suffix(".zip")
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in sorted(folder.iterdir()):
            archive.write(file, f"{prefix}{file.name}")
    return path


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


def test_a_keypoint_file_becomes_a_clip_that_is_recognised(
    client: httpx.Client, language: str, tmp_path: Path
) -> None:
    arms = recording(circle, frames=FRAMES, landmarks=tuple(BODY))
    path = packed(write_openpose(tmp_path / "json", arms, BODY_25))
    clip = added(client, path, **BOTH)
    assert (clip["status"], clip["name"], clip["frames"]) == ("done", path.name, FRAMES)
    assert clip["shows_pictures"] is False
    assert clip["warnings"][0] == "there is no picture in this file: the skeleton is drawn"
    # Only languages with the salute as trigger are told that nobody is seen to salute.
    assert "choose the range of a gesture by hand" in clip["salute_warnings"][-1]
    assert not any("choose the range" in warning for warning in clip["warnings"])
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
    assert np.allclose(wrist, arms.column("right_wrist"), atol=0.01)
    answer = recognised(client, clip["id"], language)
    assert answer.status_code == 201, answer.text
    assert answer.json()["label"] == "circle"


def test_files_of_other_tools_are_read_or_refused_by_their_reason(
    client: httpx.Client, tmp_path: Path
) -> None:
    points = points_of(HALPE_26)
    assert added(client, alphapose(tmp_path, points), **BOTH)["frames"] == len(points)
    tabs = wide(tmp_path, points).rename(tmp_path / "pose.tsv")
    tabs.write_text(tabs.read_text().replace(",", "\t"))
    assert added(client, tabs, **BOTH)["status"] == "done"
    whole = mmpose(tmp_path, points_of(WHOLE[133]), meta_info={"dataset_name": "coco"})
    told = added(client, whole, **BOTH)["salute_warnings"]
    assert not any("no hands in this file" in each for each in told)
    content = whole.read_text()
    pointer = "version https://git-lfs.github.com/spec/v1\n"
    for name, text, code, words in (
        ("cut.json", content[:5000], "keypoints_unreadable", "breaks off at byte 5000"),
        ("few.json", "[[[1, 2], [3, 4]]]", "keypoints_unreadable", "has 2 keypoints without names"),
        ("pose.json", pointer, "keypoints_unreadable", "is a Git LFS pointer"),
        ("dive.mp4", pointer, "unsupported_media_type", "is a Git LFS pointer"),
        ("dive.h264", "\0\0\0\1\6\5", "unsupported_media_type", "a raw stream of H.264"),
    ):
        (tmp_path / name).write_text(text)
        answer = upload(client, tmp_path / name, name, **BOTH)
        status = 415 if code == "unsupported_media_type" else 422
        assert words in str(assert_problem(answer, status, code)["detail"])


def test_what_a_file_does_not_tell_is_asked_for_and_taken_with_it(
    client: httpx.Client, settings: Settings, tmp_path: Path
) -> None:
    path = write_numbered(tmp_path / "dive.csv", recording(circle, frames=FRAMES))
    problem = assert_problem(upload(client, path, "dive.csv"), 422, "frame_rate_needed")
    assert "dive.csv: the file counts frames" in str(problem["detail"])
    assert_nothing_kept(client, settings)
    clip = added(client, path, frame_rate="25", frame_size="1280 x 720")
    assert (clip["width"], clip["height"]) == (1280, 720)
    assert clip["duration"] == pytest.approx((FRAMES - 1) / 25)


def test_fields_that_say_what_they_cannot_are_refused(
    client: httpx.Client, settings: Settings, tmp_path: Path
) -> None:
    path = write_numbered(tmp_path / "dive.csv", recording(circle, frames=FRAMES))
    for name, text, words in (
        ("frame_rate", "fast", "frame_rate"),
        ("frame_rate", "0", "frame_rate"),
        ("frame_size", "wide", "frame_size"),
        ("frame_size", "1x65535", "a width of 1"),
        ("frame_size", "640x20000", "a height of more than 16384"),
    ):
        given = {"frame_rate": "30", name: text}
        refused = upload(client, path, "dive.csv", **given)
        assert refused.status_code == 422
        assert words in str(refused.json()["detail"])
    assert_nothing_kept(client, settings)


def test_a_language_that_needs_other_landmarks_is_refused_by_their_name(
    client: httpx.Client, language: str, tmp_path: Path
) -> None:
    poses = renamed(recording(circle, frames=FRAMES), {"right_wrist": "paw"})
    clip = added(client, write_named(tmp_path / "paws.csv", poses))
    assert any("left out" in warning and "PAW" in warning for warning in clip["warnings"])
    problem = assert_problem(recognised(client, clip["id"], language), 422, "landmark_missing")
    assert "paws.csv gives no landmark 'right_wrist'" in str(problem["detail"])


def test_what_is_no_text_or_has_another_name_is_no_keypoint_file(
    client: httpx.Client, settings: Settings, tmp_path: Path
) -> None:
    for name, content in (("notes.txt", b"x0,y0\n1,2\n"), ("zeros.csv", bytes(100))):
        path = tmp_path / name
        path.write_bytes(content)
        problem = assert_problem(upload(client, path, name), 415, "unsupported_media_type")
        assert "OpenPose's folder as zip" in str(problem["detail"])
    assert_nothing_kept(client, settings)


def test_no_gesture_is_read_across_a_hole_and_the_timeline_shows_it(
    client: httpx.Client, language: str, tmp_path: Path
) -> None:
    poses = recording(line, frames=FRAMES)
    rows = [
        [time + (9.0 if at > FRAMES // 2 else 0.0), *place.ravel().tolist()]
        for at, (time, place) in enumerate(zip(poses.time, poses.xy, strict=True))
    ]
    heads = ["time", *(f"{name}_{axis}" for name in poses.landmarks for axis in "xy")]
    clip = added(client, write_rows(tmp_path / "dive.csv", [heads, *rows]), frame_size="640x480")
    assert "no gesture is read across it" in clip["warnings"][1]
    answer = recognised(client, clip["id"], language).json()
    assert answer["label"] is None
    assert "too little was seen from" in answer["fault"]
    (unseen,) = answer["unseen"]
    assert unseen["end"] - unseen["start"] > 1
    ((start, end),) = client.get(f"/api/v1/clips/{clip['id']}/timeline").json()["unseen"]
    assert end - start > 9
