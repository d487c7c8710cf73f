"""Clips over HTTP: what is accepted, what is refused, and that refusals leave nothing behind."""

from pathlib import Path

import httpx
import pytest

from app.api.services.running_studio import Studio
from app.recognition.recording.video import probe
from app.settings import Limits, Settings
from app.store import Clip, Job
from tests.api.recordings import add_recorded_clip, recording_of
from tests.api.running import assert_problem, client_of, running, until
from tests.recognition.damaged_clips import (
    IMPOSTORS,
    PLAYLISTS,
    cut_off,
    flipped,
    sound_only,
    write_clip,
    write_program_stream,
)

pytestmark = pytest.mark.slow

CLIPS = "/api/v1/clips"


def upload(client: httpx.Client, path: Path, name: str = "dive.mp4", **more: str) -> httpx.Response:
    with path.open("rb") as file:
        return client.post(CLIPS, files={"file": (name, file)}, headers=more)


def assert_nothing_kept(client: httpx.Client, settings: Settings) -> None:
    assert client.get(CLIPS).json() == []
    assert list((settings.data_dir / "clips").iterdir()) == []
    assert client.get("/healthz").status_code == 200


def test_a_clip_is_stored_and_its_job_waits(client: httpx.Client, small_clip: Path) -> None:
    answer = upload(client, small_clip)
    assert answer.status_code == 202
    clip = client.get(f"{CLIPS}/{answer.json()['id']}").json()
    assert clip["job_id"] == answer.json()["job_id"]
    assert (clip["width"], clip["height"], clip["name"]) == (64, 48, "dive.mp4")
    assert clip["size"] == small_clip.stat().st_size
    assert client.get(f"{CLIPS}/{clip['id']}/video").content == small_clip.read_bytes()
    assert client.get(CLIPS).json()[0]["id"] == clip["id"]


