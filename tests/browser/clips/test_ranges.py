"""Ranges of a clip: kept on a second click, and warned of where they contain a salute."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest
from playwright.sync_api import Page, expect

from tests.api.running import Running, client_of
from tests.browser.conftest import OpenPage
from tests.browser.library import Library, library_of

WARNING = "This range contains 2 Vulcan salutes"


@pytest.fixture
def library(server: Running, request: pytest.FixtureRequest) -> Iterator[Library]:
    with client_of(server.address) as client:
        yield library_of(server, client, request.node.name[:40])


def choose_whole_clip(page: Page) -> None:
    """Move both ends of the range to the ends of the clip."""
    for name, key, presses in (("Start", "Shift+ArrowLeft", 8), ("End", "Shift+ArrowRight", 8)):
        page.get_by_role("slider", name=f"{name} of the range").focus()
        for _ in range(presses):
            page.keyboard.press(key)


def test_a_second_click_on_the_selected_clip_keeps_its_take(
    open_page: OpenPage, library: Library
) -> None:
    page = open_page({**library.address, "recognition": library.recognise("circle")}, scene=False)
    take = page.get_by_role("button", name=re.compile("^Take 1"))
    expect(take).to_have_attribute("aria-pressed", "true")
    expect(page.locator("#outcome")).to_contain_text("Recognised as circle")
    page.locator("#clips .chosen .clip-open").click()
    # The controls that the click would change are drawn at once.
    expect(take).to_have_attribute("aria-pressed", "true")
    expect(page.locator("#range-text")).to_contain_text("Take 1 of 1")
    expect(page.locator("#outcome")).to_contain_text("Recognised as circle")
    assert "recognition=" in page.url


def test_a_range_with_salutes_is_warned_of_before_and_after_it_is_saved(
    open_page: OpenPage, library: Library
) -> None:
    page = open_page(library.address, scene=False)
    expect(page.get_by_role("button", name=re.compile("^Take 1"))).to_be_visible()
    expect(page.get_by_text(WARNING)).to_have_count(0)
    choose_whole_clip(page)
    expect(page.locator("#range-text").get_by_role("alert")).to_contain_text(WARNING)
    page.get_by_role("button", name="Save as gesture").click()
    page.get_by_role("textbox", name="Label").fill("whole clip")
    panel = page.get_by_role("region", name="Demonstration")
    expect(panel.get_by_role("alert")).to_contain_text(WARNING)
    page.get_by_role("button", name="Save gesture").click()
    card = page.get_by_role("list", name="Gestures").get_by_role("listitem")
    expect(card.locator(".tag.fault")).to_have_text(["whole clip"])

    recognition = library.recognise("whole clip")
    page = open_page({**library.address, "recognition": recognition}, scene=False)
    expect(page.get_by_role("region", name="Why")).to_contain_text(
        "The demonstration of 'whole clip' is the whole clip, with its salutes. Set its range."
    )
