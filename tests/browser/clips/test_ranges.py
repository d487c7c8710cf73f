"""Ranges of a clip: kept on a second click, and warned of where they contain a salute."""

from __future__ import annotations

import re
from itertools import pairwise

import pytest
from playwright.sync_api import FloatRect, Locator, Page, expect

from tests.api.running import Running, until
from tests.browser.conftest import OpenPage
from tests.browser.library import Library, add_clip

WARNING = "This range contains 2 Vulcan salutes"

SIDES = (
    "all => all.map(each => each.getBoundingClientRect()).map(({ left, right }) => [left, right])"
)
"""Left and right of all elements at one moment: the page may draw them anew at the next."""


def box_of(locator: Locator) -> FloatRect:
    """Return the place of an element that is drawn."""
    box = locator.bounding_box()
    assert box is not None
    return box


def frame_of(page: Page) -> int:
    """Return the number of the frame on display."""
    return int(re.findall(r"frame (\d+)", page.locator("#clock").inner_text())[0])


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


def test_a_long_timeline_is_enlarged_and_its_labels_never_overlap(
    open_page: OpenPage, server: Running, library: Library
) -> None:
    clip = add_clip(server, *["circle"] * 17, name="long dive.mp4")
    page = open_page({"clip": clip, "language": library.language}, scene=False, size=(1024, 768))
    expect(page.locator(".take")).to_have_count(17)
    names = page.locator(".take-name")
    expect(names).to_have_count(17)
    cut = "(each) => each.filter((e) => e.offsetWidth > e.parentElement.clientWidth).length"
    assert names.evaluate_all(cut) == 0
    expect(page.get_by_role("button", name="Take 17,")).to_be_visible()
    track = page.locator(".track")
    width = box_of(track)["width"]
    ticks = page.locator(".ruler span")
    for _ in range(3):
        for labels in (page.locator(".take-name:visible"), page.locator(".salute"), ticks):
            sides = sorted(labels.evaluate_all(SIDES))
            assert all(one[1] <= other[0] + 0.5 for one, other in pairwise(sides)), labels
        page.get_by_role("button", name="Enlarge the timeline").click()
    assert box_of(track)["width"] == pytest.approx(8 * width, rel=0.01)
    named = "(name) => getComputedStyle(name, '::before').content"
    assert page.locator(".take-name").first.evaluate(named) == '"Take "'
    # The whole clip lies above in small, with the part in sight, which a press moves.
    whole, part = box_of(page.locator(".overview")), box_of(page.locator(".in-sight"))
    assert part["width"] == pytest.approx(whole["width"] / 8, abs=4)
    expect(page.locator(".overview i:not(.in-sight)")).to_have_count(
        page.locator(".track .take").count()
    )
    page.mouse.click(whole["x"] + whole["width"] - 4, whole["y"] + 5)
    assert (
        page.locator(".seen").evaluate("(e) => e.scrollLeft + e.clientWidth - e.scrollWidth") > -2
    )
    page.mouse.click(whole["x"] + 4, whole["y"] + 5)
    assert page.locator(".seen").evaluate("(e) => e.scrollLeft") < 2
    page.mouse.click(whole["x"] + part["x"] - whole["x"] + part["width"] / 2, whole["y"] + 5)
    # The moment on display stays in sight, and the one under the pointer where it is.
    expect(page.locator("#now")).to_be_in_viewport()
    seen = box_of(page.locator(".seen"))
    third = page.get_by_role("button", name=re.compile("^Take 3,"))
    third.scroll_into_view_if_needed()
    before = box_of(third)
    page.mouse.move(before["x"] + before["width"] / 2, seen["y"] + 20)
    page.keyboard.down("Control")
    page.mouse.wheel(0, -200)
    page.keyboard.up("Control")
    after = box_of(third)
    assert after["width"] == pytest.approx(2 * before["width"], rel=0.02)
    assert after["x"] + after["width"] / 2 == pytest.approx(
        before["x"] + before["width"] / 2, abs=3
    )
    for _ in range(5):
        page.keyboard.press("-")
    assert box_of(track)["width"] == pytest.approx(width, rel=0.01)


def test_ranges_are_labelled_while_the_clip_plays_and_saved_together(
    open_page: OpenPage, server: Running, library: Library
) -> None:
    clip = add_clip(server, *["circle"] * 5, name="long dive.mp4")
    page = open_page({"clip": clip, "language": library.language}, scene=False)
    expect(page.get_by_role("button", name=re.compile("^Take 1,"))).to_be_visible()
    expect(page.locator("#clock")).to_have_text(re.compile(r"frame [1-9]\d* of 370"))
    page.get_by_label("Speed", exact=True).select_option("0.25")
    pause = page.get_by_role("button", name="Pause", exact=True)
    label = page.get_by_role("textbox", name="What this range shows")
    add = page.get_by_role("button", name="Add range")
    expect(label).to_be_hidden()
    page.locator("#clip-name").click()
    page.keyboard.press("Space")
    expect(pause).to_be_visible()
    with page.expect_response(re.compile("/view$")):
        page.keyboard.press("[")
    expect(label).to_be_visible()
    shown = frame_of(page)
    until(lambda: shown + 3 < frame_of(page))
    expect(pause).to_be_visible()
    page.keyboard.press("k")
    expect(page.get_by_role("button", name="Play", exact=True)).to_be_visible()
    for name in ("wave", "nod"):
        end = frame_of(page) + 60
        page.keyboard.press("[")
        for _ in range(6):
            page.keyboard.press("Shift+.")
        # The steps count, although the new range is shown after them.
        expect(page.locator("#clock")).to_contain_text(f"frame {end} of")
        page.keyboard.press("]")
        label.fill(name)
        label.press("Enter")
        page.locator("#clip-name").click()
        for _ in range(2):
            page.keyboard.press("Shift+.")
        expect(page.locator("#clock")).to_contain_text(f"frame {end + 20} of")
    bars = page.locator("#labelled-ranges button")
    expect(bars).to_have_text(["wave", "nod"])
    page.reload()
    expect(bars).to_have_text(["wave", "nod"])
    # A press takes one out, to be changed or dropped.
    bars.first.click()
    expect(bars).to_have_text(["nod"])
    expect(label).to_have_value("wave")
    label.fill("hello")
    add.click()
    page.get_by_role("button", name="Save 2 gestures").click()
    cards = page.get_by_role("list", name="Gestures").get_by_role("listitem")
    expect(cards).to_have_count(4)
    expect(bars).to_have_count(0)
    # Labels that the language has are takes to test.
    label.fill("hello")
    add.click()
    page.get_by_role("button", name="Keep 1 range as tests").click()
    expect(page.get_by_text("In the test set")).to_be_visible()
    kept = library.client.get(f"/api/v1/languages/{library.language}/test-set").json()
    assert [take["expected"] for take in kept["takes"]] == ["hello"]
