"""Reverse proxies: the documented nginx and Caddy work, and only a trusted proxy counts."""

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
from starlette.datastructures import Headers
from websockets.sync.client import connect

from app.api.http.page_files import prefix_of
from app.api.ingest.multipart import FRAME_BYTES
from app.settings import Settings
from tests.api.running import client_of, until
from tests.conftest import ROOT
from tests.ports import free_port

pytestmark = pytest.mark.slow

ASSETS = ROOT / "docs" / "assets"
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


@contextmanager
def nginx(folder: Path, studio: int, own: int, prefix: str = "") -> Iterator[None]:
    """Run nginx with the documented configuration, without its certificate, below a `prefix`."""
    # Debian installs it outside the path of ordinary users.
    program = shutil.which("nginx", path=os.environ.get("PATH", "") + ":/usr/sbin")
    if program is None:
        pytest.skip("needs nginx")
    server = (ASSETS / "nginx.conf").read_text()
    server = server.replace("listen 443 ssl;", f"listen 127.0.0.1:{own};")
    server = re.sub(r"ssl_certificate\w* .*\n", "", server)
    if prefix:
        # As its comment says.
        server = server.replace("location / {", f"location {prefix}/ {{")
        server = server.replace("127.0.0.1:8000;", "127.0.0.1:8000/;")
        line = "proxy_set_header X-Forwarded-Prefix"
        assert f"# {line} /studio;" in server
        server = server.replace(f"# {line} /studio;", f"{line} {prefix};")
    server = server.replace("127.0.0.1:8000", f"127.0.0.1:{studio}")
    file = folder / "nginx.conf"
    folders = "".join(
        f"{kind}_temp_path {folder}/{kind};\n"
        for kind in ("client_body", "proxy", "fastcgi", "uwsgi", "scgi")
    )
    file.write_text(
        f"pid {folder}/pid; daemon off; error_log {folder}/error;\n"
        f"events {{}}\nhttp {{ access_log off;\n{folders}{server}}}\n"
    )
    with running(program, "-c", str(file), "-e", str(folder / "error")):
        yield


@contextmanager
def caddy(folder: Path, studio: int, own: int) -> Iterator[None]:
    """Run Caddy with the documented configuration, without its certificate."""
    site = (ASSETS / "Caddyfile").read_text()
    site = site.replace("studio.example {", f"http://127.0.0.1:{own} {{\n\tbind 127.0.0.1")
    site = site.replace("127.0.0.1:8000", f"127.0.0.1:{studio}")
    file = folder / "Caddyfile"
    file.write_text(f"{{\n\tadmin off\n}}\n{site}")
    arguments = ("run", "--adapter", "caddyfile", "--config", str(file))
    with running(caddy_program(), *arguments, HOME=str(folder), XDG_CONFIG_HOME=str(folder)):
        yield


def caddy_program() -> str:
    program = shutil.which("caddy")
    if program is None:
        pytest.skip("needs Caddy: apt-get install caddy")
    return program


@contextmanager
def running(program: str, *arguments: str, **environment: str) -> Iterator[None]:
    """Run a program until the context ends."""
    with subprocess.Popen([program, *arguments], env=os.environ | environment) as process:
        try:
            yield
        finally:
            process.terminate()


