"""A library of more clips than the page loads at once: older ones come by scrolling and search."""

from __future__ import annotations

import re
from contextlib import closing

import pytest
from playwright.sync_api import Page, expect

from app.settings import Settings
from app.store import Database
from benchmarks.cost.server import CLIPS_OF_A_PAGE, fill
from tests.api.running import Running
from tests.browser.conftest import OpenPage
from tests.browser.library import add_clip

CLIPS = CLIPS_OF_A_PAGE + 40

AT_ONCE = 4
"""Clips whose takes the gesture table asks for at a time."""


@pytest.fixture(scope="module")
def newest(server: Running, settings: Settings) -> str:
    """Return the id of the newest clip, the only one with poses in files."""
    with closing(Database(settings.database)) as database:
        fill(database, 0, CLIPS)
    return add_clip(server, "circle", name="newest.mp4")


def rows(page: Page) -> int:
    return page.locator("#clips > li").count()


def list_takes(asked: list[str]) -> list[str]:
    return [url for url in asked if "/takes" in url]


def test_older_clips_are_found_by_name_and_loaded_by_a_button(
    open_page: OpenPage, newest: str
) -> None:
    page = open_page(scene=False)
    count, more = page.locator("#clip-count"), page.locator("#more-clips")
    expect(count).to_have_text(f"{CLIPS + 1}")
    expect(page.locator("#clip-name")).to_have_text("newest.mp4")
    assert rows(page) == CLIPS_OF_A_PAGE
    find = page.get_by_label("Find clips")
    find.fill("DIVE 7.")
    expect(page.get_by_role("button", name="Show dive 7.mp4")).to_be_visible()
    assert rows(page) == 1
    find.fill("wreck")
    expect(page.locator("#no-clip")).to_have_text("No clip is called \u201cwreck\u201d.")
    find.fill("")
    expect(page.get_by_role("button", name="Show dive 7.mp4")).to_have_count(0)
    expect(more).to_have_text("Older clips (41)")
    more.click()
    expect(page.locator("#clips > li")).to_have_count(CLIPS + 1)
    expect(more).to_be_hidden()
    expect(count).to_have_text(f"{CLIPS + 1}")


def test_a_link_to_an_older_clip_opens_it_and_scrolling_loads_those_between(
    open_page: OpenPage, newest: str
) -> None:
    page = open_page({"clip": f"{3:032x}"}, scene=False)
    expect(page.locator("#clip-name")).to_have_text("dive 3.mp4")
    expect(page.locator("#clips > .chosen")).to_contain_text("dive 3.mp4")
    assert rows(page) == CLIPS_OF_A_PAGE + 1
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.get_by_role("button", name=re.compile("Make gestures of")).click()
    dialog = page.get_by_role("dialog")
    older = dialog.get_by_role("button", name=re.compile("older clips"))
    expect(older).to_have_text("Load more of 41 older clips")
    dialog.get_by_role("button", name="Cancel").click()
    expect(dialog).to_be_hidden()
    by_then = len(list_takes(asked))
    page.locator("#clips").evaluate("list => list.scrollTo(0, 0)")
    page.locator("#clips").evaluate("list => list.scrollTo(0, list.scrollHeight)")
    expect(page.locator("#clips > li")).to_have_count(CLIPS + 1)
    # The open table requests a clip's takes once; requests left when it closes are not sent.
    takes = list_takes(asked)
    assert 0 < len(takes) == len(set(takes)) < CLIPS_OF_A_PAGE
    assert len(takes) <= by_then + AT_ONCE
