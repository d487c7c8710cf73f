"""Exact frames: the number and seconds shown belong to the picture on the screen."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from queue import SimpleQueue
from threading import Thread

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.api.running import PATIENCE_SECONDS, until
from tests.browser.conftest import SHELL, WHOLE, OpenPage
from tests.browser.files import drop
from tests.browser.numbered_clips import block_places, number_on, numbered_clip
from tests.conftest import ROOT, WITHOUT_BROWSER

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
    # By the file, the frame before still lasts when this one is shown.
    page.get_by_label("Start frame").fill("7")
    page.get_by_role("heading", name="New gesture").click()
    video.steps_and_plays(page, 7)


_READS_NUMBERS = """<!doctype html><title>Exact frames</title><video muted playsinline></video>
<script type="module">
import { insideFrame, showFrames } from "/js/clips/frame-times.js";
const { times, order, blocks } = await (await fetch("/task")).json();
const video = document.querySelector("video");
const canvas = Object.assign(document.createElement("canvas"), { width: 320, height: 240 });
const context = canvas.getContext("2d", { willReadFrequently: true });
const number = () => {
  context.drawImage(video, 0, 0);
  return blocks.reduce((sum, [x, y], bit) =>
    sum + (context.getImageData(x, y, 1, 1).data[0] > 128 ? 2 ** bit : 0), 0);
};
const frames = showFrames(video);
frames.load(URL.createObjectURL(await (await fetch("/clip")).blob()));
await new Promise((shown) => frames.show({ begin: 0, shown }));
frames.show({ begin: (times[8] + times[9]) / 2 }); // No frame begins there; it holds nothing up.
const seen = [];
for (const frame of order) {
  await new Promise((shown) => frames.show({
    begin: times[frame], inside: insideFrame(times, frame), shown }));
  seen.push(number());
}
await fetch("/seen", { method: "POST", body: JSON.stringify(seen) });
</script>"""
"""A page that shows frames in an order, and reads the number off each as soon as it is shown."""

_BROWSERS = {
    "chromium": ((SHELL, *WHOLE), ("--headless", "--no-sandbox", "--user-data-dir={folder}")),
    "firefox": (("firefox-esr", "firefox"), ("--headless", "--no-remote", "--profile", "{folder}")),
}
"""Names and arguments of browsers, opened as people do: no driver is needed for one page."""


@pytest.mark.parametrize("kind", _BROWSERS)
def test_the_picture_is_that_of_the_wanted_frame_where_durations_are_wrong(
    kind: str, tmp_path: Path
) -> None:
    names, arguments = _BROWSERS[kind]
    executable = next(filter(None, map(shutil.which, names)), None)
    if executable is None:
        firefox = "needs Firefox: apt-get install firefox-esr"
        pytest.skip(WITHOUT_BROWSER if kind == "chromium" else firefox)
    times = numbered_clip(tmp_path / "numbered.mp4", FRAMES)
    order = [*range(FRAMES), *reversed(range(FRAMES)), 8, 7, 20, 19, 8, FRAMES - 1, 0]
    task = {"times": times, "order": order, "blocks": block_places()}
    with _serving(task, tmp_path / "numbered.mp4") as (address, seen):
        folder = tmp_path / "profile"
        folder.mkdir()
        options = [argument.format(folder=folder) for argument in arguments]
        environment = {**os.environ, "HOME": str(folder)}
        command = [executable, *options, address]
        # Debian's command is a shell that waits for the browser: both end as one group.
        browser = subprocess.Popen(command, env=environment, start_new_session=True)
        try:
            assert seen.get(timeout=PATIENCE_SECONDS) == order
        finally:
            os.killpg(browser.pid, signal.SIGKILL)
            browser.wait()


@contextmanager
def _serving(task: object, clip: Path) -> Iterator[tuple[str, SimpleQueue[list[int]]]]:
    """Serve the page that reads numbers; give its address, and what it will have read."""
    seen: SimpleQueue[list[int]] = SimpleQueue()

    class Handler(SimpleHTTPRequestHandler):
        def do_GET(self) -> None:
            if self.path.startswith("/js/"):
                super().do_GET()
                return
            pages = {"/": _READS_NUMBERS.encode(), "/task": json.dumps(task).encode()}
            self.send_response(200)
            self.send_header("Content-Type", "text/html" if self.path == "/" else "video/mp4")
            self.end_headers()
            self.wfile.write(pages.get(self.path) or clip.read_bytes())

        def do_POST(self) -> None:
            seen.put(json.loads(self.rfile.read(int(self.headers["Content-Length"]))))
            self.send_response(204)
            self.end_headers()

        def log_message(self, format: str, *arguments: object) -> None:
            """Write nothing."""

    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(Handler, directory=ROOT / "static"))
    thread = Thread(target=server.serve_forever)
    thread.start()
    try:
        yield f"http://127.0.0.1:{server.server_port}/", seen
    finally:
        server.shutdown()
        thread.join()
        server.server_close()
