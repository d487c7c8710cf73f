"""Chapters of one recording over HTTP: sent as one file, they become one clip."""

from __future__ import annotations

import base64
import shutil
from pathlib import Path

import httpx
import pytest

from app.recognition.recording.video import probe, read_frames
from app.settings import Limits, Settings
from app.store import Role, TokenFile
from tests.api.ingest.test_bag_clips import finished, two_divers
from tests.api.routes.clips.test_clips import CLIPS, assert_nothing_kept
from tests.api.routes.clips.test_resumable_uploads import TUS, UPLOADS, begun, sent
from tests.api.running import assert_problem, client_of, running, until
from tests.bags.bag_files import file_of, write_bag
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


def test_chapters_go_once_their_clip_stands_and_the_quota_counts_what_lies_there(
    client: httpx.Client, chapters: tuple[Path, str], settings: Settings
) -> None:
    whole, sizes = chapters
    content = whole.read_bytes()
    place = begun(client, len(content), chapters=sizes)
    clip_id = sent(client, place, 0, content).headers["content-location"].rsplit("/", 1)[-1]
    clip = finished(client, clip_id)
    folder = settings.data_dir / "clips" / clip_id
    kept = {path.name: path.stat().st_size for path in folder.iterdir()}
    assert sorted(kept) == ["filmstrip.jpg", "poster.jpg", "recording.npz", "video"]
    assert kept["video"] == clip["size"] == len(client.get(f"{CLIPS}/{clip_id}/video").content)
    assert not list((settings.data_dir / "uploads").iterdir())
    # The last part may come again, as its answer may be lost: by the bytes that were sent.
    again = sent(client, place, len(content) - 1, content[-1:])
    assert again.headers["upload-offset"] == str(len(content))
    assert again.headers["content-location"].endswith(clip_id)


def test_what_joining_needs_is_reserved_before(settings: Settings) -> None:
    free = shutil.disk_usage(settings.data_dir.parent).free
    tight = settings.model_copy(
        update={"max_clip_bytes": free, "limits": Limits(free_disk_bytes=free // 2)}
    )
    headers = TUS | {"Upload-Length": str(free // 3)}
    of_chapters = base64.b64encode(f"{free // 6},{free // 3 - free // 6}".encode()).decode()
    with running(tight) as server, client_of(server.address) as client:
        metadata = {"Upload-Metadata": f"chapters {of_chapters}"}
        assert_problem(client.post(UPLOADS, headers=headers | metadata), 507, "disk_full")
        assert client.post(UPLOADS, headers=headers).status_code == 201


def test_the_quota_of_joining_is_reserved_before(settings: Settings) -> None:
    token = TokenFile(settings.tokens).add("Ada", Role.EDIT, quota_bytes=3000)
    with running(settings) as server, client_of(server.address) as client:
        client.headers["Authorization"] = f"Bearer {token}"
        metadata = {"Upload-Metadata": f"chapters {base64.b64encode(b'1000,1000').decode()}"}
        headers = TUS | {"Upload-Length": "2000"}
        refused = client.post(UPLOADS, headers=headers | metadata)
        assert_problem(refused, 413, "quota_exceeded")
        assert client.post(UPLOADS, headers=headers).status_code == 201


def test_joining_that_fails_leaves_nothing(chapters: tuple[Path, str], settings: Settings) -> None:
    whole, sizes = chapters
    content = whole.read_bytes()
    limits = Limits(worker_file_bytes=len(content) // 4)
    with (
        running(settings.model_copy(update={"limits": limits})) as server,
        client_of(server.address) as client,
    ):
        with whole.open("rb") as file:
            answer = client.post(
                CLIPS, files={"file": ("dive.mp4", file)}, data={"chapters": sizes}
            )
        assert_problem(answer, 422, "decoder")
        place = begun(client, len(content), chapters=sizes)
        assert_problem(sent(client, place, 0, content), 422, "decoder")
        assert_nothing_kept(client, settings)
        assert not list((settings.data_dir / "uploads").iterdir())


def test_a_video_that_could_not_be_made_leaves_nothing(settings: Settings, tmp_path: Path) -> None:
    bag = file_of(write_bag(tmp_path / "dive", two_divers()))
    limits = Limits(worker_file_bytes=100)
    with (
        running(settings.model_copy(update={"limits": limits})) as server,
        client_of(server.address) as client,
    ):
        with bag.open("rb") as file:
            data = {"topic": "/leader/pose_keypoints"}
            answer = client.post(CLIPS, files={"file": ("dive.mcap", file)}, data=data)
        clip_id = answer.json()["id"]
        until(lambda: client.get(f"{CLIPS}/{clip_id}").json()["status"] == "failed")
        folder = settings.data_dir / "clips" / clip_id
        assert [path.name for path in folder.iterdir()] == ["bag"]
