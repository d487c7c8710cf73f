"""Waiting for the poses of several clips: the place in the queue, and the time for all."""

from __future__ import annotations

import os
import re
import signal
from collections.abc import Callable
from pathlib import Path
from urllib.parse import urljoin

from playwright.sync_api import expect

from tests.api.running import Running
from tests.api.running_workers import hold_worker, linux
from tests.browser.conftest import OpenPage
from tests.browser.files import drop
from tests.browser.library import add_clip
from tests.short_clips import shortened

EXTRACTION_MS = 300_000
"""Longest wait for the poses of a clip on a loaded machine."""

SECONDS = 4.0
"""Length of the clip: enough frames for progress and an estimate of the time left."""


def test_files_that_a_reload_drops_are_asked_about_and_named_afterwards(
    open_page: OpenPage, server: Running, tmp_path: Path
) -> None:
    page = open_page(scene=False)
    expect(page.get_by_role("heading", name="One demonstration makes a gesture")).to_be_visible()
    # No upload ends while this test looks.
    page.route("**/api/v1/uploads**", lambda route: None)
    file = tmp_path / "dive.mp4"
    file.write_bytes(b"0" * 1000)
    names = ("one.mp4", "two.mp4", "three.mp4", "four.mp4")
    drop(page, *[file] * 4, names=names)
    expect(page.get_by_role("list", name="Uploads").get_by_role("listitem")).to_have_count(4)
    # A press, without which a browser does not ask.
    page.locator("#clips-title").click()
    with page.expect_event("dialog") as asked:
        page.evaluate("setTimeout(() => location.reload())")
    assert asked.value.type == "beforeunload"
    asked.value.dismiss()
    expect(page.get_by_role("list", name="Uploads").get_by_role("listitem")).to_have_count(4)
    page.on("dialog", lambda dialog: dialog.accept())
    # One arrives, but its answer does not.
    add_clip(server, "circle", name="two.mp4")
    page.reload()
    alert = page.get_by_role("alert").filter(has_text="3 files were not sent")
    expect(alert).to_contain_text("one.mp4, three.mp4, four.mp4")
    page.reload()
    expect(page.get_by_role("heading", name="two.mp4")).to_be_visible()
    expect(alert).to_have_count(0)


@linux
def test_a_batch_shows_how_many_are_done_which_one_runs_and_the_time_for_all_after_a_reload_too(
    open_page: OpenPage, thin_clip: Callable[[str], Path], tmp_path: Path
) -> None:
    names = ("GOPR0001.mp4", "GOPR0001.mp4", "other.mp4")
    page = open_page(scene=False)
    missing: list[str] = []
    page.on(
        "response",
        lambda answer: (
            missing.append(answer.url)
            if answer.status == 404 and answer.url.endswith("/poster")
            else None
        ),
    )
    clip = shortened(thin_clip("line-test-2"), tmp_path / "short.mp4", SECONDS)
    drop(page, *[clip] * 3, names=names)
    # The first job runs as long as this test inspects the queue.
    worker = hold_worker(os.getpid())
    card = page.locator("#batch")
    expect(card).to_contain_text("0 of 3 clips done")
    expect(card).to_be_in_viewport(ratio=1)
    rows = page.get_by_role("list", name="Clips").get_by_role("listitem")
    queued = rows.filter(has_text=re.compile("GOPR0001|other"))
    expect(queued.filter(has_text="Next in the queue")).to_have_count(1)
    expect(queued.filter(has_text="Number 2 of 2 in the queue")).to_have_count(1)
    # Clips of one name differ in picture and time.
    twins, other = rows.filter(has_text="GOPR0001.mp4"), rows.filter(has_text="other.mp4")
    expect(twins).to_have_count(2)
    for row in [*twins.all(), other]:
        # The first frame, while no job has written a picture.
        expect(row.locator("img.poster")).to_have_js_property("naturalWidth", 320)
    expect(twins.filter(has_text=re.compile(r"added \d+:\d\d:\d\d"))).to_have_count(2)
    expect(other).not_to_contain_text("added")
    page.get_by_role("button", name="Make gestures of these clips").click()
    row = page.get_by_role("dialog").locator(".gesture-row").filter(has_text="GOPR0001.mp4")
    expect(row.locator("img.poster")).to_have_count(2)
    expect(row.filter(has_text=re.compile(r"added \d+:\d\d:\d\d"))).to_have_count(2)
    page.keyboard.press("Escape")
    # As it is worked: the running clip first, then the oldest. Two uploads go at once: any may end
    # first, and the newer of two may be taken before the older one is in the queue.
    listed = page.request.get(urljoin(page.url, "/api/v1/clips")).json()
    added = [clip for clip in listed if clip["name"] in names]
    added.sort(key=lambda clip: (clip["status"] == "queued", clip["created"]))
    worked = [str(clip["name"]) for clip in added]
    expect(queued.locator("b")).to_contain_text(worked)
    os.kill(worker, signal.SIGCONT)
    # Only the clip that runs has a bar; it is the first of the list, and named in the card.
    expect(queued.get_by_role("progressbar")).to_have_count(1)
    running = re.compile(re.escape(worked[0]) + r".*: \d+ of \d+ frames")
    expect(card).to_contain_text(running, timeout=EXTRACTION_MS)
    expect(card).to_contain_text(re.compile(r"about \d+ (s|min) left"), timeout=EXTRACTION_MS)
    assert not [url for url in missing for clip in added if clip["id"] in url]
    expect(card).to_contain_text("1 of 3 clips done", timeout=EXTRACTION_MS)
    worker = hold_worker(os.getpid())
    page.reload()
    expect(card).to_contain_text("1 of 3 clips done")
    os.kill(worker, signal.SIGCONT)
    expect(card).to_be_hidden(timeout=EXTRACTION_MS)
