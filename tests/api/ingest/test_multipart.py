"""Receiving a file: misleading names, broken forms, senders that stall or disconnect."""

import socket
from pathlib import Path

import httpx
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.api.ingest.multipart import LONGEST_NAME, MOST_PARTS, display_name
from app.settings import Limits, Settings
from tests.api.routes.clips.test_clips import CLIPS, assert_nothing_kept
from tests.api.running import Running, assert_problem, running, until

FORM = {"Content-Type": "multipart/form-data; boundary=b"}
PART = b'--b\r\nContent-Disposition: form-data; name="%s"; filename="x.mp4"\r\n\r\n'


@pytest.mark.parametrize(
    ("given_name", "shown"),
    [
        ("dive.mp4", "dive.mp4"),
        ("../../etc/passwd", "passwd"),
        ("C:\\dives\\reef.mov", "reef.mov"),
        ("a\0b\r\nc.mp4", "abc.mp4"),
        ("\u202egpj.exe.mp4", "gpj.exe.mp4"),
        ("-rf", "-rf"),
        ("CON", "CON"),
        ("🤿 blue.mp4", "🤿 blue.mp4"),
        ("", "clip"),
        ("..", ".."),
        ("folder/", "clip"),
        ("x" * 4000 + ".webm", "x" * 194 + "….webm"),
    ],
)
def test_a_name_is_shown_without_what_could_do_harm(given_name: str, shown: str) -> None:
    assert display_name(given_name) == shown


@given(st.text(max_size=500))
@pytest.mark.withstands(row="H06")
def test_a_shown_name_is_short_visible_and_no_path(name: str) -> None:
    shown = display_name(name)
    assert 1 <= len(shown) <= LONGEST_NAME
    assert not set(shown) & set("/\\\0\r\n\u202e")
    assert display_name(shown) == shown


MALFORMED = {
    "no boundary": ({"Content-Type": "multipart/form-data"}, PART % b"file"),
    "long boundary": ({"Content-Type": "multipart/form-data; boundary=" + "x" * 5000}, b""),
    "no form": (FORM, b"no boundary in here at all"),
    "cut short": (FORM, PART % b"file" + b"cut short"),
    "no file": (FORM, PART % b"other" + b"data\r\n--b--\r\n"),
    "two files": (FORM, PART % b"file" + b"1\r\n" + PART % b"file" + b"2\r\n--b--\r\n"),
    "many parts": (FORM, (PART % b"note" + b"x\r\n") * (MOST_PARTS + 1) + b"--b--\r\n"),
    "long header": (FORM, b"--b\r\n" + b"X-Header: " + b"y" * 20_000 + b"\r\n\r\n"),
    "many headers": (FORM, b"--b\r\n" + b"X: y\r\n" * 10_000 + b"\r\n"),
}


@pytest.mark.withstands(row="H05")
def test_a_malformed_form_is_400(client: httpx.Client, settings: Settings) -> None:
    for headers, body in MALFORMED.values():
        answer = client.post(CLIPS, content=body, headers=headers)
        assert_problem(answer, 400, "malformed_upload")
        assert_nothing_kept(client, settings)


def test_a_body_that_is_no_form_is_415(client: httpx.Client, small_clip: Path) -> None:
    answer = client.post(
        CLIPS, content=small_clip.read_bytes(), headers={"Content-Type": "video/mp4"}
    )
    assert_problem(answer, 415, "unsupported_media_type")


@pytest.mark.slow
def test_small_fields_beside_the_file_are_ignored(client: httpx.Client, small_clip: Path) -> None:
    files = {"file": ("dive.mp4", small_clip.read_bytes())}
    answer = client.post(CLIPS, files=files, data={"note": "first dive"})
    assert answer.status_code == 202


def begin_upload(server: Running, length: int) -> socket.socket:
    """Send the head of an upload and the beginning of its body."""
    connection = socket.create_connection(("127.0.0.1", server.port))
    head = (
        f"POST {CLIPS} HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\n"
        f"Content-Type: {FORM['Content-Type']}\r\nContent-Length: {length}\r\n\r\n"
    )
    connection.sendall(head.encode() + PART % b"file" + b"beginning")
    return connection


def partials(settings: Settings) -> list[Path]:
    return list((settings.data_dir / "clips").glob("*.part"))


@pytest.mark.withstands(row="H04")
def test_a_sender_that_vanishes_leaves_nothing(
    client: httpx.Client, server: Running, settings: Settings
) -> None:
    with begin_upload(server, 100_000):
        until(lambda: partials(settings))
    until(lambda: not partials(settings))
    assert_nothing_kept(client, settings)


@pytest.mark.withstands(row="H03")
def test_a_sender_that_trickles_is_dismissed(settings: Settings) -> None:
    impatient = settings.model_copy(
        update={"limits": Limits(upload_grace_seconds=0.5, upload_bytes_per_second=1_000_000)}
    )
    with running(impatient) as server, begin_upload(server, 100_000) as connection:
        connection.settimeout(0.1)
        answer = b""

        def trickled() -> bool:
            nonlocal answer
            try:
                connection.sendall(b".")
                answer += connection.recv(10_000)
            except TimeoutError:
                return False
            except OSError:
                return True
            return b" 408 " in answer

        until(trickled)
        until(lambda: not partials(impatient))
