"""A clip that is open while it is read: it grows, and is played to its very last frame."""

from __future__ import annotations

import os
import re
import signal
from pathlib import Path

import httpx
from playwright.sync_api import Locator, expect

from tests.api.running import Running, until
from tests.api.running_workers import hold_worker, linux
from tests.browser.clips.test_exact_frames import EXTRACTION_MS, drag_to
from tests.browser.conftest import OpenPage
from tests.browser.files import drop
from tests.short_clips import thinned

TAKES = 3


def frames_on(clock: Locator) -> int:
    """Return the number of frames that the clock on display counts; 0 before there are any."""
    found = re.search(r" of (\d+)$", clock.inner_text())
    return int(found[1]) if found else 0


@linux
def test_a_clip_that_is_open_while_it_is_read_is_played_to_its_last_frame(
    open_page: OpenPage, server: Running, clips: Path, tmp_path: Path
) -> None:
    file = thinned(clips / "line-test-2.mp4", tmp_path / "thrice.mp4", TAKES)
    page = open_page(scene=False)
    drop(page, file)
    page.wait_for_url(re.compile("clip="))
    other = open_page({"clip": re.findall(r"clip=(\w+)", page.url)[0]}, scene=False)
    clock, second = page.locator("#clock"), other.locator("#clock")
    counted = [0]
    # The first take, and more while the rest is read; held, so that this is seen on any machine.
    for _ in range(2):
        until(lambda: min(frames_on(clock), frames_on(second)) > counted[-1])
        worker = hold_worker(os.getpid())
        counted.append(frames_on(clock))
        os.kill(worker, signal.SIGCONT)
    (job,) = (each.job for each in server.studio.clips.all() if each.clip.name == "thrice.mp4")
    place = f"{server.address}/api/v1/jobs/{job.id}"
    until(lambda: httpx.get(place).json()["status"] == "done")
    frames = httpx.get(place).json()["total"]
    assert counted[1] < counted[2] < frames
    expect(clock).to_have_text(re.compile(f" of {frames}$"), timeout=EXTRACTION_MS)
    takes = page.get_by_role("group", name="Takes").locator(".take")
    expect(takes).to_have_count(TAKES)
    expect(page.locator(".filmstrip")).to_be_attached()
    for each in (page, other):
        each.bring_to_front()
        drag_to(each, 1.0)
        expect(each.locator("#clock")).to_have_text(
            re.compile(f"frame {frames - 1} of {frames}$"), timeout=EXTRACTION_MS
        )
