"""The studio at a path of a host that has other programs too, behind nginx."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from playwright.sync_api import Page, Response, expect

from app.settings import Settings
from tests.api.running import Running, client_of, running, until
from tests.api.test_reverse_proxies import answers, nginx
from tests.browser.conftest import OpenPage
from tests.browser.files import drop
from tests.ports import free_port
from tests.short_clips import shortened

PREFIX = "/studio"


@pytest.fixture
def server(tmp_path: Path, installed_models: None) -> Iterator[Running]:
    """Serve the studio at a path of nginx."""
    own = free_port()
    settings = Settings(data_dir=tmp_path / "data", forwarded_allow_ips="127.0.0.1")
    with running(settings) as server, nginx(tmp_path, server.port, own, PREFIX):
        until(lambda: answers(own))
        yield Running(f"http://127.0.0.1:{own}{PREFIX}", server.studio)


def watch(page: Page) -> list[str]:
    """Return a list that gets the addresses of `page` that lead out of the path, or nowhere."""
    lost: list[str] = []

    def look(address: str, status: int = 0) -> None:
        place = urlsplit(address)
        outside = place.scheme.startswith(("http", "ws")) and not place.path.startswith(PREFIX)
        if outside or status >= 400:
            lost.append(f"{status} {address}")

    def answered(answer: Response) -> None:
        look(answer.url, answer.status)

    page.on("response", answered)
    page.on("websocket", lambda opened: look(opened.url))
    return lost


def test_page_uploads_events_scene_pictures_and_invitations_work_at_a_path(
    open_page: OpenPage, server: Running, thin_clip: Callable[[str], Path], tmp_path: Path
) -> None:
    page = open_page()
    lost = watch(page)
    page.reload()
    drop(page, shortened(thin_clip("line-test-2"), tmp_path / "line.mp4", 1.0))
    row = page.get_by_role("list", name="Clips").get_by_role("listitem")
    expect(row.locator("img.poster")).to_have_js_property("complete", True)
    # By events: the page asks for nothing again by itself.
    expect(row).to_contain_text("frames", timeout=300_000)
    expect(page.frame_locator("#lab").locator("canvas[data-engine]")).to_be_visible()
    page.keyboard.press("End")
    expect(page.locator("#clock")).not_to_contain_text("frame 0 of")
    with client_of(server.address) as client:
        (sample, *_) = client.get("/api/v1/samples/languages").json()
        language = client.post("/api/v1/samples/languages", json={"name": sample["name"]}).json()
        made = client.post(f"/api/v1/languages/{language['id']}/invitations", json={}).json()
    assert made["link"].startswith(f"{server.address}/invitation#")
    gesture = page.locator("#gestures img").first
    expect(gesture).to_have_js_property("complete", True)
    assert gesture.evaluate("picture => picture.naturalWidth") > 0
    for view in ("Languages", "Phrases", "Health", "Live"):
        page.get_by_role("link", name=view, exact=True).click()
        expect(page.get_by_role("main").get_by_role("heading").first).to_be_visible()
    assert urlsplit(page.url).path == f"{PREFIX}/"
    page.get_by_role("link", name="OSG Studio").click()
    expect(row).to_be_visible()
    page.goto(made["link"])
    expect(page.get_by_role("heading").first).to_be_visible()
    assert lost == []
