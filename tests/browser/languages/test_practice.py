"""Practice: a diver shows gestures by clips, is told what to change, and has a record."""

from __future__ import annotations

from playwright.sync_api import expect

from tests.api.running import Running
from tests.browser.accessibility import faults
from tests.browser.conftest import OpenPage
from tests.browser.library import Library, add_clip


def test_takes_are_judged_and_counted_towards_acceptance(
    open_page: OpenPage, server: Running, library: Library
) -> None:
    add_clip(server, "circle", name="my circle.mp4")
    add_clip(server, "line", name="a mistake.mp4")
    page = open_page({"view": "practice", "language": library.language}, scene=False)
    show = page.get_by_role("button", name="Show it by this clip")
    expect(page.get_by_text("Name the diver")).to_be_visible()
    expect(show).to_be_disabled()
    page.get_by_label("Diver").fill("Ana")
    page.get_by_label("Clip", exact=True).select_option(label="my circle.mp4")
    expect(page.get_by_label("Gesture to show")).to_have_value("circle")
    show.press("Enter")
    expect(page.locator(".practice-right")).to_have_text("✓ Right: circle")
    record = page.get_by_role("region", name="Ana")
    expect(record).to_contain_text("0 errors in 1 take: 58 more takes without an error")

    page.get_by_label("Clip", exact=True).select_option(label="a mistake.mp4")
    show.click()
    expect(record).to_contain_text("1 error in 2 takes")
    assert faults(page) == []
    page.set_viewport_size({"width": 390, "height": 844})
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    record.get_by_text("2 takes", exact=True).click()
    record.get_by_role("button", name="Remove this take of circle").first.click()
    expect(record).to_contain_text("0 errors in 1 take")
    record.get_by_role("link", name="my circle.mp4").click()
    expect(page.locator("#outcome")).to_contain_text("as expected")


def test_a_take_between_two_gestures_is_a_question_and_no_error(
    open_page: OpenPage, server: Running, library: Library
) -> None:
    library.add_gesture("ring")
    add_clip(server, "circle", name="my circle.mp4")
    page = open_page({"view": "practice", "language": library.language}, scene=False)
    page.get_by_label("Diver").fill("Ana")
    page.get_by_label("Clip", exact=True).select_option(label="my circle.mp4")
    page.get_by_label("Gesture to show").select_option("circle")
    page.get_by_role("button", name="Show it by this clip").click()
    answer = page.locator(".practice-asked")
    expect(answer).to_contain_text("? circle or ring? 'circle' and 'ring' are nearly alike.")
    record = page.get_by_role("region", name="Ana")
    expect(record).to_contain_text("0 errors in 0 takes")
    expect(record).to_contain_text("1 take asked back with the right gesture")
    record.get_by_text("1 take", exact=True).click()
    expect(record).to_contain_text("asked back: circle or ring?")
    assert faults(page) == []
    record.get_by_role("link", name="my circle.mp4").click()
    expect(page.locator("#outcome.asked")).to_contain_text("circle or ring?, expected circle")
