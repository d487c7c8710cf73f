"""Behind a proxy: the documented nginx works, and only a trusted proxy is believed."""

from __future__ import annotations

import os
import re
import shutil
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx
import pytest
from websockets.sync.client import connect

from tests.api.running import until
from tests.conftest import ROOT

pytestmark = pytest.mark.slow

API = "/api/v1"
TOKEN = "correct-horse-battery"
SIGNED_IN = {"Authorization": f"Bearer {TOKEN}"}


@contextmanager
def serving(folder: Path, **settings: str) -> Iterator[int]:
    """Run the real command; yield its port."""
    given = {"OSG_DATA_DIR": str(folder), "OSG_SAMPLES_DIR": str(folder / "none")}
    with subprocess.Popen(
        [sys.executable, "-m", "app", "serve", "--port", "0", "--no-browser"],
        env=os.environ | given | {"OSG_TOKEN": TOKEN} | settings,
        stdout=subprocess.PIPE,
        text=True,
    ) as process:
        try:
            assert process.stdout is not None
            match = re.search(r":(\d+)/", process.stdout.readline())
            assert match is not None
            yield int(match[1])
        finally:
            process.terminate()


def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as listening:
        return int(listening.getsockname()[1])


@pytest.fixture
def proxied(tmp_path: Path) -> Iterator[tuple[str, str]]:
    """Return the addresses of nginx and of the studio behind it."""
    # Debian keeps it where only root looks.
    nginx = shutil.which("nginx", path=os.environ.get("PATH", "") + ":/usr/sbin")
    if nginx is None:
        pytest.skip("needs nginx")
    with serving(tmp_path / "data", OSG_FORWARDED_ALLOW_IPS="127.0.0.1") as port:
        own = free_port()
        server = (ROOT / "docs" / "assets" / "nginx.conf").read_text()
        server = server.replace("listen 443 ssl;", f"listen 127.0.0.1:{own};")
        server = re.sub(r"ssl_certificate\w* .*\n", "", server)
        server = server.replace("127.0.0.1:8000", f"127.0.0.1:{port}")
        file = tmp_path / "nginx.conf"
        folders = "".join(
            f"{kind}_temp_path {tmp_path}/{kind};\n"
            for kind in ("client_body", "proxy", "fastcgi", "uwsgi", "scgi")
        )
        file.write_text(
            f"pid {tmp_path}/pid; daemon off; error_log {tmp_path}/error;\n"
            f"events {{}}\nhttp {{ access_log off;\n{folders}{server}}}\n"
        )
        with subprocess.Popen([nginx, "-c", str(file), "-e", str(tmp_path / "error")]) as process:
            try:
                until(lambda: answers(own))
                yield f"http://127.0.0.1:{own}", f"http://127.0.0.1:{port}"
            finally:
                process.terminate()


def answers(port: int) -> bool:
    with socket.socket() as tried:
        return tried.connect_ex(("127.0.0.1", port)) == 0


def test_the_studio_works_behind_the_documented_nginx(
    proxied: tuple[str, str], small_clip: Path
) -> None:
    address, _ = proxied
    content = small_clip.read_bytes()
    # From an address of its own, and claiming another one.
    transport = httpx.HTTPTransport(local_address="127.0.0.2")
    headers = SIGNED_IN | {"X-Forwarded-For": "6.6.6.6"}
    with httpx.Client(base_url=address, headers=headers, timeout=60, transport=transport) as client:
        assert "OSG Studio" in client.get("/").text
        made = client.post(f"{API}/languages", json={"name": "pool"}, headers={"Origin": address})
        assert made.status_code == 201
        assert len(made.headers["x-request-id"]) == 32
        noted = client.get(f"{API}/audit").json()[0]
        assert noted["address"] == "127.0.0.2"
        assert noted["request_id"] == made.headers["x-request-id"]
        clip = client.post(f"{API}/clips", files={"file": ("a.mp4", content)}).json()["id"]
        part = client.get(f"{API}/clips/{clip}/video", headers={"Range": "bytes=10-19"})
        assert (part.status_code, part.content) == (206, content[10:20])
        with client.stream("GET", f"{API}/events") as stream:
            lines = stream.iter_lines()
            client.post(f"{API}/languages", json={"name": "reef"})
            assert any(line.startswith("event: languages") for line in lines)
        elsewhere = client.post(
            f"{API}/languages", json={"name": "x"}, headers={"Origin": "http://evil.example"}
        )
        assert elsewhere.status_code == 403


def test_websockets_pass_the_documented_nginx(proxied: tuple[str, str]) -> None:
    address, _ = proxied
    place = address.replace("http://", "ws://") + f"{API}/live"
    with connect(place, origin=address, additional_headers=SIGNED_IN) as opened:  # type: ignore[arg-type]
        assert opened.ping().wait(60)


def test_only_a_trusted_proxy_is_believed(tmp_path: Path) -> None:
    claims = SIGNED_IN | {"X-Forwarded-For": "6.6.6.6", "X-Forwarded-Proto": "https"}
    for trusted, address in (
        ("", "127.0.0.1"),
        ("10.0.0.1", "127.0.0.1"),
        ("127.0.0.1", "6.6.6.6"),
    ):
        with (
            serving(tmp_path / (trusted or "none"), OSG_FORWARDED_ALLOW_IPS=trusted) as port,
            httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=60) as client,
        ):
            client.post(f"{API}/languages", json={"name": "pool"}, headers=claims)
            (noted,) = client.get(f"{API}/audit", headers=SIGNED_IN).json()
            assert noted["address"] == address
            claims_alone = {"X-Forwarded-Proto": "https", "X-Forwarded-For": "6.6.6.6"}
            cookie = client.get("/", params={"token": TOKEN}, headers=claims_alone)
            assert ("Secure" in cookie.headers["set-cookie"]) is (address == "6.6.6.6")
