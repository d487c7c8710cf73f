"""Uploads that go on where a lost connection or a stopped server left them."""

from __future__ import annotations

import base64
import shutil
import socket
import sqlite3
import threading
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager
from pathlib import Path

import httpx
import pytest

from app.settings import Limits, Settings
from app.store import Role, TokenFile
from tests.api.ingest.test_bag_clips import two_divers
from tests.api.routes.clips.test_clips import CLIPS, assert_nothing_kept
from tests.api.running import Running, assert_problem, client_of, running, until
from tests.bags.bag_files import file_of, write_bag

pytestmark = pytest.mark.slow

UPLOADS = "/api/v1/uploads"
TUS = {"Tus-Resumable": "1.0.0"}
PART = TUS | {"Content-Type": "application/offset+octet-stream"}

FREE_BOX = (FREE_BYTES := 64 * 1024).to_bytes(4, "big") + b"free" + bytes(FREE_BYTES - 8)
"""Unused space at the end of an MP4, which makes it larger than a file's write buffer."""


def begun(client: httpx.Client, size: int, name: str = "dive.mp4", **fields: str) -> str:
    """Begin an upload, and return its path."""
    pairs = {"filename": name, "filetype": "video", **fields}
    metadata = ",".join(
        f"{key} {base64.b64encode(text.encode()).decode()}" for key, text in pairs.items()
    )
    headers = TUS | {"Upload-Length": str(size), "Upload-Metadata": metadata}
    answer = client.post(UPLOADS, headers=headers)
    assert answer.status_code == 201, answer.text
    return str(answer.headers["location"])


def sent(client: httpx.Client, place: str, offset: int, content: bytes) -> httpx.Response:
    return client.patch(place, headers=PART | {"Upload-Offset": str(offset)}, content=content)


def offset_of(client: httpx.Client, place: str) -> int:
    answer = client.head(place, headers=TUS)
    assert answer.status_code == 200
    assert answer.headers["tus-resumable"] == "1.0.0"
    return int(answer.headers["upload-offset"])


def test_an_upload_is_its_owners_alone(
    settings: Settings, small_clip: Path, tmp_path: Path
) -> None:
    tokens = TokenFile(settings.tokens)
    names = {"Ada": Role.EDIT, "Bob": Role.EDIT, "Cy": Role.READ, "Root": Role.ADMIN}
    content = small_clip.read_bytes()
    with ExitStack() as stack:
        server = stack.enter_context(running(settings))
        ada, bob, reader, root = (
            stack.enter_context(
                client_of(
                    server.address,
                    headers={"Authorization": f"Bearer {tokens.add(name, role)}"},
                )
            )
            for name, role in names.items()
        )
        place = begun(ada, len(content))
        half = len(content) // 2
        assert sent(ada, place, 0, content[:half]).status_code == 204

        def refuse_others() -> None:
            unknown = bob.delete(f"{UPLOADS}/{'0' * 32}", headers=TUS).json()["detail"]
            for stranger in (bob, reader):
                assert stranger.head(place, headers=TUS).status_code == 404
            assert_problem(sent(bob, place, half, content[half:]), 404, "not_found")
            refused = assert_problem(bob.delete(place, headers=TUS), 404, "not_found")
            assert str(refused["detail"]).split("'")[::2] == unknown.split("'")[::2]

        refuse_others()
        assert offset_of(ada, place) == offset_of(root, place) == half
        assert sent(ada, place, half, content[half:]).status_code == 204
        # The finished upload is not shown to others either.
        refuse_others()
        assert_problem(sent(bob, place, len(content), b""), 404, "not_found")
        assert sent(ada, place, len(content), b"").status_code == 204
        assert [each.clip.owner for each in server.studio.clips.all()] == ["Ada"]
        given_up = begun(ada, 10)
        assert root.delete(given_up, headers=TUS).status_code == 204
        # An administrator may complete it for her.
        assert sent(root, begun(ada, len(content)), 0, content).status_code == 204
        assert [each.clip.owner for each in server.studio.clips.all()] == ["Ada", "Ada"]


def broken_off(server: Running, place: str, content: bytes, length: int) -> None:
    """Send the beginning of a part of `length` bytes, and disconnect."""
    with socket.create_connection(("127.0.0.1", server.port)) as connection:
        head = (
            f"PATCH {place} HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\n"
            f"Tus-Resumable: 1.0.0\r\nUpload-Offset: 0\r\n"
            f"Content-Type: {PART['Content-Type']}\r\nContent-Length: {length}\r\n\r\n"
        )
        connection.sendall(head.encode() + content)
        with client_of(server.address) as client:
            until(lambda: offset_of(client, place) > 0)


