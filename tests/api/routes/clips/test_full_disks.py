"""Uploads on a disk, or in a database, that is full: nothing that was acknowledged is lost."""

from __future__ import annotations

import os
import shutil
import sqlite3
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from sqlalchemy import Connection

from app.settings import Limits, Settings
from app.store import database
from tests.api.routes.clips.test_resumable_uploads import UPLOADS, begun, offset_of, sent
from tests.api.running import assert_problem, client_of, running
from tests.bags.bag_files import zip_of

CLIPS = "/api/v1/clips"
DISK_BYTES = 4 * 1024 * 1024


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """Mount a file system of a few megabytes."""
    place = tmp_path / "disk"
    place.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", f"size={DISK_BYTES}", "tmpfs", str(place)]
    if shutil.which("mount") is None or subprocess.run(mount, capture_output=True).returncode:
        pytest.skip("needs the right to mount a file system")
    try:
        yield place
    finally:
        subprocess.run(["umount", "--lazy", str(place)], check=True)


def fill(disk: Path, left: int) -> Path:
    """Fill the disk with a file so that this many bytes stay free."""
    ballast = disk / "ballast"
    with ballast.open("wb") as file:
        file.write(bytes(max(0, shutil.disk_usage(disk).free - left)))
        os.fsync(file.fileno())
    return ballast


@pytest.mark.slow
@pytest.mark.parametrize("left", [0, 8 * 1024, 64 * 1024])
@pytest.mark.withstands(row="H22")
def test_a_full_disk_costs_no_byte_of_an_upload(
    small_disk: Path, small_clip: Path, left: int
) -> None:
    settings = Settings(
        data_dir=small_disk / "data",
        samples_dir=small_disk / "none",
        limits=Limits(free_disk_bytes=0),
    )
    content = small_clip.read_bytes()
    with running(settings) as server, client_of(server.address) as client:
        place = begun(client, len(content))
        assert sent(client, place, 0, content[:-10]).status_code == 204
        ballast = fill(small_disk, left)
        refused = sent(client, place, len(content) - 10, content[-10:])
        assert refused.status_code in (204, 503, 507), refused.text
        if refused.status_code != 204:
            assert refused.headers["content-type"] == "application/problem+json"
            assert int(refused.headers.get("retry-after", "0")) >= 0
            came = offset_of(client, place)
            # All of it may be there before the row of its clip finds room.
            assert len(content) - 10 <= came <= len(content)
        # Reading still works.
        assert client.get("/healthz").status_code == 200
        assert client.get(CLIPS).status_code == 200
        begun_in_vain = client.post(
            UPLOADS, headers={"Tus-Resumable": "1.0.0", "Upload-Length": str(DISK_BYTES)}
        )
        assert_problem(begun_in_vain, 507, "disk_full")
        ballast.unlink()
        if refused.status_code != 204:
            refused = sent(client, place, came, content[came:])
        clip = refused.headers["content-location"]
        assert client.get(f"{clip}/video").content == content
        assert len(client.get(CLIPS).json()) == 1
    with sqlite3.connect(settings.data_dir / "studio.db") as opened:
        assert opened.execute("PRAGMA quick_check").fetchone() == ("ok",)


@pytest.mark.slow
@pytest.mark.withstands(row="H22")
def test_an_upload_stays_that_finds_no_room_while_it_is_looked_at(
    small_disk: Path, tmp_path: Path
) -> None:
    settings = Settings(data_dir=small_disk / "data", limits=Limits(free_disk_bytes=0))
    content = zip_of(tmp_path / "dive.zip", {"dive.mcap": bytes(4 * DISK_BYTES)}).read_bytes()
    with running(settings) as server, client_of(server.address) as client:
        place = begun(client, len(content), "dive.zip")
        assert_problem(sent(client, place, 0, content), 503, "storage_unavailable")
        assert offset_of(client, place) == len(content) - 1
        assert not list((settings.data_dir / "clips").iterdir())


@pytest.mark.slow
@pytest.mark.withstands(row="H22")
def test_a_full_database_costs_no_byte_of_an_upload(
    settings: Settings, small_clip: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    most_pages = 2**30
    begin = database._begin

    def begin_limited(connection: Connection) -> None:
        # SQLite never makes a limit smaller than the file is.
        connection.exec_driver_sql(f"PRAGMA max_page_count={most_pages}")
        begin(connection)

    monkeypatch.setattr(database, "_begin", begin_limited)
    content = small_clip.read_bytes()
    with running(settings) as server, client_of(server.address) as client:
        place = begun(client, len(content))
        most_pages = 1
        note = "x" * 60
        # The existing pages have room for some rows.
        for number in range(2000):
            made = client.post("/api/v1/languages", json={"name": f"{number} {note}"})
            if made.status_code != 201:
                break
        assert_problem(made, 503, "store_unavailable")
        refused = sent(client, place, 0, content)
        if refused.status_code != 204:
            assert_problem(refused, 503, "store_unavailable")
            assert offset_of(client, place) == len(content) - 1
        assert client.get("/api/v1/languages").status_code == 200
        most_pages = 2**30
        if refused.status_code != 204:
            refused = sent(client, place, len(content) - 1, content[-1:])
        assert refused.status_code == 204
        clip = refused.headers["content-location"]
        assert client.get(f"{clip}/video").content == content
        assert client.post("/api/v1/languages", json={"name": "again"}).status_code == 201
