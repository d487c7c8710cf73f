"""All takes of the clips in one table: recognised, sorted, filtered, opened and exported."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import expect

from tests.api.running import Running, client_of
from tests.browser.accessibility import faults
from tests.browser.conftest import OpenPage
from tests.browser.library import Library, add_clip, library_of


@pytest.fixture
def library(server: Running) -> Iterator[Library]:
    with client_of(server.address) as client:
        yield library_of(server, client, "dives")


def test_all_takes_are_in_one_table(
    open_page: OpenPage, server: Running, library: Library, tmp_path: Path
) -> None:
    both = add_clip(server, "line", "circle", name="both.mp4")
    page = open_page(library.address, scene=False, size=(390, 844))
    page.get_by_role("button", name="Read all takes").click()
    dialog = page.get_by_role("dialog", name="All takes, recognised by dives")
    assert faults(page) == []
    dialog.get_by_label("dives line.mp4").uncheck()
    dialog.get_by_role("button", name="Recognise all takes").click()
    rows = dialog.locator("tbody tr")
    expect(rows).to_have_count(3)
    assert faults(page) == []
    # The table scrolls, and nothing around it does.
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    assert page.evaluate("(d => d.scrollWidth <= d.clientWidth)(document.querySelector('dialog'))")

    dialog.get_by_role("button", name="Label").click()
    assert [text.strip() for text in rows.locator("td:nth-child(4)").all_inner_texts()] == [
        "circle",
        "circle (demonstration)",
        "line",
    ]
    expect(dialog.get_by_role("columnheader", name="Label")).to_have_attribute(
        "aria-sort", "ascending"
    )
    dialog.get_by_label("Show", exact=True).select_option("line")
    expect(rows).to_have_count(1)
    expect(dialog.get_by_text("1 of 3 rows")).to_be_visible()
    with page.expect_download() as download:
        dialog.get_by_role("button", name="Export as CSV").click()
    download.value.save_as(tmp_path / "takes.csv")
    with (tmp_path / "takes.csv").open(newline="", encoding="utf-8") as file:
        assert len(list(csv.DictReader(file))) == 3
    dialog.get_by_label("Show", exact=True).select_option("circle")
    dialog.get_by_role("button", name="both.mp4, take 2").click()
    expect(dialog).to_have_count(0)
    expect(page.locator("#clip-name")).to_have_text("both.mp4")
    page.wait_for_url(f"**clip={both}&take=1**")


def test_takes_between_two_gestures_and_rejected_ones_are_filtered_and_a_table_is_cancelled(
    open_page: OpenPage, server: Running, library: Library
) -> None:
    library.add_gesture("ring")
    page = open_page(library.address, scene=False)
    page.get_by_role("button", name="Read all takes").click()
    dialog = page.get_by_role("dialog", name="All takes, recognised by dives")
    dialog.get_by_role("button", name="Recognise all takes").click()
    rows = dialog.locator("tbody tr")
    # Clips of other tests are recognised too, which takes a while.
    expect(rows.first).to_be_visible(timeout=30_000)
    dialog.get_by_label("Show", exact=True).select_option("Asked back")
    expect(rows.first.locator("td").nth(3)).to_have_text("circle or ring? (demonstration)")
    dialog.get_by_label("Show", exact=True).select_option("Rejected")
    shown = rows.locator("td:nth-child(4)").all_inner_texts()
    assert [text for text in shown if not text.startswith("rejected")] == []

    # The table shows how far it is.
    add_clip(server, *["circle", "line"] * 30, name="long.mp4")
    page.reload()
    page.get_by_role("button", name="Read all takes").click()
    with page.expect_event("requestfailed", lambda each: "take-table" in each.url):
        dialog.get_by_role("button", name="Recognise all takes").click()
        expect(dialog.get_by_text("long.mp4")).to_contain_text("Recognising clip")
        dialog.get_by_role("button", name="Cancel").click()
    expect(dialog).to_have_count(0)
