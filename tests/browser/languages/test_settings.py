"""The settings of a language: the default, what is changed, and the way back."""

from __future__ import annotations

from playwright.sync_api import expect

from tests.browser.accessibility import faults
from tests.browser.conftest import OpenPage
from tests.browser.library import Library


def test_profile_and_weights_are_changed_undone_and_reset(
    open_page: OpenPage, library: Library
) -> None:
    place = f"/api/v1/languages/{library.language}"
    page = open_page(library.address, scene=False)
    page.get_by_role("button", name="Settings", exact=True).click()
    dialog = page.get_by_role("dialog", name="How this language is recognised")
    expect(dialog).to_contain_text("Everything is as by default")
    save = dialog.get_by_role("button", name="Save")
    reset = dialog.get_by_role("button", name="Reset to the default")
    expect(save).to_be_disabled()
    expect(reset).to_be_disabled()
    dialog.get_by_role("radio", name="paper").check()
    dialog.get_by_label("Weight factor of aspect ratio").select_option("2")
    expect(dialog).to_contain_text("2 settings differ from the default")
    assert faults(page) == []
    save.click()
    expect(dialog).to_be_hidden()
    saved = library.client.get(place).json()
    assert (saved["profile"], saved["tuning"]["weights"]) == ("paper", {"aspect_ratio": 2.0})
    page.keyboard.press("Control+z")
    expect(page.locator("#tuning")).to_be_hidden()
    page.keyboard.press("Control+Shift+Z")
    expect(page.locator("#tuning")).to_be_visible()

    page.get_by_role("button", name="Settings", exact=True).click()
    expect(dialog).to_contain_text("2 settings differ")
    reset.click()
    expect(dialog).to_contain_text("Everything is as by default")
    save.click()
    expect(dialog).to_be_hidden()
    saved = library.client.get(place).json()
    assert (saved["profile"], saved["tuning"]) == ("full", None)

    page.set_viewport_size({"width": 390, "height": 560})
    page.get_by_role("button", name="Settings", exact=True).click()
    # The dialog is higher than the window, but its buttons are visible.
    assert dialog.evaluate("(each) => each.scrollHeight > each.clientHeight")
    expect(dialog.get_by_role("button", name="Save")).to_be_in_viewport(ratio=0.99)
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
