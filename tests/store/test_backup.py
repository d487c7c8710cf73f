"""A backup holds what was acknowledged, and a restore brings it all back or nothing."""

from __future__ import annotations

import zipfile
from pathlib import Path

import httpx
import pytest

from app.recognition.errors import OsgError
from app.settings import Settings
from app.store.backup import DATABASE, restore_backup, write_backup
from tests.api.languages import LANGUAGES, add_gesture
from tests.api.recordings import add_recorded_clip, recording_of
from tests.api.running import running
from tests.command_line import OsgStudio
from tests.postgres import Cluster
from tests.s3 import BUCKET, S3Server


@pytest.fixture
def kept(tmp_path: Path) -> Path:
    """Return the backup of a server with a clip, a language and a recognition, that runs on."""
    settings = Settings(data_dir=tmp_path / "data", samples_dir=tmp_path / "none")
    target = tmp_path / "kept.zip"
    with running(settings) as server, httpx.Client(base_url=server.address, timeout=60) as client:
        clip = add_recorded_clip(server.studio, recording_of("circle"))
        server.studio.clips.turn(clip, 90)
        server.studio.clips.video(clip).write_bytes(b"turned")
        language = client.post(LANGUAGES, json={"name": "pool"}).json()["id"]
        add_gesture(client, language, clip)
        body = {"clip_id": clip, "language_id": language}
        assert client.post("/api/v1/recognitions", json=body).status_code == 201
        assert write_backup(settings.data_dir, target) == 1
        client.post(LANGUAGES, json={"name": "after the backup"})
    return target


def test_all_comes_back_on_another_machine(kept: Path, tmp_path: Path) -> None:
    settings = Settings(data_dir=tmp_path / "new", samples_dir=tmp_path / "none")
    assert restore_backup(kept, settings.data_dir) == 1
    with running(settings) as server, httpx.Client(base_url=server.address, timeout=60) as client:
        (language,) = client.get(LANGUAGES).json()
        assert (language["name"], language["revision"], language["labels"]) == (
            "pool",
            2,
            ["circle"],
        )
        (clip,) = client.get("/api/v1/clips").json()
        assert len(client.get(f"/api/v1/clips/{clip['id']}/takes").json()) == 1
        assert client.get(f"/api/v1/clips/{clip['id']}/video").content == b"turned"
        assert clip["turn"] == 90
        assert len(client.get("/api/v1/recognitions").json()) == 1
    assert not list(settings.data_dir.glob(".restoring-*"))


