"""Studio page: frame rates with a long clip, in Chromium with software WebGL.

A clip of 30 s in 1280 x 720, in which a rendered diver draws again and again:

- while scrubbing through it at 25 frames a second: the share of requested frames that are shown,
how often the 3D view is drawn, relative to 25 a second, and how long the server computes for a
frame, relative to a 25th of a second (the last does not depend on other load of the machine);
- the share of the clip that is processed when the first poses are on the screen.
"""

from __future__ import annotations

import shutil
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import av
import cv2
import numpy as np
import numpy.typing as npt
from playwright.sync_api import Browser, Page, sync_playwright

from app.recognition.recording.video import read_frames
from app.resources import samples_dir
from app.settings import Settings
from tests.api.recordings import RATE, recording_of
from tests.api.running import Running, running
from tests.browser.conftest import PATIENCE_MS, WEBGL
from tests.browser.files import drop
from tests.browser.library import add_clip

SHAPES = ("circle", "line", "circle backwards") * 3
"""Number of takes: nine last 33 s; the clip is cut at 30 s."""

SECONDS, SIZE = 30, (1280, 720)

ASKED_PER_SECOND = 25
ASKED = 250
"""Ten seconds of scrubbing, each time two frames on."""

SCRUB = """async ({ asked, period }) => {
  // At the page's own address, which carries a digest: elsewhere it would be another state.
  const main = document.querySelector("script[type=module]").src;
  const { seek } = await import(new URL("studio/playback.js", main));
  const { follow, state } = await import(new URL("core/state.js", main));
  const shown = new Set();
  follow(["position"], ({ position }) => { if (position) shown.add(position.frame); });
  shown.clear();
  let drawn = 0;
  let counting = true;
  const frames = document.getElementById("lab").contentWindow;
  const count = () => { drawn += 1; if (counting) frames.requestAnimationFrame(count); };
  frames.requestAnimationFrame(count);
  const began = performance.now();
  for (let index = 0; index < asked; index += 1) {
    const due = began + index * period;
    while (performance.now() < due) await new Promise((resolve) => setTimeout(resolve, 2));
    seek(2 * index);
  }
  const last = 2 * (asked - 1);
  while (state.position.frame !== last) await new Promise((resolve) => setTimeout(resolve, 5));
  counting = false;
  return { shown: shown.size, drawn, seconds: (performance.now() - began) / 1000 };
}"""

FIRST_POSES = """() => {
  const bones = document.querySelector("#welcome .skeleton .bones")?.getAttribute("d");
  const told = document.getElementById("welcome").textContent.match(/(\\d+) of (\\d+) frames/);
  return bones && told ? [Number(told[1]), Number(told[2])] : null;
}"""


def write_long_clip(path: Path, frames: int) -> Path:
    """Write a sample clip's frames over and over, enlarged, at the rate of the recordings."""
    sample = samples_dir() / "clips" / "circle-demonstration.mp4"
    with read_frames(sample) as read:
        pictures = [_enlarge(frame.image) for frame in read]
    with av.open(str(path), "w") as container:
        stream = container.add_stream("libx264", rate=RATE, options={"preset": "ultrafast"})
        stream.width, stream.height, stream.pix_fmt = *SIZE, "yuv420p"
        for index in range(frames):
            image = pictures[index % len(pictures)]
            container.mux(stream.encode(av.VideoFrame.from_ndarray(image, format="rgb24")))
        container.mux(stream.encode())
    return path


def _enlarge(image: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]:
    enlarged: npt.NDArray[np.uint8] = cv2.resize(image, SIZE)  # type: ignore[assignment]
    return enlarged


@contextmanager
def opened() -> Iterator[tuple[Running, Page, Path]]:
    """Serve an empty studio, and open it in Chromium; yield both, and a folder."""
    executable = shutil.which("chromium") or shutil.which("chromium-browser")
    if executable is None:
        raise SystemExit("this benchmark needs Chromium: apt-get install chromium")
    with tempfile.TemporaryDirectory() as name, sync_playwright() as playwright:
        folder = Path(name)
        settings = Settings(data_dir=folder / "data", samples_dir=folder / "none")
        browser = playwright.chromium.launch(executable_path=executable, args=list(WEBGL))
        with running(settings) as server:
            yield server, _open_page(browser, server), folder
        browser.close()


def _open_page(browser: Browser, server: Running) -> Page:
    page = browser.new_page(viewport={"width": 1280, "height": 800})
    page.set_default_timeout(4 * PATIENCE_MS)
    page.add_init_script("localStorage.setItem('osg-studio.tour', 'seen')")
    page.goto(server.address)
    return page


def scrub(server: Running, page: Page, clip: Path) -> dict[str, Any]:
    """Scrub through a clip whose poses are known; return the page's measurements."""
    clip_id = add_clip(server, *SHAPES, name=clip.name, video=clip)
    page.goto(f"{server.address}/?clip={clip_id}")
    page.frame_locator("#lab").locator("canvas").first.wait_for()
    page.wait_for_function("() => /frame/.test(document.getElementById('clock')?.textContent)")
    found: dict[str, Any] = {}
    # At first the pictures are still being decoded; people look for a moment before they scrub.
    for _ in range(2):
        before = time.process_time()
        found = page.evaluate(SCRUB, {"asked": ASKED, "period": 1000 / ASKED_PER_SECOND})
        found["computed"] = time.process_time() - before
    return found


def count_first_poses(page: Page, clip: Path) -> tuple[int, int]:
    """Drop a clip; return the processed and all frames when the first poses are on the screen."""
    drop(page, clip)
    done, total = page.wait_for_function(FIRST_POSES, polling="raf").json_value()
    page.get_by_role("button", name=f"Cancel {clip.name}").click()
    return int(done), int(total)


def main() -> None:
    """Print the ratios."""
    frames = min(SECONDS * RATE, len(recording_of(*SHAPES).poses))
    with opened() as (server, page, folder):
        clip = write_long_clip(folder / "long.mp4", frames)
        done, total = count_first_poses(page, clip)
        found = scrub(server, page, clip)
    print(
        f"scrubbing {frames} frames of 720p at {ASKED_PER_SECOND} frames a second: "
        f"{found['shown'] / ASKED:.2f} of the frames asked for were shown, "
        f"in {found['seconds'] * ASKED_PER_SECOND / ASKED:.2f} times the time; the 3D view was "
        f"drawn {found['drawn'] / found['seconds'] / ASKED_PER_SECOND:.2f} times as often; for a "
        f"frame the server computes {found['computed'] / found['shown'] * ASKED_PER_SECOND:.2f} of "
        "the time that it has"
    )
    print(f"first poses on screen: {done / total:.3f} of the clip done ({done} of {total} frames)")
