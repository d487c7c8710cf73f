"""Chapters of one recording over HTTP: sent as one file, they become one clip."""

from __future__ import annotations

from pathlib import Path

import httpx
import pytest

from app.recognition.recording.video import probe, read_frames
from app.settings import Settings
from tests.api.ingest.test_bag_clips import finished
from tests.api.routes.clips.test_clips import CLIPS, assert_nothing_kept
from tests.api.routes.clips.test_resumable_uploads import TUS, begun, sent
from tests.api.running import assert_problem
from tests.recognition.damaged_clips import write_clip

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("installed_models")]


@pytest.fixture
def chapters(tmp_path: Path) -> tuple[Path, str]:
    """Return two chapters in one file, and the bytes of each."""
    parts = [write_clip(tmp_path / f"{each}.mp4", frames=each).read_bytes() for each in (9, 4)]
    whole = tmp_path / "whole"
    whole.write_bytes(b"".join(parts))
    return whole, ",".join(str(len(part)) for part in parts)


def frames_of(client: httpx.Client, clip_id: str, copy: Path) -> int:
    """Return the frames of the video that players get, after a look at what the clip says."""
    clip = finished(client, clip_id)
    answer = client.get(f"{CLIPS}/{clip_id}/video")
    assert (answer.status_code, answer.headers["content-type"]) == (200, "video/mp4")
    copy.write_bytes(answer.content)
    assert clip["frames"] == probe(copy).frames
    with read_frames(copy) as frames:
        return len(list(frames))


def test_chapters_become_one_clip_whose_video_plays(
    client: httpx.Client, chapters: tuple[Path, str], settings: Settings, tmp_path: Path
) -> None:
    whole, sizes = chapters
    key = {"Idempotency-Key": "dive 1"}
    with whole.open("rb") as file:
        answer = client.post(
            CLIPS, files={"file": ("dive.mp4", file)}, data={"chapters": sizes}, headers=key
        )
    assert answer.status_code == 202, answer.text
    clip_id = answer.json()["id"]
    assert frames_of(client, clip_id, tmp_path / "copy") == 13
    assert client.get(f"{CLIPS}/{clip_id}/poster").content[:2] == b"\xff\xd8"
    assert client.post(f"{CLIPS}/{clip_id}/turn", json={"degrees": 90}).status_code == 202
    assert finished(client, clip_id)["height"] == 64
    assert frames_of(client, clip_id, tmp_path / "copy") == 13
    with whole.open("rb") as file:
        again = client.post(
            CLIPS, files={"file": ("dive.mp4", file)}, data={"chapters": sizes}, headers=key
        )
    assert again.json()["id"] == clip_id
    left = [path.name for path in (settings.data_dir / "clips").iterdir()]
    assert left == [clip_id]


def test_a_resumable_upload_of_chapters_is_one_clip(
    client: httpx.Client, chapters: tuple[Path, str], tmp_path: Path
) -> None:
    whole, sizes = chapters
    content = whole.read_bytes()
    place = begun(client, len(content), chapters=sizes)
    assert sent(client, place, 0, content[:1000]).status_code == 204
    answer = sent(client, place, 1000, content[1000:])
    assert answer.status_code == 204, answer.text
    clip_id = answer.headers["content-location"].rsplit("/", 1)[-1]
    assert client.head(place, headers=TUS).headers["content-location"].endswith(clip_id)
    assert frames_of(client, clip_id, tmp_path / "copy") == 13


@pytest.mark.parametrize(
    ("sizes", "code"),
    [
        ("4", "field_invalid"),
        ("4,-4", "field_invalid"),
        ("4,5", "video_unreadable"),
        ("{odd}", "video_unreadable"),
    ],
)
def test_what_is_no_chapters_is_refused(
    client: httpx.Client,
    chapters: tuple[Path, str],
    settings: Settings,
    sizes: str,
    code: str,
) -> None:
    whole, _ = chapters
    odd = f"100,{whole.stat().st_size - 100}"
    with whole.open("rb") as file:
        data = {"chapters": sizes.format(odd=odd)}
        answer = client.post(CLIPS, files={"file": ("dive.mp4", file)}, data=data)
    assert_problem(answer, 422, code)
    assert_nothing_kept(client, settings)


def test_chapters_that_are_coded_differently_are_refused_with_the_reason(
    client: httpx.Client, settings: Settings, tmp_path: Path
) -> None:
    parts = [
        write_clip(tmp_path / f"{width}.mp4", size=(width, 48)).read_bytes() for width in (64, 96)
    ]
    whole = tmp_path / "whole"
    whole.write_bytes(b"".join(parts))
    answer = begun(
        client, whole.stat().st_size, chapters=",".join(str(len(part)) for part in parts)
    )
    problem = assert_problem(sent(client, answer, 0, whole.read_bytes()), 422, "video_unreadable")
    assert "a chapter (96 x 48 h264) is coded otherwise" in str(problem["detail"])
    assert client.head(answer, headers=TUS).status_code == 404
    assert_nothing_kept(client, settings)
