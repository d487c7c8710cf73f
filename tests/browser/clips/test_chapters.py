"""Chapters of one recording, dropped together on the page."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

from playwright.sync_api import expect

from tests.api.running import Running, client_of
from tests.browser.accessibility import faults
from tests.browser.clips.test_bags import EXTRACTION_MS, clip_shown, takes_of
from tests.browser.conftest import OpenPage
from tests.browser.files import drop
from tests.recognition.damaged_clips import write_clip
from tests.short_clips import in_chapters

SEAM_SECONDS = 3.6
"""Where the second chapter begins, at a key frame."""

PLAYS = """async (address) => {
  const video = Object.assign(document.createElement("video"), { muted: true, src: address });
  await new Promise((resolve, reject) => ([video.onloadeddata, video.onerror] = [resolve, reject]));
  video.currentTime = 4.5;
  await new Promise((resolve, reject) => ([video.onseeked, video.onerror] = [resolve, reject]));
  return [video.duration, video.currentTime];
}"""


def test_two_chapters_become_one_clip_with_the_take_across_them(
    open_page: OpenPage, server: Running, thin_clip: Callable[[str], Path], tmp_path: Path
) -> None:
    names = ("GX020042.MP4", "GX010042.MP4")
    second, first = (tmp_path / name for name in names)
    in_chapters(thin_clip("line-test-2"), first, second)
    page = open_page(scene=False)
    page.get_by_label("Language", exact=True).select_option(label="Table 2: eight signs")
    drop(page, second, first)
    dialog = page.get_by_role("dialog", name="2 chapters of one recording: join them?")
    expect(dialog).to_contain_text("GX010042.MP4 to GX020042.MP4")
    assert faults(page) == []
    dialog.get_by_role("button", name="Join them").click()
    expect(page.locator("#clip-name")).to_have_text("GX010042-GX020042.MP4")
    expect(page.get_by_role("button", name=re.compile("^Take 1"))).to_be_visible(
        timeout=EXTRACTION_MS
    )
    expect(
        page.get_by_role("list", name="Clips", exact=True).get_by_role("listitem")
    ).to_have_count(1)
    with client_of(server.address) as client:
        (take,) = takes_of(client, clip_shown(page))
    assert take["start"] < SEAM_SECONDS < take["end"]
    duration, at = page.evaluate(PLAYS, f"/api/v1/clips/{clip_shown(page)}/video")
    assert (round(duration, 1), at) == (5.9, 4.5)
    page.get_by_role("button", name="Recognise", exact=True).click()
    expect(page.locator("#outcome")).to_contain_text("line")


def test_chapters_that_are_kept_apart_are_clips_of_their_own(
    open_page: OpenPage, installed_models: None, tmp_path: Path
) -> None:
    paths = [write_clip(tmp_path / f"GX0{number}0043.MP4", frames=4) for number in (1, 2)]
    page = open_page(scene=False)
    drop(page, *paths)
    page.get_by_role("button", name="Keep them apart").click()
    clips = page.get_by_role("list", name="Clips", exact=True)
    for path in paths:
        expect(clips).to_contain_text(path.name)
    expect(page.get_by_text("may go on in GX020043.MP4").first).to_be_visible(timeout=EXTRACTION_MS)
