"""A camera that is denied, allowed after all, taken away while it records, or busy."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, expect

from tests.api.running import Running
from tests.browser.camera import see_seconds
from tests.browser.conftest import OpenPage, started


@pytest.fixture(scope="module")
def browser(browser: Browser) -> Iterator[Browser]:
    """Start a second Chromium, with a camera that a page must be allowed."""
    camera = "--use-fake-device-for-media-stream"
    with started(browser.browser_type, camera, whole=True) as another:
        yield another


def test_a_camera_is_denied_then_allowed_and_lost_in_the_middle(
    open_page: OpenPage, server: Running
) -> None:
    page = open_page({"view": "live"}, scene=False)
    page.get_by_role("button", name="Start the camera").click()
    problem = page.locator("#view-live .camera-problem")
    expect(problem).to_contain_text("The camera was not allowed")
    expect(problem).to_contain_text("Allow it for this page")

    page.context.grant_permissions(["camera"])
    problem.get_by_role("button", name="Try again").click()
    expect(problem).to_be_hidden()
    expect(page.get_by_role("button", name="Stop", exact=True)).to_be_visible()
    page.keyboard.press("r")
    expect(page.get_by_role("button", name="Stop recording")).to_be_visible()
    see_seconds(page, 1.5)

    page.context.clear_permissions()
    expect(problem).to_contain_text("The camera was lost")
    expect(problem).to_contain_text("What was recorded until then is kept")
    expect(page.get_by_role("button", name="Start the camera")).to_be_visible()
    page.get_by_role("button", name="Show it").click()
    recorded = page.get_by_role("list", name="Clips", exact=True).get_by_role("listitem")
    expect(recorded.filter(has_text=re.compile(r"camera \d{4}-\d\d-\d\d"))).to_have_count(1)
    for each in server.studio.clips.all():
        server.studio.clips.delete(each.clip.id)


MIRRORED = "matrix(-1, 0, 0, 1, 0, 0)"

BUSY = """
const real = MediaDevices.prototype.getUserMedia;
MediaDevices.prototype.getUserMedia = function (wanted) {
  if (!window.cameraIsBusy) return real.call(this, wanted);
  return Promise.reject(new DOMException("Could not start video source", "NotReadableError"));
};
window.cameraIsBusy = true;
"""
"""Chromium's error while another program uses the camera. Any number of pages can use its fake
device, so this error is simulated; the page's handling of it is real."""


REAR = """() => {
  const settings = MediaStreamTrack.prototype.getSettings;
  MediaStreamTrack.prototype.getSettings = function () {
    return { ...settings.call(this), facingMode: "environment" };
  };
}"""
"""A phone's settings of its rear camera; Chromium's fake device does not report its direction."""


def test_a_camera_that_another_program_holds_is_tried_again_and_a_mirror_unless_a_rear_one(
    open_page: OpenPage,
) -> None:
    page = open_page({"view": "live"}, scene=False)
    page.context.grant_permissions(["camera"])
    page.evaluate(BUSY)
    page.get_by_role("button", name="Start the camera").click()
    problem = page.locator("#view-live .camera-problem")
    expect(problem).to_contain_text("The camera does not answer")
    expect(problem).to_contain_text("Another program or tab may be using it")
    expect(page.get_by_role("button", name="Start the camera")).to_be_visible()
    page.evaluate("window.cameraIsBusy = false")
    problem.get_by_role("button", name="Try again").click()
    expect(problem).to_be_hidden()
    stop = page.get_by_role("button", name=re.compile("^Stop"))
    video = page.locator(".camera-picture video:visible")
    expect(video).to_have_css("transform", MIRRORED)
    stop.click()

    page.get_by_role("link", name="Practice").click()
    page.get_by_label("Diver").fill("Ana")
    page.get_by_role("button", name="Start the camera").click()
    expect(video).to_have_css("transform", MIRRORED)
    stop.click()
    page.evaluate(REAR)
    for view in ("Practice", "Live"):
        page.get_by_role("link", name=view).click()
        page.get_by_role("button", name="Start the camera").click()
        expect(page.locator(".camera-picture .skeleton:visible")).to_be_attached()
        expect(video).to_have_css("transform", "none")
        stop.click()