@pytest.fixture(params=[nginx, caddy], ids=["nginx", "caddy"])
def proxied(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[str]:
    """Return the address of a documented proxy with the studio behind it."""
    with serving(tmp_path / "data", OSG_FORWARDED_ALLOW_IPS="127.0.0.1") as studio:
        own = free_port()
        with request.param(tmp_path, studio, own):
            until(lambda: answers(own))
            yield f"http://127.0.0.1:{own}"


def answers(port: int) -> bool:
    with socket.socket() as tried:
        return tried.connect_ex(("127.0.0.1", port)) == 0


def test_the_studio_and_its_websockets_work_behind_a_documented_proxy(
    proxied: str, small_clip: Path
) -> None:
    address = proxied
    content = small_clip.read_bytes()
    # A request from one address that claims another one.
    transport = httpx.HTTPTransport(local_address="127.0.0.2")
    headers = SIGNED_IN | {"X-Forwarded-For": "6.6.6.6"}
    with httpx.Client(base_url=address, headers=headers, timeout=60, transport=transport) as client:
        assert "OSG Studio" in client.get("/").text
        made = client.post(f"{API}/languages", json={"name": "pool"}, headers={"Origin": address})
        assert made.status_code == 201
        assert re.fullmatch("[0-9a-f]{32}", made.headers["x-request-id"].replace("-", ""))
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
    place = address.replace("http://", "ws://") + f"{API}/live"
    with connect(place, origin=address, additional_headers=SIGNED_IN) as opened:  # type: ignore[arg-type]
        assert opened.ping().wait(60)


def test_the_documented_caddyfile_lets_the_largest_clip_pass(tmp_path: Path) -> None:
    arguments = ["adapt", "--validate", "--adapter", "caddyfile", "--config"]
    adapted = subprocess.run(
        [caddy_program(), *arguments, str(ASSETS / "Caddyfile")],
        env=os.environ | {"HOME": str(tmp_path), "XDG_DATA_HOME": str(tmp_path)},
        capture_output=True,
        text=True,
        check=True,
    )
    (most,) = re.findall(r'"max_size":(\d+)', adapted.stdout)
    assert int(most) >= Settings().max_clip_bytes + FRAME_BYTES


def test_only_a_trusted_proxy_is_believed(tmp_path: Path) -> None:
    claims = SIGNED_IN | {"X-Forwarded-For": "6.6.6.6", "X-Forwarded-Proto": "https"}
    for trusted, address in (
        ("", "127.0.0.1"),
        ("10.0.0.1", "127.0.0.1"),
        ("127.0.0.1", "6.6.6.6"),
    ):
        with (
            serving(tmp_path / (trusted or "none"), OSG_FORWARDED_ALLOW_IPS=trusted) as port,
            client_of(f"http://127.0.0.1:{port}") as client,
        ):
            client.post(f"{API}/languages", json={"name": "pool"}, headers=claims)
            (noted,) = client.get(f"{API}/audit", headers=SIGNED_IN).json()
            assert noted["address"] == address
            claims_alone = {"X-Forwarded-Proto": "https", "X-Forwarded-For": "6.6.6.6"}
            cookie = client.get("/", params={"token": TOKEN}, headers=claims_alone)
            assert ("Secure" in cookie.headers["set-cookie"]) is (address == "6.6.6.6")


def test_below_a_path_addresses_are_those_of_the_proxy_and_two_studios_keep_their_cookies(
    tmp_path: Path,
) -> None:
    own = free_port()
    with (
        serving(tmp_path / "data", OSG_FORWARDED_ALLOW_IPS="127.0.0.1") as studio,
        nginx(tmp_path, studio, own, "/studio"),
    ):
        until(lambda: answers(own))
        with client_of(f"http://127.0.0.1:{own}") as client:
            page = client.get("/studio/", params={"token": TOKEN, "view": "live"})
            assert page.headers["location"] == "./?view=live"
            assert "Path=/studio/" in page.headers["set-cookie"]
            assert client.get(f"/studio{API}/languages").status_code == 200
            assert client.get(f"{API}/languages").status_code == 404
            headers = {"Tus-Resumable": "1.0.0", "Upload-Length": "5"}
            begun = client.post(f"/studio{API}/uploads", headers=headers)
            place = begun.headers["location"]
            assert place.startswith(f"/studio{API}/uploads/")
            assert client.head(place, headers=headers).headers["upload-offset"] == "0"
            assert client.delete(f"/studio{API}/session").status_code == 204
            assert client.get(f"/studio{API}/languages").status_code == 401


@pytest.mark.parametrize(
    "claimed",
    [
        *("//evil.example", "/a b", "/a?b", "studio", "/" + "a" * 900),
        *("/a/../b", "/.", "/..", "/./a"),
    ],
)
def test_what_is_no_path_is_no_prefix(claimed: str) -> None:
    behind = Settings(forwarded_allow_ips="127.0.0.1")
    assert prefix_of(Headers({"X-Forwarded-Prefix": "/studio/"}), behind) == "/studio"
    assert prefix_of(Headers({"X-Forwarded-Prefix": "/studio"}), Settings()) == ""
    assert prefix_of(Headers({"X-Forwarded-Prefix": claimed}), behind) == ""
