"""The whole journey by keyboard alone: from a clip to the file for the robot."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.api.running import Running, client_of
from tests.browser.conftest import OpenPage
from tests.browser.library import Library, add_clip, library_of
from tests.recognition.damaged_clips import write_clip

MOST_TABS = 120
"""More steps of the focus than any view has."""


@pytest.fixture
def library(server: Running) -> Iterator[Library]:
    with client_of(server.address) as client:
        add_clip(server, "circle backwards", name="other way.mp4")
        add_clip(server, "line", name="another line.mp4")
        yield library_of(server, client, "by keyboard")


def reach(page: Page, wanted: Locator, *, shown: Locator | None = None) -> None:
    """Press Tab until an element has the focus; it, or its visible part `shown`, must be seen."""
    expect(wanted).to_have_count(1)
    element = wanted.element_handle()
    for _ in range(MOST_TABS):
        page.keyboard.press("Tab")
        if element.evaluate("element => element === document.activeElement"):
            expect(shown or wanted).to_be_in_viewport()
            return
    raise AssertionError(f"Tab does not reach {wanted}")


def press(page: Page, name: str | re.Pattern[str]) -> None:
    """Go to a button and press Enter."""
    reach(page, page.get_by_role("button", name=name).first)
    page.keyboard.press("Enter")


def open_view(page: Page, name: str) -> None:
    """Go to a view by its link."""
    reach(page, page.get_by_role("navigation", name="Views").get_by_role("link", name=name))
    page.keyboard.press("Enter")


def test_from_a_clip_to_the_file_for_the_robot(
    open_page: OpenPage, library: Library, tmp_path: Path
) -> None:
    page = open_page({"language": library.language}, scene=False)
    expect(page.get_by_role("list", name="Gestures").get_by_role("listitem")).to_have_count(2)

    # A file is uploaded.
    with page.expect_file_chooser() as chooser:
        reach(page, page.locator("#file"), shown=page.get_by_text("Drop clips anywhere"))
        page.keyboard.press("Space")
    chooser.value.set_files(write_clip(tmp_path / "nobody.mp4"))
    expect(page.get_by_role("button", name="Show nobody.mp4")).to_be_visible()

    # A clip becomes a gesture.
    press(page, "Show other way.mp4")
    expect(page.get_by_role("button", name=re.compile("^Take 1"))).to_be_visible()
    press(page, "Save as gesture")
    reach(page, page.get_by_label("Label", exact=True))
    page.keyboard.type("other way")
    press(page, "Save gesture")
    expect(page.get_by_text("Gesture saved")).to_be_visible()
    # Where the button was, nothing is: the focus goes to the card.
    expect(page.get_by_role("button", name="1 demonstration of other way")).to_be_focused()
    expect(page.get_by_role("list", name="Gestures").get_by_role("listitem")).to_have_count(3)

    # Another clip is recognised, and its explanation is opened.
    press(page, "Show another line.mp4")
    expect(page.get_by_role("button", name=re.compile("^Take 1"))).to_be_visible()
    reach(page, page.get_by_label("Expected", exact=True))
    page.keyboard.type("circle")
    press(page, "Recognise")
    expect(page.locator("#outcome")).to_contain_text("Recognised as line")
    expect(page.get_by_role("region", name="Why")).to_contain_text("'line'")

    # The health check is opened, with two gestures side by side.
    open_view(page, "Health")
    known = page.get_by_role("table", name="What is known of each gesture")
    reach(page, known.locator(".nearest button").first)
    page.keyboard.press("Enter")
    expect(page.get_by_role("slider", name="Moment of both gestures")).to_be_visible()
    page.keyboard.press("Escape")
    expect(known).to_be_visible()

    # The language is downloaded for the robot.
    open_view(page, "Studio")
    press(page, "Export")
    dialog = page.get_by_role("dialog", name="Export")
    with page.expect_download() as download:
        reach(page, dialog.get_by_role("link", name="Download").first)
        page.keyboard.press("Enter")
    assert download.value.suggested_filename.endswith(".json")
    page.keyboard.press("Escape")
    expect(dialog).to_be_hidden()
