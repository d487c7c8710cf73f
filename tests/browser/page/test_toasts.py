"""Toasts: messages cover no control that is used next."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from playwright.sync_api import expect

from tests.api.running import Running, client_of
from tests.browser.accessibility import faults
from tests.browser.conftest import OpenPage
from tests.browser.library import Library, library_of


@pytest.fixture
def library(server: Running) -> Iterator[Library]:
    with client_of(server.address) as client:
        yield library_of(server, client, "messages")


# A message under the pointer stays, however long a loaded machine examines the page.
SHOW = """
import(document.scripts[0].src.replace("main.js", "core/toasts.js")).then(({ toast }) =>
  ["One", "Two"].forEach((title) => toast(title, "A sentence that says what is next.",
    { kind: "error" }).dispatchEvent(new Event("pointerenter"))))
"""

OFFER = """
import(document.scripts[0].src.replace("main.js", "core/toasts.js")).then(({ toast }) => {
  toast("Told");
  toast("Offered", "", { action: { label: "Undo", run: () => {} } });
})
"""

REACHED = """
(button) => {
  button.scrollIntoView({ block: "nearest" });
  const { left, top, width, height } = button.getBoundingClientRect();
  const found = document.elementFromPoint(left + width / 2, top + height / 2);
  return button.contains(found) || String(found?.outerHTML).slice(0, 100);
}
"""


SIZES = ((1280, 800), (390, 844))


def test_every_gesture_can_be_pressed_while_messages_are_shown(
    open_page: OpenPage, library: Library
) -> None:
    for index in range(6):
        library.add_gesture(f"more {index}")
    page = open_page(library.address, scene=False)
    cards = page.locator("#gestures button:visible")
    expect(page.locator("#gestures > li")).to_have_count(8)
    # Until the clip is shown, its buttons are disabled: what scrolls then has nothing to focus.
    expect(page.get_by_role("button", name="Recognise")).to_be_enabled()
    page.evaluate(SHOW)
    expect(page.locator(".toast")).to_have_count(2)
    for width, height in SIZES:
        page.set_viewport_size({"width": width, "height": height})
        # A phone shows one at a time, the newest.
        expect(page.locator(".toast:visible")).to_have_count(1 if width < 720 else 2)
        assert faults(page) == []
        for card in cards.all():
            assert card.evaluate(REACHED) is True
        assert page.evaluate("document.documentElement.scrollWidth") <= width
    # Other views reach below the messages, and can be scrolled past them.
    page.get_by_role("navigation", name="Views").get_by_role("link", name="Languages").click()
    view = page.locator(".view.languages")
    expect(view.get_by_role("link", name="messages").first).to_be_visible()
    for width, height in SIZES:
        page.set_viewport_size({"width": width, "height": height})
        assert view.evaluate("(each) => each.getBoundingClientRect().bottom") >= height - 1
    for _ in range(2):
        page.get_by_role("button", name="Dismiss").last.click()
    # Without a message nothing is reserved.
    expect(page.locator("html")).to_have_attribute("style", "--toasts: 0px;")


def test_a_message_that_offers_undo_stays_longer_than_one_that_only_tells(
    open_page: OpenPage, library: Library
) -> None:
    page = open_page(library.address, scene=False)
    page.clock.install()
    page.evaluate(OFFER)
    messages = page.locator(".toast")
    expect(messages).to_have_count(2)
    page.clock.run_for(12_000)
    expect(messages.locator("b")).to_have_text(["Offered"])
    page.clock.run_for(6_000)
    expect(messages).to_have_count(0)
