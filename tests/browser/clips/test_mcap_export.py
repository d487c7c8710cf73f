"""A clip's export as MCAP: the page shows its progress, cancels it, and reports errors."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import expect

from app.settings import Settings
from tests.api.running import Running, client_of
from tests.api.running_workers import hold_worker, linux
from tests.bags.exports import checked
from tests.browser.accessibility import faults
from tests.browser.conftest import OpenPage
from tests.browser.library import Library, add_clip, library_of

SESSION = "**/session.mcap"


@pytest.fixture
def library(server: Running) -> Iterator[Library]:
    with client_of(server.address) as client:
        yield library_of(server, client, "exported")


def test_the_page_says_why_a_session_fails_and_how_far_it_is_and_then_downloads_it(
    open_page: OpenPage, server: Running, library: Library, tmp_path: Path
) -> None:
    query = library.address | {"recognition": library.recognise("circle")}
    page = open_page(query, scene=False)
    page.route(SESSION, lambda route: route.abort())
    page.get_by_role("button", name="Session as MCAP").click()
    problem = page.get_by_role("alert").filter(has_text="could not be downloaded")
    expect(problem).to_contain_text("The server did not answer")
    expect(problem).to_contain_text("try it again")
    assert faults(page) == []
    page.unroute(SESSION)
    with page.expect_download():
        page.get_by_role("button", name="Try the session again").click()
    # Any text during the writing will do, since that may be short.
    page.evaluate(
        "window.said = []; new MutationObserver(() => { const now = document.querySelector("
        "'.mcap-export [role=status]'); if (now) window.said.push(now.textContent); })"
        ".observe(document.body, {subtree: true, childList: true, characterData: true})"
    )
    with page.expect_download() as download:
        page.get_by_role("button", name="Session as MCAP").click()
    # The browser saves it while it downloads: the page itself never holds the file, maybe
    # gigabytes.
    assert f"/clips/{library.clip}/session.mcap?export=" in download.value.url
    assert download.value.url.startswith(server.address)
    assert download.value.suggested_filename == "exported.mcap"
    download.value.save_as(tmp_path / "exported.mcap")
    assert len(checked(tmp_path / "exported.mcap")["/takes"]) == 1
    expect(page.get_by_role("button", name="Session as MCAP")).to_be_focused()
    said = page.evaluate("window.said")
    assert said[0] == "Preparing the session"
    assert any(re.match(r"Writing the MCAP file, \d+ %", words) for words in said), said


@linux
def test_a_session_can_be_cancelled(
    open_page: OpenPage, server: Running, library: Library, settings: Settings
) -> None:
    long = add_clip(server, *["circle", "line"] * 40, name="long.mp4")
    query = {"clip_id": long, "language_id": library.language, "start": 0, "end": 3}
    answer = library.client.post("/api/v1/recognitions", json=query)
    address = {"clip": long, "language": library.language, "recognition": answer.json()["id"]}
    page = open_page(address, scene=False)
    page.get_by_role("button", name="Session as MCAP").click()
    page.get_by_text("Writing the MCAP file").wait_for()
    # The export takes as long as this test needs.
    hold_worker(os.getpid(), "session")
    assert faults(page) == []
    page.get_by_role("button", name="Cancel the session").click()
    expect(page.get_by_text("The session is cancelled")).to_be_visible()
    expect(page.get_by_role("button", name="Session as MCAP")).to_be_visible()
    # The server stopped writing and left nothing.
    expect(page.get_by_text("The session is cancelled")).to_have_count(0)
    left = {each.name for each in (settings.data_dir / "clips").iterdir()}
    assert left == {clip["id"] for clip in library.client.get("/api/v1/clips").json()}
