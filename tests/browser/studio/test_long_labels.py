"""Labels of eighty letters: nothing leaves the window, at a desk or on a phone."""

from __future__ import annotations

from playwright.sync_api import expect

from tests.api.running import Running, client_of
from tests.browser.conftest import OpenPage
from tests.browser.library import add_clip, library_of

LABEL = "Everybody" + "surface" * 10


def test_a_long_label_stays_in_the_window(open_page: OpenPage, server: Running) -> None:
    with client_of(server.address) as client:
        library = library_of(server, client, LABEL[:80])
        library.add_gesture(LABEL, add_clip(server, "corner", name="corner.mp4"))
    clip = add_clip(server, "corner", name="again.mp4")
    page = open_page(
        {"language": library.language, "clip": clip},
        scene=False,
        size=(1440, 900),
    )
    page.get_by_role("button", name="Recognise").click()
    outcome = page.locator("#outcome b").first
    expect(outcome).to_have_text(LABEL)
    meant = page.get_by_role("group", name="Gesture that was meant").get_by_text(LABEL)
    for width in (1440, 390):
        page.set_viewport_size({"width": width, "height": 900})
        for element in (outcome, meant, page.locator("#expected")):
            expect(element).to_be_visible()
            box = element.bounding_box()
            assert box is not None
            assert box["x"] >= 0
            assert box["x"] + box["width"] <= width
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
