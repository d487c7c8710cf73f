"""The live view: a real camera stream in the browser, fed with one of our clips."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path

import httpx
import pytest
from playwright.sync_api import Browser, Page, expect

from app.settings import Settings
from tests.api.running import Running
from tests.browser.camera import camera_showing, see_seconds, write_feed
from tests.browser.conftest import OpenPage, started
from tests.browser.library import add_clip

FEED_RATE = 2
"""Frames a second of the fake camera: every second frame of a clip of 25 Hz, so that the diver
moves at a sixth of the speed and a busy machine sees enough of the salutes."""

COUNTED = """() => {
  const count = document.querySelector("#view-live .camera-count");
  window.counted = [];
  new MutationObserver(() => counted.push(count.textContent)).observe(count, { childList: true });
}"""
"""Records the texts of the countdown, since polling could miss a second."""

FOREIGN = "studio.test"
"""A host name that is not a secure origin, like another machine's."""

WHOLE_CLIP_MS = 300_000
"""Longest wait for a take: the camera's clip lasts 40 s, and a very busy machine may miss a salute
or take long to process every frame of one."""


@pytest.fixture(scope="module")
def settings(tmp_path_factory: pytest.TempPathFactory) -> Settings:
    """Return settings of a server that also answers to the host name `FOREIGN`."""
    return Settings(data_dir=tmp_path_factory.mktemp("studio"), allowed_hosts=(FOREIGN,))


@pytest.fixture(scope="module")
def feed(clips: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the camera's feed: a diver who salutes, draws a line and salutes again."""
    path = tmp_path_factory.mktemp("camera") / "line.y4m"
    return write_feed(clips / "line-test-2.mp4", path, FEED_RATE)


@pytest.fixture(scope="module")
def browser(browser: Browser, feed: Path) -> Iterator[Browser]:
    """Start a second Chromium, with a camera that shows the feed in a loop."""
    name = f"--host-resolver-rules=MAP {FOREIGN} 127.0.0.1"
    with started(browser.browser_type, *camera_showing(feed), name) as another:
        yield another


@pytest.fixture(scope="module")
def language(server: Running) -> str:
    """Return the id of the sample language that has the line."""
    listed = httpx.get(f"{server.address}/api/v1/languages", timeout=60).json()
    return str(next(each["id"] for each in listed if "Table 2" in each["name"]))


def test_the_camera_shows_landmarks_and_what_the_salute_does(
    open_page: OpenPage, language: str, picture: Callable[[Page, str], Path]
) -> None:
    page = open_page({"language": language, "view": "live"}, scene=False)
    expect(page.get_by_role("heading", name="Live recognition")).to_be_visible()
    expect(page.get_by_role("button", name="Start the camera")).to_be_visible()
    page.keyboard.press("Space")
    expect(page.get_by_text("any of 8 gestures of \u201cTable 2")).to_be_visible()
    expect(page.locator("#view-live .bones")).to_have_attribute("d", re.compile("^M.+L"))
    expect(page.get_by_text("Frames a second")).to_be_visible()
    expect(page.get_by_text("Latency")).to_be_visible()
    showing = page.locator(".live-state").filter(has_text="Show the gesture, then salute again.")
    showing = showing.filter(has=page.locator("#live-step-gesture[aria-current=step]"))
    expect(showing).to_be_visible(timeout=WHOLE_CLIP_MS)
    picture(page, "live-camera")
    page.keyboard.press("Space")
    expect(page.get_by_role("button", name="Start the camera")).to_be_visible()
    expect(page.get_by_text("Frames a second")).to_have_count(0)


def test_a_clip_played_as_if_live_is_recognised_and_leads_to_the_studio(
    open_page: OpenPage,
    server: Running,
    clips: Path,
    language: str,
    picture: Callable[[Page, str], Path],
) -> None:
    clip = add_clip(server, "line", name="line.mp4", video=clips / "line-test-2.mp4")
    page = open_page({"language": language, "view": "live", "clip": clip}, scene=False)
    page.get_by_role("button", name="Clip", exact=True).click()
    expect(page).to_have_url(re.compile("source=clip"))
    page.get_by_label("Every frame").check()
    page.get_by_role("button", name="Play as if live").click()
    recognised = page.get_by_role("list", name="Recognised, newest first").get_by_role("listitem")
    expect(recognised).to_contain_text("line", timeout=WHOLE_CLIP_MS)
    picture(page, "live")
    recognised.get_by_role("button", name="Open line").click()
    expect(page).to_have_url(re.compile(r"start=[12].*&end=[34]"))
    expect(page.get_by_role("heading", name="line.mp4")).to_be_visible()


def test_a_clip_is_recorded_from_the_camera_after_a_countdown(
    open_page: OpenPage, server: Running
) -> None:
    page = open_page(scene=False)
    page.get_by_role("button", name="Record with the camera").click()
    expect(page.get_by_role("button", name="Record a clip")).to_be_visible()
    page.evaluate(COUNTED)
    page.keyboard.press("r")
    expect(page.get_by_role("button", name="Stop recording")).to_be_visible()
    assert page.evaluate("window.counted") == ["3", "2", "1", ""]
    expect(page.locator("#view-live .camera-count")).to_be_hidden()
    see_seconds(page, 1.5)
    page.get_by_role("button", name="Stop recording").click()
    page.get_by_role("button", name="Show it").click()
    recorded = page.get_by_role("list", name="Clips", exact=True).get_by_role("listitem")
    recorded = recorded.filter(has_text=re.compile(r"camera \d{4}-\d\d-\d\d"))
    expect(recorded).to_have_count(1)
    clip = next(each for each in server.studio.clips.all() if each.clip.name.startswith("camera"))
    assert (clip.clip.width, clip.clip.height) == (640, 480)
    server.studio.clips.delete(clip.clip.id)


def test_why_another_machine_gives_no_camera_is_explained(
    open_page: OpenPage, server: Running, picture: Callable[[Page, str], Path]
) -> None:
    page = open_page({"view": "live"}, scene=False)
    page.goto(f"http://{FOREIGN}:{server.port}/?view=live")
    page.get_by_role("button", name="Start the camera").click()
    expect(page.get_by_role("alert")).to_contain_text("only to pages over HTTPS")
    picture(page, "live-insecure")
