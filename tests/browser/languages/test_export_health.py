"""The export says what the health check says of the language."""

from __future__ import annotations

import httpx
from playwright.sync_api import expect

from tests.api.running import Running
from tests.browser.conftest import OpenPage
from tests.browser.library import add_clip, library_of


def test_the_export_names_the_errors_of_health_and_leads_to_them(
    open_page: OpenPage, server: Running, client: httpx.Client
) -> None:
    library = library_of(server, client, "to send")
    page = open_page(library.address, scene=False)
    page.get_by_role("button", name="Export").click()
    dialog = page.get_by_role("dialog", name="Export")
    expect(dialog).to_contain_text("Health: no errors, no gesture tested.")
    page.keyboard.press("Escape")
    # The same movement under two labels cannot be told apart.
    library.add_gesture("ring", add_clip(server, "circle", name="ring.mp4"))
    found = client.get(f"/api/v1/languages/{library.language}/check", timeout=60).json()
    errors = sum(each["error"] for each in found["warnings"])
    assert errors > 0
    expect(page.get_by_role("list", name="Gestures").get_by_role("listitem")).to_have_count(3)
    page.get_by_role("button", name="Export").click()
    expect(dialog).to_contain_text(f"Health: {errors} error")
    dialog.get_by_role("button", name="See health").click()
    expect(dialog).to_be_hidden()
    expect(page.locator(".verdict")).to_contain_text(f"{errors} error")
