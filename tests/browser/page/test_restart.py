"""The server is killed and started again under every view: the page says so, and loses nothing."""

from __future__ import annotations

import re
import struct
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

import pytest
from playwright.sync_api import BrowserContext, Page, Request, expect

from app.settings import Settings
from tests.api.running import client_of, running, until
from tests.api.serving import lasting_port, served
from tests.browser.conftest import OpenPage
from tests.browser.files import drop
from tests.browser.library import library_of
from tests.recognition.damaged_clips import write_clip

FRAME = 12


@dataclass
class Address:
    """The address of the server, independent of its process."""

    address: str = ""


@pytest.fixture
def server() -> Address:
    """Return the place that `open_page` opens."""
    return Address()


@pytest.fixture(scope="module", autouse=True)
def without_scene(shared_context: BrowserContext) -> None:
    """Give pages an empty frame in place of viser's: the server's own process draws all of it."""
    empty = "<div id=root><canvas></canvas></div>"
    shared_context.route(
        "**/viser/**", lambda route: route.fulfill(body=empty, content_type="text/html")
    )


@pytest.fixture
def query(tmp_path: Path) -> dict[str, str]:
    """Return the data of a link: a clip, a language of two gestures and a misread take."""
    settings = Settings(data_dir=tmp_path, samples_dir=tmp_path / "none")
    with running(settings) as server, client_of(server.address) as client:
        library = library_of(server, client, "kept")
        return {**library.address, "recognition": library.recognise("line")}


def opened(open_page: OpenPage, query: dict[str, str]) -> dict[str, Page]:
    """Open every view, with unsaved content."""
    pages = {
        "studio": open_page(query | {"frame": str(FRAME)}, scene=False),
        "languages": open_page(query | {"view": "languages"}, scene=False),
        "gesture": open_page(query | {"view": "gesture", "gesture": "circle"}, scene=False),
        "phrases": open_page(query | {"view": "phrases"}, scene=False),
        "live": open_page(query | {"view": "live"}, scene=False, alone=True),
        "health": open_page(query | {"view": "health"}, scene=False, alone=True),
    }
    for page in pages.values():
        expect(page.get_by_text("Connected", exact=True)).to_be_visible()
    expect(pages["studio"].locator("#clock")).to_have_text(re.compile(f"frame {FRAME} of"))
    expect(pages["languages"].get_by_role("heading", name="kept")).to_be_visible()
    pages["gesture"].get_by_label("Description").fill("half finished")
    expect(pages["live"].get_by_role("button", name="Start the camera")).to_be_visible()
    expect(pages["health"].get_by_role("heading", name="Health of kept")).to_be_visible()
    return pages


def look(page: Page, *, away: bool) -> None:
    """Simulate that a page is hidden for a minute or shown again: headless browsers hide none."""
    if away:
        page.evaluate("Object.defineProperty(document, 'hidden', {get: () => window.unseen})")
        page.clock.install()
    page.evaluate("(away) => { window.unseen = away; }", away)
    page.evaluate("document.dispatchEvent(new Event('visibilitychange'))")
    if away:
        page.clock.fast_forward(60_000)


def padded(path: Path, size: int) -> Path:
    """Write a clip with `size` extra bytes in a box that players skip."""
    write_clip(path, frames=2)
    path.write_bytes(path.read_bytes() + struct.pack(">I4s", size, b"free") + bytes(size - 8))
    return path


def is_upload(request: Request) -> bool:
    return request.method == "PATCH" and "/uploads/" in request.url


def test_an_upload_goes_on_where_a_killed_server_left_it(
    open_page: OpenPage, server: Address, tmp_path: Path
) -> None:
    clip = padded(tmp_path / "long dive.mp4", 3_000_000)
    data, port = tmp_path / "data", lasting_port()
    with served(data, port=port) as (process, client):
        server.address = str(client.base_url).rstrip("/")
        page = open_page(scene=False)
        expect(page.get_by_text("Connected", exact=True)).to_be_visible()
        network = page.context.new_cdp_session(page)
        slow = {"offline": False, "latency": 0, "downloadThroughput": -1}
        network.send("Network.emulateNetworkConditions", {**slow, "uploadThroughput": 200_000})
        drop(page, clip)
        uploads = page.get_by_role("list", name="Uploads")
        until(lambda: sum(path.stat().st_size for path in data.glob("uploads/*")) > 200_000)
        process.kill()
        lost = r"Connection lost at (?!0 B)\S+ \SB of .+ continues by itself"
        expect(uploads).to_contain_text(re.compile(lost))
    came = max(path.stat().st_size for path in data.glob("uploads/*"))
    network.send("Network.emulateNetworkConditions", {**slow, "uploadThroughput": -1})
    with ExitStack() as stack:
        # The page may continue before this process notices that the server is back.
        with page.expect_request(is_upload) as going_on:
            _, client = stack.enter_context(served(data, port=port))
        assert int(going_on.value.headers["upload-offset"]) == came
        expect(page.get_by_role("button", name="Show long dive.mp4")).to_be_visible()
        expect(uploads.get_by_role("listitem")).to_have_count(0)
        (kept,) = client.get("/api/v1/clips").json()
        assert client.get(f"/api/v1/clips/{kept['id']}/video").content == clip.read_bytes()


def test_every_view_survives_a_server_that_is_killed(
    open_page: OpenPage, server: Address, query: dict[str, str], tmp_path: Path
) -> None:
    port = lasting_port()
    with served(tmp_path, port=port) as (process, client):
        server.address = str(client.base_url).rstrip("/")
        pages = opened(open_page, query)
        background = open_page(query | {"frame": str(FRAME)}, scene=False)
        expect(background.locator("#clock")).to_have_text(re.compile(f"frame {FRAME} of"))
        look(background, away=True)
        process.kill()
        for page in pages.values():
            expect(page.locator("#away")).to_contain_text("No connection to the server")
            expect(page.get_by_role("status").get_by_text("Reconnecting")).to_be_visible()
    with ExitStack() as stack:
        with pages["studio"].expect_response(re.compile("/workspaces/.+/view")):
            _, client = stack.enter_context(served(tmp_path, port=port))
        for page in pages.values():
            expect(page.get_by_text("Connected", exact=True)).to_be_visible()
            expect(page.locator("#away")).to_be_hidden()
        client.post("/api/v1/languages", json={"name": "made meanwhile"})
        expect(pages["languages"].get_by_role("heading", name="made meanwhile")).to_be_visible()
        studio = pages["studio"]
        expect(studio.get_by_role("region", name="Why")).to_contain_text("'line'")
        expect(studio.locator("#clock")).to_have_text(re.compile(f"frame {FRAME} of"))
        studio.keyboard.press(".")
        expect(studio.locator("#clock")).to_have_text(re.compile(f"frame {FRAME + 1} of"))
        look(background, away=False)
        with background.expect_response(re.compile("/workspaces/.+/view")):
            background.clock.run_for(2000)
        expect(background.locator("#away")).to_be_hidden()
        background.keyboard.press(".")
        expect(background.locator("#clock")).to_have_text(re.compile(f"frame {FRAME + 1} of"))
        known = pages["health"].get_by_role("table", name="What is known of each gesture")
        expect(known).to_be_visible()
        pages["health"].close()
        editor = pages["gesture"]
        expect(editor.get_by_label("Description")).to_have_value("half finished")
        editor.get_by_role("button", name="Save", exact=True).click()
        expect(editor.get_by_text("Gesture saved")).to_be_visible()
        pages["live"].keyboard.press("Space")
        expect(pages["live"].get_by_text("No camera found")).to_be_visible()
