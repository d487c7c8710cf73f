"""No view has a fault that axe calls serious, nor content that scrolls the header away."""

from __future__ import annotations

from collections.abc import Iterator

import httpx
import pytest
from playwright.sync_api import Page, ViewportSize, expect

from tests.api.running import Running, client_of
from tests.browser.accessibility import SCHEMES, faults
from tests.browser.conftest import OpenPage
from tests.browser.library import Library, add_clip, library_of

SHOWN = {
    "Studio": "role=button[name=/^Take 1/]",
    "Languages": "role=link[name='accessible']",
    "Phrases": "role=button[name='Add the first phrase']",
    "Health": "role=table[name='What is known of each gesture']",
    "Practice": "role=textbox[name='Diver']",
    "Live": "role=button[name='Start the camera']",
}
"""By view a selector of content that appears once all is loaded."""


ESCAPING = """() => {
  const scrolls = (e) => e.checkVisibility() && /auto|scroll/.test(getComputedStyle(e).overflowY);
  const scrollerOf = (e) => {
    let each = e.parentElement;
    while (each && !scrolls(each)) each = each.parentElement;
    return each;
  };
  return [...document.querySelectorAll("body *")]
    .filter((e) => e.offsetParent && getComputedStyle(e).position === "absolute")
    .filter((e) => scrollerOf(e) && !scrollerOf(e).contains(e.offsetParent))
    .map((e) => e.outerHTML.slice(0, 120));
}"""
"""Elements that are placed outside the box with which they should scroll: they lengthen the
document, which then scrolls its header away."""


@pytest.fixture(scope="module")
def library(server: Running) -> Iterator[Library]:
    with client_of(server.address) as client:
        yield library_of(server, client, "accessible")


DESK, PHONE = ViewportSize(width=1280, height=800), ViewportSize(width=390, height=844)


def test_every_distance_of_a_recognition_with_its_reasons_is_legible(
    open_page: OpenPage, server: Running, client: httpx.Client
) -> None:
    library = library_of(server, client, "distances")
    # The fainter a cell, the farther the gesture: half-way cells had too little contrast.
    for shape in ("circle backwards", "corner"):
        library.add_gesture(shape, add_clip(server, shape, name=f"{shape}.mp4"))
    query = {**library.address, "recognition": library.recognise("line")}
    page = open_page(query, scene=False, size=(1440, 900))
    expect(page.get_by_role("region", name="Why")).to_contain_text("'line'")
    page.get_by_role("button", name="Show the comparisons without weight").click()
    expect(page.locator("#stroke-over")).to_be_visible()
    assert page.evaluate(ESCAPING) == []
    for scheme in SCHEMES:
        page.emulate_media(color_scheme=scheme)
        check_distances(page)
    page.emulate_media(color_scheme="dark")
    page.get_by_role("button", name="Readable in the sun").click()
    check_distances(page)


def check_distances(page: Page) -> None:
    """Check that distances have shades, all of them legible."""
    cells = page.locator("table[aria-label=Votes] tbody td, .vote-table tbody td")
    shades = "cells => new Set(cells.map(e => getComputedStyle(e).backgroundColor)).size"
    assert cells.evaluate_all(shades) > 3
    assert faults(page) == []


def test_every_view_at_a_desk_and_on_a_phone(open_page: OpenPage, library: Library) -> None:
    page = open_page(library.address, scene=False)
    links = page.get_by_role("navigation", name="Views").get_by_role("link")
    expect(links).to_have_text(list(SHOWN))
    found, widths = {}, {}
    for name, content in SHOWN.items():
        page.set_viewport_size(DESK)
        links.get_by_text(name, exact=True).click()
        expect(page.locator(".view:visible").locator(content)).to_be_visible()
        found[name] = page.evaluate(ESCAPING)
        for scheme in SCHEMES:
            page.emulate_media(color_scheme=scheme)
            found[name] += faults(page)
        page.set_viewport_size(PHONE)
        found[name] += faults(page)
        widths[name] = page.evaluate("document.documentElement.scrollWidth")
    assert found == {name: [] for name in SHOWN}
    assert max(widths.values()) <= PHONE["width"], widths


def test_the_header_stays_while_clips_are_chosen_for_the_test_set(
    open_page: OpenPage, server: Running, library: Library
) -> None:
    for number in range(12):
        add_clip(server, "circle", name=f"to test {number}.mp4")
    page = open_page(library.address | {"view": "health"}, scene=False)
    page.get_by_role("button", name="Test with clips").click()
    page.locator("summary").filter(has_text="Choose from the").click()
    for width in (1440, 1024, 768):
        page.set_viewport_size({"width": width, "height": 700})
        # At one moment: the page may draw the list anew at the next.
        page.get_by_text("to test 0.mp4").last.evaluate("row => row.scrollIntoView()")
        assert page.evaluate(ESCAPING) == []
        expect(page.get_by_role("navigation", name="Views")).to_be_in_viewport(ratio=1)
        assert page.evaluate("[scrollY, document.documentElement.scrollHeight]") == [0, 700]


@pytest.mark.parametrize(
    ("query", "content"),
    [
        ({"view": "gesture", "gesture": "circle"}, "text=Distance of the nearest gestures"),
        ({"view": "languages", "panel": "history"}, "role=button[name='Go back to revision 2']"),
    ],
)
def test_what_the_views_lead_to(
    open_page: OpenPage, library: Library, query: dict[str, str], content: str
) -> None:
    page = open_page({"language": library.language, **query}, scene=False)
    for size in (DESK, PHONE):
        page.set_viewport_size(size)
        expect(page.locator(".view:visible").locator(content)).to_be_visible()
        assert faults(page) == []
        assert page.evaluate(ESCAPING) == []
        assert page.evaluate("document.documentElement.scrollWidth") <= size["width"]


def test_the_list_of_all_keys_and_the_export(open_page: OpenPage, library: Library) -> None:
    page = open_page(library.address, scene=False)
    expect(page.get_by_role("link", name="Studio", exact=True)).to_have_attribute(
        "aria-current", "page"
    )
    page.keyboard.press("?")
    listed = page.get_by_role("dialog", name="Keys")
    expect(listed.get_by_text("Undo", exact=True)).to_be_visible()
    # Also the keys of views not opened yet.
    for group in ("Playback", "Editing a gesture", "Two gestures side by side", "Live"):
        expect(listed.get_by_role("heading", name=group, exact=True)).to_be_visible()
    check_sizes(page)
    page.keyboard.press("Escape")
    expect(listed).to_be_hidden()
    page.get_by_role("button", name="Export").click()
    export = page.get_by_role("dialog", name="Export")
    export.get_by_text("What the robot needs").click()
    expect(export.get_by_role("term").first).to_have_text("Keypoints")
    check_sizes(page)


def check_sizes(page: Page) -> None:
    """Check what is open at the width of a phone and of a screen."""
    for size in (PHONE, DESK):
        page.set_viewport_size(size)
        assert faults(page) == []
