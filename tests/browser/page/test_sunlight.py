"""The look for direct sunlight: high contrast, large targets, kept over a reload."""

from __future__ import annotations

from playwright.sync_api import expect

from tests.browser.accessibility import faults
from tests.browser.conftest import OpenPage
from tests.browser.library import Library

SMALL = """() => [...document.querySelectorAll("button, select, summary, a.button")]
  .filter((each) => each.checkVisibility() && !each.closest("#transport, .timeline"))
  .map((each) => [each.getBoundingClientRect().height, each.outerHTML.slice(0, 80)])
  .filter(([height]) => height > 0 && height < 44)"""


COVERED = """() => [...document.querySelectorAll(".bar :is(button, select, .brand)")]
  .filter((each) => each.checkVisibility())
  .filter((each) => {
    const { left, right, top, height } = each.getBoundingClientRect();
    return [left + 3, (left + right) / 2, right - 3]
      .some((x) => !each.contains(document.elementFromPoint(x, top + height / 2)));
  })
  .map((each) => each.outerHTML.slice(0, 80))"""
"""Controls of the bar that are covered or outside the window."""


def test_targets_are_large_and_contrast_is_high(open_page: OpenPage, library: Library) -> None:
    page = open_page(library.address, scene=False)
    button = page.get_by_role("button", name="Readable in the sun")
    button.click()
    expect(button).to_have_attribute("aria-pressed", "true")
    expect(page.locator("body")).to_have_css("color", "rgb(0, 0, 0)")
    page.reload()
    expect(page.get_by_role("button", name="1 demonstration of circle")).to_be_visible()
    expect(page.locator("body")).to_have_css("background-color", "rgb(255, 255, 255)")
    expect(page.locator("#timeline")).to_be_visible()
    for width, height in ((1280, 800), (390, 844)):
        page.set_viewport_size({"width": width, "height": height})
        assert page.evaluate(SMALL) == []
        assert page.evaluate(COVERED) == []
        assert faults(page) == []
        assert page.evaluate("document.documentElement.scrollWidth") <= width
    page.keyboard.press("Shift+L")
    expect(button).to_have_attribute("aria-pressed", "false")