def test_a_damaged_backup_restores_nothing(kept: Path, tmp_path: Path) -> None:
    content = bytearray(kept.read_bytes())
    damaged = tmp_path / "damaged.zip"
    for place in range(0, len(content), len(content) // 25):
        changed = content.copy()
        changed[place] ^= 0xFF
        damaged.write_bytes(changed)
        folder = tmp_path / f"from {place}"
        try:
            restore_backup(damaged, folder)
        except OsgError:
            assert not (folder / DATABASE).exists()
            assert not list(folder.glob("clips/*"))


@pytest.mark.parametrize("name", ["../../evil", "clips/../evil", "/etc/passwd", "clips/x/video"])
def test_only_names_of_ours_become_paths(kept: Path, tmp_path: Path, name: str) -> None:
    hostile = tmp_path / "hostile.zip"
    with zipfile.ZipFile(kept) as archive, zipfile.ZipFile(hostile, "w") as written:
        manifest = archive.read("manifest.json").decode()
        first = next(each for each in archive.namelist() if each.startswith("clips/"))
        written.writestr("manifest.json", manifest.replace(first, name))
        for each in archive.namelist():
            if each != "manifest.json":
                written.writestr(name if each == first else each, archive.read(each))
    with pytest.raises(OsgError, match="which no backup does"):
        restore_backup(hostile, tmp_path / "new")


def test_what_is_there_is_never_overwritten(kept: Path, tmp_path: Path) -> None:
    with pytest.raises(OsgError, match="holds a database already"):
        restore_backup(kept, tmp_path / "data")
    before = kept.read_bytes()
    with pytest.raises(OsgError, match=r"holds no studio\.db"):
        write_backup(tmp_path / "nothing", kept)
    assert kept.read_bytes() == before


def test_what_is_no_backup_is_said_so(tmp_path: Path) -> None:
    other = tmp_path / "other.zip"
    other.write_bytes(b"no zip")
    for source in (other, tmp_path / "absent.zip", tmp_path):
        with pytest.raises(OsgError, match=r"other\.zip is no backup|cannot read"):
            restore_backup(source, tmp_path / "new")


def test_clips_of_an_object_store_are_backed_up_and_come_back_into_another(
    s3: S3Server, tmp_path: Path, osg_studio: OsgStudio, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("OSG_SAMPLES_DIR", str(tmp_path / "none"))
    monkeypatch.setenv("OSG_STORAGE", f"s3://{BUCKET}/first")
    monkeypatch.setenv("OSG_DATA_DIR", str(tmp_path / "data"))
    with running(Settings()) as server:
        clip = add_recorded_clip(server.studio, recording_of("circle"))
    # Of a folder that is only a copy, half is enough.
    (tmp_path / "data" / "clips" / clip / "video").unlink()
    assert osg_studio("backup", str(tmp_path / "kept.zip")).code == 0
    monkeypatch.setenv("OSG_STORAGE", f"s3://{BUCKET}/second")
    monkeypatch.setenv("OSG_DATA_DIR", str(tmp_path / "new"))
    assert osg_studio("restore", str(tmp_path / "kept.zip")).code == 0
    kept = {f"{clip}/video", f"{clip}/recording.npz"}
    assert s3.names() == {f"{prefix}/{name}" for prefix in ("first", "second") for name in kept}
    with running(Settings()) as server, httpx.Client(base_url=server.address, timeout=60) as client:
        assert len(client.get(f"/api/v1/clips/{clip}/video").content) == 1024
        assert len(client.get(f"/api/v1/clips/{clip}/takes").json()) == 1


def test_clips_in_a_folder_of_their_own_are_backed_up(
    tmp_path: Path, osg_studio: OsgStudio, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("OSG_SAMPLES_DIR", str(tmp_path / "none"))
    monkeypatch.setenv("OSG_STORAGE", str(tmp_path / "clips"))
    monkeypatch.setenv("OSG_DATA_DIR", str(tmp_path / "data"))
    with running(Settings()) as server:
        clip = add_recorded_clip(server.studio, recording_of("circle"))
    assert osg_studio("backup", str(tmp_path / "kept.zip")).code == 0
    monkeypatch.setenv("OSG_STORAGE", str(tmp_path / "others"))
    monkeypatch.setenv("OSG_DATA_DIR", str(tmp_path / "new"))
    assert osg_studio("restore", str(tmp_path / "kept.zip")).code == 0
    assert (tmp_path / "others" / clip / "recording.npz").is_file()


def test_a_library_moves_to_postgresql_and_back(
    kept: Path,
    postgres: Cluster,
    tmp_path: Path,
    osg_studio: OsgStudio,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    url = postgres.new_database()
    monkeypatch.setenv("OSG_SAMPLES_DIR", str(tmp_path / "none"))
    monkeypatch.setenv("OSG_DATABASE_URL", url)
    monkeypatch.setenv("OSG_DATA_DIR", str(tmp_path / "postgresql"))
    damaged = tmp_path / "damaged.zip"
    damaged.write_bytes(kept.read_bytes()[:-100])
    assert osg_studio("restore", str(damaged)).code == 2
    moved = osg_studio("restore", str(kept))
    assert (moved.code, "1 clips and all languages" in moved.error) == (0, True)
    with running(Settings()) as server, httpx.Client(base_url=server.address, timeout=60) as client:
        (clip,) = client.get("/api/v1/clips").json()
        assert len(client.get(f"/api/v1/clips/{clip['id']}/takes").json()) == 1
        invitations = f"{LANGUAGES}/{client.get(LANGUAGES).json()[0]['id']}/invitations"
        invited = client.post(invitations, json={"people": 1, "days": 7})
        assert invited.status_code == 201, invited.text
        # Numbers go on after those of the entries that were copied.
        assert client.post(LANGUAGES, json={"name": "on PostgreSQL"}).status_code == 201
        numbers = [entry["id"] for entry in client.get("/api/v1/audit").json()]
        assert numbers == sorted(set(numbers), reverse=True)
        back = tmp_path / "back.zip"
        assert osg_studio("backup", str(back)).code == 0
    again = osg_studio("restore", str(kept), "--data-dir", str(tmp_path / "again"))
    assert (again.code, "holds clips or languages already" in again.error) == (2, True)
    assert not (tmp_path / "again" / "clips").exists()
    monkeypatch.delenv("OSG_DATABASE_URL")
    settings = Settings(data_dir=tmp_path / "sqlite")
    assert restore_backup(back, settings.data_dir) == 1
    with running(settings) as server, httpx.Client(base_url=server.address, timeout=60) as client:
        assert [each["name"] for each in client.get(LANGUAGES).json()] == ["pool", "on PostgreSQL"]
        assert client.get("/api/v1/clips").json() == [clip]
        assert len(client.get("/api/v1/recognitions").json()) == 1
        # A move withdraws invitations, as every restore does.
        (invitation,) = client.get(invitations).json()
        assert invitation["closed"] == "withdrawn"
        assert [entry["id"] for entry in client.get("/api/v1/audit").json()] == numbers
