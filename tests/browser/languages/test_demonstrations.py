"""Several demonstrations of a gesture: compared side by side, added from a clip, removed."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.api.running import Running, client_of
from tests.browser.accessibility import faults
from tests.browser.conftest import OpenPage
from tests.browser.library import Library, add_clip, library_of


@pytest.fixture
def library(server: Running) -> Iterator[Library]:
    with client_of(server.address) as client:
        yield library_of(server, client, "Reef")


def open_dialog(page: Page, count: str) -> Locator:
    """Open the demonstrations of the circle."""
    page.get_by_role("button", name=f"{count} of circle").click()
    return page.get_by_role("dialog", name="Demonstrations of circle")


def divers(library: Library) -> list[str]:
    """Return the divers of the circle's demonstrations, as they are saved."""
    language = library.client.get(f"/api/v1/languages/{library.language}").json()
    (circle,) = (each for each in language["gestures"] if each["label"] == "circle")
    return [each["diver"] for each in circle["demonstrations"]]


def test_a_further_demonstration_is_added_compared_removed_undone_and_opened(
    open_page: OpenPage,
    server: Running,
    library: Library,
    picture: Callable[[Page, str], Path],
) -> None:
    add_clip(server, "circle backwards", name="ben.mp4")
    page = open_page(library.address, scene=False)
    dialog = open_dialog(page, "1 demonstration")
    cards = dialog.get_by_role("list", name="Demonstrations").get_by_role("listitem")
    expect(cards).to_have_count(1)
    expect(cards.get_by_role("button", name="Remove demonstration 1")).to_be_disabled()
    dialog.get_by_label("Clip").select_option(label="ben.mp4")
    expect(dialog.get_by_label("Range")).to_contain_text("Take 1")
    dialog.get_by_label("Diver").fill("Ben")
    dialog.get_by_role("button", name="Add", exact=True).click()
    expect(cards).to_have_count(2)
    expect(cards.last).to_contain_text("Ben")
    expect(cards.last).to_contain_text(" s")
    expect(cards.last.get_by_role("link", name="ben.mp4")).to_be_visible()
    assert divers(library) == ["", "Ben"]
    assert faults(page) == []
    picture(page, "demonstrations")

    cards.first.get_by_role("button", name="Remove").click()
    expect(cards).to_have_count(1)
    expect(cards).to_contain_text("Ben")
    dialog.get_by_role("button", name="Close").click()
    page.keyboard.press("Control+z")
    expect(page.get_by_role("button", name="2 demonstrations of circle")).to_be_visible()
    assert divers(library) == ["", "Ben"]
    page.keyboard.press("Control+z")
    expect(page.get_by_role("button", name="1 demonstration of circle")).to_be_visible()
    # A demonstration leads to its clip.
    page.set_viewport_size({"width": 390, "height": 844})
    open_dialog(page, "1 demonstration")
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    dialog.get_by_role("link", name="Reef.mp4").press("Enter")
    expect(dialog).to_be_hidden()
    expect(page.get_by_role("heading", name="Reef.mp4")).to_be_visible()