def test_a_clip_has_a_picture_while_its_job_waits(
    client: httpx.Client, studio: Studio, small_clip: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def wait(_job: Job) -> None:
        """Leave the job in the queue."""

    monkeypatch.setattr(studio.extractions, "submit", wait)
    clip_id = upload(client, small_clip).json()["id"]
    poster = client.get(f"{CLIPS}/{clip_id}/poster")
    assert client.get(f"{CLIPS}/{clip_id}").json()["status"] == "queued"
    assert poster.headers["content-type"] == "image/jpeg"
    assert poster.content[:3] == b"\xff\xd8\xff"
    # A job that replaces the picture while it is sent changes no length.
    assert "accept-ranges" not in poster.headers


@pytest.mark.usefixtures("installed_models")
def test_a_clip_gets_poses_takes_and_a_poster(client: httpx.Client, small_clip: Path) -> None:
    clip_id = upload(client, small_clip).json()["id"]
    until(lambda: client.get(f"{CLIPS}/{clip_id}").json()["status"] == "done")
    clip = client.get(f"{CLIPS}/{clip_id}").json()
    assert clip["frames"] == 12
    assert any("no person in 12 of 12 frames" in warning for warning in clip["warnings"])
    poses = client.get(f"{CLIPS}/{clip_id}/poses").json()
    assert len(poses["time"]) == len(poses["xy"]) == 12
    assert poses["xy"][0][0] == [None, None]
    assert client.get(f"{CLIPS}/{clip_id}/takes").json() == []
    poster = client.get(f"{CLIPS}/{clip_id}/poster")
    assert poster.headers["content-type"] == "image/jpeg"
    assert poster.content[:2] == b"\xff\xd8"


@pytest.mark.usefixtures("installed_models")
def test_the_program_stream_of_an_old_camcorder_gets_poses_and_a_poster(
    client: httpx.Client, tmp_path: Path
) -> None:
    sent = upload(client, write_program_stream(tmp_path / "dive.mpg"), "dive.mpg")
    assert sent.status_code == 202, sent.text
    place = f"{CLIPS}/{sent.json()['id']}"
    until(lambda: client.get(place).json()["status"] in ("done", "failed"))
    clip = client.get(place).json()
    assert (clip["status"], clip["frames"]) == ("done", 50)
    assert client.get(f"{place}/poster").content[:2] == b"\xff\xd8"


@pytest.mark.usefixtures("installed_models")
def test_a_duration_that_a_browser_did_not_write_is_measured(
    client: httpx.Client, tmp_path: Path
) -> None:
    clip = write_clip(tmp_path / "dive.webm", codec="libvpx", options={"live": "1"})
    clip_id = upload(client, clip, "dive.webm").json()["id"]
    assert client.get(f"{CLIPS}/{clip_id}").json()["duration"] is None
    until(lambda: client.get(f"{CLIPS}/{clip_id}").json()["status"] == "done")
    assert client.get(f"{CLIPS}/{clip_id}").json()["duration"] == pytest.approx(12 / 25)


@pytest.mark.withstands(row="H25")
def test_without_models_the_app_works_and_the_job_says_what_is_missing(
    settings: Settings, small_clip: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("OSG_MODELS_DIR", str(tmp_path / "no models"))
    with running(settings) as server, client_of(server.address) as client:
        assert client.get("/healthz").json()["status"] == "models_missing"
        clip_id = upload(client, small_clip).json()["id"]
        until(lambda: client.get(f"{CLIPS}/{clip_id}").json()["status"] == "failed")
        clip = client.get(f"{CLIPS}/{clip_id}").json()
        assert clip["error_code"] == "model_missing"
        assert "osg-studio models install" in clip["error"]
        assert_problem(client.get(f"{CLIPS}/{clip_id}/poses"), 409, "clip_not_ready")
        assert_problem(client.get(f"{CLIPS}/{clip_id}/takes"), 409, "clip_not_ready")
        again = client.post(f"{CLIPS}/{clip_id}/jobs")
        assert again.status_code == 202
        assert again.json()["job_id"] != clip["job_id"]


@pytest.mark.withstands(row="H07")
def test_what_is_no_video_is_refused_whatever_its_name(
    client: httpx.Client, settings: Settings, tmp_path: Path
) -> None:
    path = tmp_path / "file"
    playlists = {kind: write(tmp_path).encode() for kind, write in PLAYLISTS.items()}
    for kind, content in {**IMPOSTORS, **playlists}.items():
        path.write_bytes(content)
        # What is empty or begins like a video is probed, and found not to be one.
        if kind == "nothing" or "MP4" in kind or "Matroska" in kind:
            assert_problem(upload(client, path), 422, "video_unreadable")
        else:
            assert_problem(upload(client, path), 415, "unsupported_media_type")
    assert_nothing_kept(client, settings)


def test_sound_alone_is_422(client: httpx.Client, settings: Settings, tmp_path: Path) -> None:
    answer = upload(client, sound_only(tmp_path / "song.mp4"))
    assert "no video" in str(assert_problem(answer, 422, "video_unreadable")["detail"])
    assert_nothing_kept(client, settings)


def test_a_clip_with_flipped_bytes_is_taken_or_refused_but_never_an_error(
    client: httpx.Client, small_clip: Path
) -> None:
    answer = upload(client, flipped(small_clip, seed=1, bytes_changed=40))
    assert answer.status_code in (202, 415, 422)
    if answer.status_code == 202:
        place = f"/api/v1/jobs/{answer.json()['job_id']}"
        until(lambda: client.get(place).json()["status"] in ("done", "failed"))
    assert client.get("/healthz").status_code == 200


@pytest.mark.withstands(row="H08")
def test_a_damaged_video_is_422(client: httpx.Client, settings: Settings, small_clip: Path) -> None:
    for share in (0.5, 0.02):
        assert_problem(upload(client, cut_off(small_clip, share)), 422, "video_unreadable")
    assert_nothing_kept(client, settings)


@pytest.mark.parametrize("form", ["multipart", "chunked"])
@pytest.mark.withstands(row="H02")
def test_a_clip_beyond_the_limit_is_413(settings: Settings, tmp_path: Path, form: str) -> None:
    small = settings.model_copy(update={"max_clip_bytes": 50_000})
    path = tmp_path / "large.mp4"
    path.write_bytes(b"\0\0\0\x18ftypmp42" + bytes(400_000))
    with running(small) as server, client_of(server.address) as client:
        if form == "chunked":
            head = b'--b\r\nContent-Disposition: form-data; name="file"; filename="x"\r\n\r\n'
            parts = [head, *[path.read_bytes()[:10_000]] * 20, b"\r\n--b--\r\n"]
            kind = {"Content-Type": "multipart/form-data; boundary=b"}
            answer = client.post(CLIPS, content=iter(parts), headers=kind)
        else:
            answer = upload(client, path)
        assert assert_problem(answer, 413, "too_large")["limit"]
        assert_nothing_kept(client, small)


def test_a_full_disk_is_507_and_says_when_to_come_back(
    settings: Settings, small_clip: Path
) -> None:
    full = settings.model_copy(update={"limits": Limits(free_disk_bytes=2**62)})
    with running(full) as server, client_of(server.address) as client:
        answer = upload(client, small_clip)
        assert_problem(answer, 507, "disk_full")
        assert answer.headers["retry-after"]
        assert_nothing_kept(client, full)


@pytest.mark.withstands(row="H19")
def test_a_repeated_upload_is_one_clip(client: httpx.Client, small_clip: Path) -> None:
    key = {"Idempotency-Key": "7f3c"}
    first = upload(client, small_clip, **key).json()
    assert upload(client, small_clip, **key).json() == first
    assert upload(client, small_clip, **{"Idempotency-Key": "other"}).json() != first
    assert len(client.get(CLIPS).json()) == 2


def test_a_key_that_was_used_for_another_file_is_refused(
    client: httpx.Client, small_clip: Path, tmp_path: Path
) -> None:
    key = {"Idempotency-Key": "7f3c"}
    first = upload(client, small_clip, **key).json()
    other = write_clip(tmp_path / "other.mp4", frames=3)
    assert_problem(upload(client, other, **key), 422, "idempotency_key_reused")
    assert len(client.get(CLIPS).json()) == 1
    client.delete(f"{CLIPS}/{first['id']}")
    gone = assert_problem(upload(client, small_clip, **key), 409, "clip_deleted")
    assert gone["clip_id"] == first["id"]


@pytest.mark.withstands(row="H23")
def test_too_many_waiting_clips_are_429(settings: Settings, small_clip: Path) -> None:
    narrow = settings.model_copy(update={"limits": Limits(max_jobs_per_client=1)})
    with running(narrow) as server, client_of(server.address) as client:
        # Stored without the runner's knowledge, so that the job waits as long as the test needs.
        partial = server.studio.clips.new_partial()
        partial.write_bytes(b"video")
        clip = Clip(name="first", media_type="video/mp4", size=5, width=1, height=1)
        server.studio.clips.add(clip, partial, "127.0.0.1")
        answer = upload(client, small_clip)
        assert_problem(answer, 429, "queue_full")
        assert answer.headers["retry-after"]
        (waiting,) = client.get(CLIPS).json()
        assert client.delete(f"/api/v1/jobs/{waiting['job_id']}").json()["status"] == "cancelled"
        assert upload(client, small_clip).status_code == 202


def test_a_deleted_clip_can_be_restored(client: httpx.Client, circle_clip: str) -> None:
    place = f"{CLIPS}/{circle_clip}"
    assert client.delete(place).status_code == 204
    for address in ("", "/video", "/poster", "/poses", "/takes"):
        assert_problem(client.get(place + address), 404, "not_found")
    assert_problem(client.delete(place), 404, "not_found")
    assert client.post(f"{place}/restore").json()["status"] == "done"
    assert client.get(f"{place}/takes").json() != []


@pytest.mark.withstands(row="H17")
def test_what_users_gave_us_cannot_run_in_a_browser(client: httpx.Client, studio: Studio) -> None:
    clip_id = add_recorded_clip(studio, recording_of("line"), name='"><b>\u202e.mp4')
    headers = client.get(f"{CLIPS}/{clip_id}/video").headers
    assert headers["x-content-type-options"] == "nosniff"
    assert "sandbox" in headers["content-security-policy"]
    assert headers["content-disposition"].startswith("inline; filename*=utf-8''")


def test_takes_give_seconds_of_salutes_and_stroke(client: httpx.Client, studio: Studio) -> None:
    clip_id = add_recorded_clip(studio, recording_of("circle", "line"))
    takes = client.get(f"{CLIPS}/{clip_id}/takes").json()
    assert [take["closed"] for take in takes] == [True, True]
    for take in takes:
        assert take["start"] <= take["stroke_start"] < take["stroke_end"] <= take["end"]
    assert takes[0]["end"] < takes[1]["start"]


@pytest.mark.withstands(row="H18")
def test_an_id_that_names_nothing_is_404(client: httpx.Client) -> None:
    for clip_id in ("x", "0" * 32, "..%2F..%2Fetc%2Fpasswd", "a" * 5000, "%00"):
        assert_problem(client.get(f"{CLIPS}/{clip_id}"), 404, "not_found")
        assert_problem(client.delete(f"{CLIPS}/{clip_id}"), 404, "not_found")
    for path in (f"{CLIPS}/a%00b/video", "/%00"):
        assert_problem(client.get(path), 404, "not_found")


@pytest.mark.usefixtures("installed_models")
def test_a_turned_clip_is_read_again_and_shown_upright(
    client: httpx.Client, small_clip: Path, studio: Studio, tmp_path: Path
) -> None:
    clip_id = upload(client, small_clip).json()["id"]
    turn = f"{CLIPS}/{clip_id}/turn"
    done = lambda: client.get(f"{CLIPS}/{clip_id}").json()["status"] == "done"  # noqa: E731
    until(done)
    assert client.get(f"{CLIPS}/{clip_id}/poses").json()["frame_size"] == [64, 48]
    assert client.post(turn, json={"degrees": 45}).status_code == 422
    assert client.post(turn, json={"degrees": 90}).status_code == 202
    until(done)
    clip = client.get(f"{CLIPS}/{clip_id}").json()
    assert (clip["width"], clip["height"], clip["turn"]) == (48, 64, 90)
    assert client.get(f"{CLIPS}/{clip_id}/poses").json()["frame_size"] == [48, 64]
    video = client.get(f"{CLIPS}/{clip_id}/video")
    assert video.headers["content-type"] == "video/mp4"
    shown = tmp_path / "shown"
    shown.write_bytes(video.content)
    assert (probe(shown).width, probe(shown).height, probe(shown).frames) == (48, 64, 12)
    # The received file stays, and turning the picture back shows it again.
    assert client.post(turn, json={"degrees": 270}).status_code == 202
    until(done)
    assert client.get(f"{CLIPS}/{clip_id}").json()["turn"] == 0
    assert client.get(f"{CLIPS}/{clip_id}/video").content == small_clip.read_bytes()


def test_only_pictures_that_were_read_can_be_turned(client: httpx.Client, small_clip: Path) -> None:
    clip_id = upload(client, small_clip).json()["id"]
    refused = client.post(f"{CLIPS}/{clip_id}/turn", json={"degrees": 90})
    assert_problem(refused, 409, "clip_not_ready")
    assert_problem(client.post(f"{CLIPS}/none/turn", json={"degrees": 90}), 404, "not_found")
