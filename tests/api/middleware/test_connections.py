"""Connections without a request are closed, and nobody can occupy all of them."""

from __future__ import annotations

import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest

from app.settings import Limits, Settings
from tests.api.running import Running, client_of, running, until

HEAD = "POST {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nContent-Length: 1000\r\n"


@pytest.fixture(scope="module")
def impatient(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Running]:
    """Return one server for all tests of this module, which waits for half a second."""
    folder = tmp_path_factory.mktemp("impatient")
    quick = Limits(idle_seconds=0.5, upload_grace_seconds=0.5)
    with running(Settings(data_dir=folder, samples_dir=folder / "none", limits=quick)) as server:
        yield server


@contextmanager
def connected(server: Running, said: str) -> Iterator[socket.socket]:
    with socket.create_connection(("127.0.0.1", server.port)) as connection:
        connection.settimeout(30)
        connection.sendall(said.encode())
        yield connection


def ended(connection: socket.socket) -> bytes:
    """Wait until the server closes a connection, and return the data received before."""
    said = b""
    try:
        while piece := connection.recv(10_000):
            said += piece
    except ConnectionResetError:
        pass
    return said


@pytest.mark.parametrize(
    "said",
    [
        "",
        "GET / HT",
        "GET / HTTP/1.1\r\nHost: 127.0.0.1",
        "POST /api/v1/clips HTTP/1.1\r\nX: y\r\n",
    ],
)
def test_a_connection_without_a_request_is_closed(impatient: Running, said: str) -> None:
    with connected(impatient, said) as connection:
        assert ended(connection) == b""


def test_a_head_that_trickles_is_closed(impatient: Running) -> None:
    with connected(impatient, "GET / HTTP/1.1\r\nX: ") as connection:
        connection.settimeout(0.05)

        def closed() -> bool:
            try:
                connection.sendall(b".")
                return connection.recv(100) == b""
            except TimeoutError:
                return False
            except OSError:
                return True

        until(closed)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("path", "more"),
    [
        ("/api/v1/languages", "Content-Type: application/json\r\n"),
        ("/api/v1/languages/import", "Content-Type: application/json\r\n"),
        ("/api/v1/recognitions", "Content-Type: application/json\r\n"),
        ("/api/v1/clips", "Content-Type: multipart/form-data; boundary=x\r\n"),
        (
            "/api/v1/clips",
            "Content-Type: multipart/form-data; boundary=x\r\nIdempotency-Key: a\r\n",
        ),
    ],
)
@pytest.mark.withstands(row="H03")
def test_a_body_that_stalls_is_ended_wherever_it_goes(
    impatient: Running, small_clip: Path, path: str, more: str
) -> None:
    if "Idempotency" in more:
        with client_of(impatient.address) as client:
            files = {"file": ("dive.mkv", small_clip.read_bytes())}
            answer = client.post(path, files=files, headers={"Idempotency-Key": "a"})
            assert answer.status_code == 202
    head = HEAD.format(path=path, port=impatient.port) + more + "\r\n"
    with connected(impatient, head + ("--x" if "boundary" in more else '{"name":')) as connection:
        assert ended(connection).startswith(b"HTTP/1.1 408 ")
    until(lambda: not list(impatient.studio.clips.folder.glob("*.part")))


def test_a_request_that_takes_long_and_a_stream_are_not_idle(impatient: Running) -> None:
    with (
        client_of(impatient.address) as client,
        client.stream("GET", "/api/v1/events") as stream,
    ):
        lines = stream.iter_lines()
        next(lines)
        with ExitStack() as idle:
            waiting = [idle.enter_context(connected(impatient, "")) for _ in range(3)]
            for connection in waiting:
                ended(connection)
        client.post("/api/v1/languages", json={"name": "pool"})
        assert any("languages" in line for line in lines)


def test_at_the_limit_idle_connections_give_way(settings: Settings) -> None:
    narrow = settings.model_copy(update={"limits": Limits(max_connections=40)})
    with running(narrow) as server, ExitStack() as idle:
        for _ in range(60):
            idle.enter_context(connected(server, ""))
        with client_of(server.address, timeout=10) as client:
            assert client.get("/healthz").status_code == 200


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="needs a limit of open files")
@pytest.mark.withstands(row="H03")
def test_few_files_are_enough_for_many_idle_connections(tmp_path: Path) -> None:
    code = (
        "import resource, sys; resource.setrlimit(resource.RLIMIT_NOFILE, (256, 256))\n"
        "from pathlib import Path\n"
        "from app.server import run\n"
        "from app.settings import Limits, Settings\n"
        "folder = Path(sys.argv[1])\n"
        "settings = Settings(data_dir=folder, samples_dir=folder / 'none', port=0)\n"
        "run(settings, open_browser=False)\n"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", code, str(tmp_path)], stdout=subprocess.PIPE, text=True
    )
    try:
        assert process.stdout is not None
        line = process.stdout.readline()
        address = next(word for word in line.split() if word.startswith("http://"))
        port = int(address.rstrip("/").rsplit(":", 1)[1])
        with ExitStack() as idle, client_of(address, timeout=10) as client:
            for _ in range(300):
                idle.enter_context(socket.create_connection(("127.0.0.1", port)))
            assert client.get("/healthz").status_code == 200
            assert client.get("/api/v1/clips").status_code == 200
    finally:
        process.kill()
        process.wait()