@pytest.mark.parametrize("parts", [1, 3])
def test_the_last_part_makes_the_clip(client: httpx.Client, small_clip: Path, parts: int) -> None:
    content = small_clip.read_bytes()
    place = begun(client, len(content), "../größer.mp4")
    step = -(-len(content) // parts)
    for offset in range(0, len(content), step):
        assert offset_of(client, place) == offset
        answer = sent(client, place, offset, content[offset : offset + step])
        assert answer.status_code == 204
    clip = answer.headers["content-location"]
    assert client.get(clip).json()["name"] == "größer.mp4"
    assert client.get(f"{clip}/video").content == content
    # A client that lost the last answer asks again, and learns that the upload is complete.
    finished = client.head(place, headers=TUS)
    assert finished.headers["content-location"] == clip
    assert finished.headers["upload-offset"] == str(len(content))


def test_a_lost_connection_and_a_restart_lose_nothing_that_came(
    settings: Settings, small_clip: Path
) -> None:
    content = small_clip.read_bytes() + FREE_BOX
    with running(settings) as server, client_of(server.address) as client:
        place = begun(client, len(content))
        half = len(content) // 2
        broken_off(server, place, content[:half], len(content))
    with running(settings) as server, client_of(server.address) as client:
        came = offset_of(client, place)
        assert 0 < came <= half
        clip = sent(client, place, came, content[came:]).headers["content-location"]
        assert client.get(f"{clip}/video").content == content
        assert [each["name"] for each in client.get(CLIPS).json()] == ["dive.mp4"]


def test_a_locked_database_costs_no_byte_of_a_whole_upload(
    settings: Settings, small_clip: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.store.database.BUSY_TIMEOUT_SECONDS", 0.2)
    content = small_clip.read_bytes()
    with running(settings) as server, client_of(server.address) as client:
        place = begun(client, len(content))
        with closing(sqlite3.connect(settings.data_dir / "studio.db")) as other:
            other.execute("BEGIN IMMEDIATE")
            refused = sent(client, place, 0, content)
            assert_problem(refused, 503, "store_unavailable")
            # A client takes an upload of full length for a finished one.
            assert offset_of(client, place) == len(content) - 1
            other.rollback()
        (kept,) = (settings.data_dir / "uploads").glob("*[!n]")
        assert kept.read_bytes() == content
        finished = sent(client, place, len(content) - 1, content[-1:])
        clip = finished.headers["content-location"]
        assert client.get(f"{clip}/video").content == content
        # A client that lost this answer sends the part again, from either offset.
        for offset in (len(content) - 1, len(content)):
            again = sent(client, place, offset, content[offset:])
            assert again.headers["content-location"] == clip
        assert len(client.get(CLIPS).json()) == 1
        assert list((settings.data_dir / "uploads").iterdir()) == []


@contextmanager
def beginning(
    server: Running, client: httpx.Client, place: str, content: bytes
) -> Iterator[socket.socket]:
    """Send all but the last five bytes of a part with a whole file."""
    fields = PART | {
        "Host": f"127.0.0.1:{server.port}",
        "Upload-Offset": "0",
        "Content-Length": str(len(content)),
    }
    head = "".join(f"{name}: {value}\r\n" for name, value in fields.items())
    with socket.create_connection(("127.0.0.1", server.port)) as slow:
        slow.sendall(f"PATCH {place} HTTP/1.1\r\n{head}\r\n".encode() + content[:-5])
        until(lambda: offset_of(client, place) > 0)
        yield slow


def test_an_upload_that_is_given_up_while_its_last_part_comes_is_404(
    server: Running, client: httpx.Client, small_clip: Path
) -> None:
    content = small_clip.read_bytes() + FREE_BOX
    place = begun(client, len(content))
    with beginning(server, client, place, content) as slow:
        assert client.delete(place, headers=TUS).status_code == 204
        slow.sendall(content[-5:])
        assert b" 404 " in slow.recv(4096)
    assert client.get(CLIPS).json() == []


def test_a_second_request_writes_nothing_into_a_clip_that_was_inspected(
    server: Running, client: httpx.Client, small_clip: Path
) -> None:
    content = small_clip.read_bytes() + FREE_BOX
    shown = content[:-5] + b"other"  # Both are whole videos.
    place = begun(client, len(content))
    answers: list[httpx.Response] = []
    answered = threading.Event()

    def send_whole() -> None:
        with client_of(server.address) as own:
            answers.append(sent(own, place, 0, content))
        answered.set()

    with beginning(server, client, place, shown) as slow:
        other = threading.Thread(target=send_whole)
        other.start()
        assert not answered.wait(1)
        slow.sendall(shown[-5:])
        assert b" 204 " in slow.recv(4096)
        other.join()
    assert_problem(answers[0], 404, "not_found")
    (clip,) = client.get(CLIPS).json()
    assert client.get(f"{CLIPS}/{clip['id']}/video").content == shown


def test_announced_bytes_are_reserved(settings: Settings, small_clip: Path) -> None:
    free = shutil.disk_usage(settings.data_dir.parent).free
    # Half of what is free may be used, so that other programs do not disturb.
    tight = settings.model_copy(
        update={
            "max_clip_bytes": free,
            "limits": Limits(free_disk_bytes=free // 2, max_jobs_per_client=3),
        }
    )
    with running(tight) as server, client_of(server.address) as client:
        place = begun(client, free // 3)
        headers = TUS | {"Upload-Length": str(free // 3)}
        refused = assert_problem(client.post(UPLOADS, headers=headers), 507, "disk_full")
        assert "uploads under way" in str(refused["detail"])
        assert sent(client, place, 0, b"beginning").status_code == 204
        client.delete(place, headers=TUS)
        assert client.post(UPLOADS, headers=headers).status_code == 201


def test_an_upload_counts_as_a_waiting_job_from_its_beginning(settings: Settings) -> None:
    narrow = settings.model_copy(update={"limits": Limits(max_jobs_per_client=2)})
    with running(narrow) as server, client_of(server.address) as client:
        for _ in range(2):
            place = begun(client, 100)
        answer = client.post(UPLOADS, headers=TUS | {"Upload-Length": "100"})
        assert_problem(answer, 429, "queue_full")
        client.delete(place, headers=TUS)
        begun(client, 100)


def test_the_topic_of_a_dive_recording_comes_with_the_metadata(
    settings: Settings, tmp_path: Path
) -> None:
    bag = file_of(write_bag(tmp_path / "dive", two_divers()))
    content, half = bag.read_bytes(), bag.stat().st_size // 2
    topic = "/leader/pose_keypoints"
    with running(settings) as server, client_of(server.address) as client:
        place = begun(client, len(content), "dive.mcap", topic=topic)
        assert sent(client, place, 0, content[:half]).status_code == 204
    # It survives a restart, like the bytes.
    with running(settings) as server, client_of(server.address) as client:
        clip = sent(client, place, half, content[half:]).headers["content-location"]
        assert client.get(clip).json()["topic"] == topic
        other = begun(client, len(content), "dive.mcap", topic="/nobody")
        assert_problem(sent(client, other, 0, content), 422, "topic_unusable")
        names = {each["name"] for each in client.get(CLIPS).json()}
        assert names == {"dive.mcap"}


def test_metadata_beyond_ascii_is_refused(client: httpx.Client) -> None:
    headers = {name.encode(): text.encode() for name, text in TUS.items()}
    headers |= {b"Upload-Length": b"3", b"Upload-Metadata": b"filename \xe9"}
    assert_problem(client.post(UPLOADS, headers=headers), 400, "malformed_upload")


@pytest.mark.parametrize(
    ("pair", "status", "code"),
    [
        ("topic !!", 400, "malformed_upload"),
        (f"topic {base64.b64encode(b'x' * 300).decode()}", 400, "malformed_upload"),
        (f"frame_rate {base64.b64encode(b'fast').decode()}", 422, "field_invalid"),
    ],
)
def test_metadata_that_cannot_be_is_refused_before_the_bytes_come(
    client: httpx.Client, pair: str, status: int, code: str
) -> None:
    headers = TUS | {"Upload-Length": "3", "Upload-Metadata": pair}
    assert_problem(client.post(UPLOADS, headers=headers), status, code)


def test_what_is_no_video_is_refused_at_the_end_and_forgotten(
    client: httpx.Client, settings: Settings
) -> None:
    place = begun(client, 5)
    assert_problem(sent(client, place, 0, b"hello"), 415, "unsupported_media_type")
    assert client.head(place, headers=TUS).status_code == 404
    assert_nothing_kept(client, settings)


def test_an_upload_that_is_given_up_is_forgotten(client: httpx.Client, settings: Settings) -> None:
    place = begun(client, 100)
    sent(client, place, 0, b"beginning")
    assert client.delete(place, headers=TUS).status_code == 204
    assert list((settings.data_dir / "uploads").iterdir()) == []
    assert_problem(client.delete(place, headers=TUS), 404, "not_found")


def test_a_part_for_another_place_is_refused(client: httpx.Client) -> None:
    place = begun(client, 100)
    problem = assert_problem(sent(client, place, 7, b"x"), 409, "upload_offset")
    assert "0 bytes have come" in str(problem["detail"])


def test_more_than_was_said_is_refused(client: httpx.Client) -> None:
    place = begun(client, 3)
    assert_problem(sent(client, place, 0, b"four"), 413, "too_large")


def test_a_file_that_is_too_large_is_refused_before_it_comes(
    client: httpx.Client, settings: Settings
) -> None:
    headers = TUS | {"Upload-Length": str(settings.max_clip_bytes + 1)}
    assert_problem(client.post(UPLOADS, headers=headers), 413, "too_large")


def test_another_version_or_type_is_refused_and_ours_is_told(client: httpx.Client) -> None:
    place = begun(client, 3)
    assert_problem(client.post(UPLOADS, headers={"Upload-Length": "3"}), 412, "tus_version")
    assert_problem(
        client.patch(place, headers=TUS | {"Upload-Offset": "0"}), 415, "unsupported_media_type"
    )
    headers = client.options(UPLOADS).headers
    assert headers["tus-version"] == "1.0.0"
    assert headers["tus-extension"] == "creation,termination"


@pytest.mark.parametrize("name", ["none", "..%2Fstudio.db", "0" * 32])
def test_an_upload_that_is_not_there_is_404(client: httpx.Client, name: str) -> None:
    assert client.head(f"{UPLOADS}/{name}", headers=TUS).status_code == 404
