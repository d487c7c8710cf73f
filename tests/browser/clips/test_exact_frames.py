"""Exact frames: the number and seconds shown belong to the picture on the screen."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.api.running import until
from tests.browser.conftest import OpenPage
from tests.browser.files import drop
from tests.browser.numbered_clips import number_on, numbered_clip

FRAMES = 30

EXTRACTION_MS = 300_000
"""Longest wait for the models to look at the frames, on a loaded machine."""


@dataclass(frozen=True)
class Screen:
    """A picture of the clip, and the clock that tells which frame it is.

    Attributes
    ----------
    picture, clock
        Their locators on the page.
    times
        Seconds of the clip's frames.

    """

    picture: Locator
    clock: Locator
    times: list[float]

    def shows(self, frame: int) -> None:
        """Check that this frame's number, seconds and picture are shown."""
        expect(self.clock).to_have_text(re.compile(rf"frame {frame}\b"))
        until(lambda: number_on(self.picture.screenshot()) == frame)
        shown, seconds = self.position()
        assert shown == frame
        assert seconds == pytest.approx(self.times[frame], abs=0.0051)

    def position(self) -> tuple[int, float]:
        """Read number and seconds off the clock."""
        text = self.clock.inner_text()
        (frame,) = re.findall(r"frame (\d+)", text)
        (seconds,) = re.findall(r"([\d.]+) s\b", text)
        return int(frame), float(seconds)

    def steps_and_plays(self, page: Page, at: int) -> None:
        """Check the keys, starting at a frame."""
        keys = ((".", 1), (",", 0), (",", -1), ("Shift+.", 9), (".", 10), ("Shift+,", 0))
        for pressed, moved in keys:
            page.keyboard.press(pressed)
            self.shows(at + moved)
        page.keyboard.press("Space")
        expect(page.get_by_role("button", name="Pause", exact=True)).to_be_visible()
        expect(self.clock).not_to_have_text(re.compile(rf"frame {at}\b"))
        page.keyboard.press("Space")
        expect(page.get_by_role("button", name="Pause", exact=True)).to_have_count(0)
        self.shows(self.position()[0])


def drag_to(page: Page, share: float) -> None:
    """Drag the scene's clock from the middle of the timeline to a share of it."""
    box = page.locator("#timeline .curve-area").bounding_box()
    assert box is not None
    x, y = box["x"], box["y"] + box["height"] / 2
    page.mouse.move(x + box["width"] / 2, y)
    page.mouse.down()
    page.mouse.move(x + box["width"] * share, y, steps=5)
    page.mouse.up()


def test_number_and_seconds_are_those_of_the_picture_on_the_screen(
    open_page: OpenPage, clips: Path, tmp_path: Path
) -> None:
    del clips  # This fixture is requested only because it skips the test where there are no models.
    times = numbered_clip(tmp_path / "numbered.mp4", FRAMES)
    page = open_page(size=(1280, 800))
    drop(page, tmp_path / "numbered.mp4")
    clock = page.locator("#clock")
    expect(clock).to_have_text(re.compile(f"frame .* of {FRAMES}$"), timeout=EXTRACTION_MS)
    lab = page.frame_locator("#lab")
    scene = Screen(lab.locator("canvas[data-engine]"), clock, times)
    scene.steps_and_plays(page, scene.position()[0])
    for frame in (0, 7, FRAMES - 1):
        drag_to(page, times[frame] / times[-1])
        scene.shows(frame)
    page.goto(re.sub(r"frame=\d+", "frame=3", page.url))
    scene.shows(3)

    # The editor's pictures are decoded by the browser, which has a clock of its own.
    page.get_by_role("button", name="Save as gesture").click()
    page.get_by_role("button", name="Save into the sample").click()
    output = page.locator(".take-panel .scrub output")
    video = Screen(page.locator(".take-panel .figure"), output, times)
    video.shows(0)
    page.get_by_label("Start frame").fill("5")
    page.get_by_role("heading", name="New gesture").click()
    video.steps_and_plays(page, 5)
