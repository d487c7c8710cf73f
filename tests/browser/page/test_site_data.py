"""A browser that keeps nothing for the page: the page works, and remembers for the visit."""

from __future__ import annotations

from pathlib import Path

from playwright.sync_api import Browser, expect

from tests.api.running import Running
from tests.browser.conftest import new_context
from tests.browser.files import drop
from tests.keypoint_files.files import write_named
from tests.recognition.strategies import circle, recording

REFUSED = """for (const name of ['localStorage', 'sessionStorage', 'indexedDB'])
  Object.defineProperty(window, name, {
    get() { throw new DOMException('refused', 'SecurityError'); } });"""
"""Stores that are absent or full are tested without a page."""


def test_the_page_works_where_the_browser_keeps_no_site_data(
    browser: Browser, server: Running, tmp_path: Path
) -> None:
    context, errors = new_context(browser), list[str]()
    context.add_init_script(REFUSED)
    page = context.new_page()
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.route("**/viser/**", lambda route: route.fulfill(body=""))
    page.goto(server.address)
    expect(page.locator("#connection")).to_have_text("Connected")
    views = page.locator("#views a, #views button")
    expect(views).to_have_count(6)
    page.keyboard.press("Escape")  # ends the tour
    file = write_named(tmp_path / "circle.csv", recording(circle, frames=20))
    drop(page, file)
    expect(page.get_by_role("button", name=f"Delete {file.name}")).to_be_visible()
    for view in range(6):
        views.nth(view).click()
    page.get_by_role("button", name="Readable in the sun").click()
    expect(page.locator("html")).to_have_attribute("data-look", "sun")
    assert errors == []
    context.close()
