"""Practice before the camera: gestures are judged and counted, without adding a clip."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import httpx
import pytest
from playwright.sync_api import Browser, expect

from app.recognition import Language
from app.settings import Settings
from tests.api.running import Running
from tests.browser.accessibility import faults
from tests.browser.camera import (
    OTHER_VIEWS,
    camera_showing,
    looked_often,
    see_seconds,
    watch_looks,
    write_feed,
)
from tests.browser.conftest import OpenPage, started

FEED_RATE = 6
"""Frames a second, every second one of a clip of 25 Hz: the diver moves at half the clip's speed.

A loaded machine then sees and records as many pictures of a stroke as a quiet one.
"""

STILL = 8
"""Seconds in which the diver waits before the clip."""

ONE_ROUND = 12.0 + STILL
"""Seconds in which the camera shows the whole clip."""

LONGEST_TAKE = 14.0
"""More seconds than from the first salute to the second, fewer than with the wait before."""

ROUNDS = 3
"""Rounds before the test fails: a recording begun in the middle may contain no complete take."""

JUDGED = re.compile("Right: |Not yet: |No take of ")
"""The feedback to a judged take."""

JUDGED_MS = 300_000
"""Longest wait for the poses of a clip of a few seconds on a loaded machine."""


@pytest.fixture(scope="module")
def feed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("camera") / "line.y4m"


@pytest.fixture(scope="module")
def browser(browser: Browser, clips: Path, feed: Path) -> Iterator[Browser]:
    """Start a second Chromium, whose camera sees a diver who draws a line between two salutes."""
    write_feed(clips / "line-test-2.mp4", feed, FEED_RATE, still=STILL)
    with started(browser.browser_type, *camera_showing(feed)) as another:
        yield another


@pytest.fixture(scope="module")
def language(server: Running, settings: Settings) -> str:
    """Return the id of a language whose line goes one way only."""
    sample = Language.from_json((settings.samples_dir / "osg-table-2.json").read_text("utf-8"))
    gestures = [
        replace(each, switches=replace(each.switches, direction="on")) for each in sample.gestures
    ]
    content = replace(sample, name="one way", gestures=gestures).to_json()
    place = f"{server.address}/api/v1/languages/import"
    return str(httpx.post(place, content=content, timeout=60).json()["id"])


def test_a_gesture_shown_to_the_camera_is_judged_and_counted(
    open_page: OpenPage, server: Running, language: str, clips: Path, feed: Path
) -> None:
    page = open_page({"view": "practice", "language": language}, scene=False)
    start = page.get_by_role("button", name="Start the camera")
    # Without any clip, practice offers the camera.
    expect(start).to_be_disabled()
    page.get_by_label("Diver").fill("Ana")
    page.get_by_label("Gesture to show").select_option("line")
    looks = watch_looks(page)
    start.click()
    stop = page.get_by_role("button", name="Stop the camera")
    expect(stop).to_be_visible()
    if page.evaluate(OTHER_VIEWS % (".practice-picture", ".practice-camera video")):
        stop.click()
        write_feed(clips / "line-test-2.mp4", feed, FEED_RATE, still=STILL, backward=True)
        start.click()
    expect(page.locator(".practice-camera .bones")).to_have_attribute("d", re.compile("^M.+L"))
    assert faults(page) == []
    answer = page.locator(".practice-answer")
    for _ in range(ROUNDS):
        see_seconds(page, ONE_ROUND)
        # A busy machine may have missed the end of the take.
        if not answer.inner_text():
            page.get_by_role("button", name="Recognise now").click()
        expect(answer).to_contain_text(JUDGED, timeout=JUDGED_MS)
        if "Right: line" in answer.inner_text():
            break
    # The camera repeats the take, so that others may have been counted by now.
    record = page.get_by_role("region", name="Ana")
    expect(record).to_contain_text(re.compile(r"\d errors in \d+ takes?:"))
    expect(record).to_contain_text("right: line")
    stop.click()
    expect(page.get_by_text("The camera is off")).to_be_visible()
    names = [each.clip.name for each in server.studio.clips.all()]
    assert any(re.match(r"Ana line \d{4}-\d\d-\d\d", name) for name in names), names
    # The clip of a take begins shortly before it, and not when the diver begins to wait, unless a
    # loaded machine looks too seldom to see its salutes.
    (shown,) = httpx.get(f"{server.address}/api/v1/languages/{language}/practice").json()
    right = [each["clip_id"] for each in shown["shown"] if each["right"]]
    durations = [server.studio.clips.get(each).clip.duration for each in right]
    assert min(filter(None, durations)) < LONGEST_TAKE or not looked_often(looks[-1]), durations
