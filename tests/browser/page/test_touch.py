"""The page under fingers: on a phone and a tablet, with targets for a wet thumb."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, FloatRect, Locator, Page, ViewportSize, expect

from tests.api.running import Running, client_of
from tests.browser.conftest import WITHOUT_SCENE, new_context
from tests.browser.library import Library, library_of

PHONE, TABLET = ViewportSize(width=390, height=844), ViewportSize(width=1024, height=768)

LEAST = 44
"""Pixels: the height of a target that a thumb hits (WCAG 2.5.5)."""

SMALL = """(least) => [...document.querySelectorAll("button, a[href], select, summary, input")]
  .filter((e) => !e.matches(".skip, .take, input:is(.handle, [type=checkbox], [type=radio])"))
  .filter((e) => e.checkVisibility())
  .filter((e) => e.getBoundingClientRect().width > 1)
  .filter((e) => Math.round(e.getBoundingClientRect().height) < least)
  .map((e) => e.outerHTML.slice(0, 120))"""
"""Targets that are too low; takes are as large as their timeline."""

CUT = """(select) => {
  const ruler = document.createElement("canvas").getContext("2d");
  ruler.font = getComputedStyle(select).font;
  const arrow = 28;
  return ruler.measureText(select.selectedOptions[0].label).width + arrow - select.clientWidth;
}"""
"""By how many pixels the chosen name is too long for its field."""


@pytest.fixture(scope="module")
def library(server: Running) -> Iterator[Library]:
    with client_of(server.address) as client:
        yield library_of(server, client, "Table 2: our signs")


@pytest.fixture(scope="module")
def touched(browser: Browser, server: Running, library: Library) -> Iterator[Page]:
    """Return a page under fingers with a clip and its answer; each test leaves it in Studio."""
    context = new_context(browser, viewport=PHONE, has_touch=True, is_mobile=True)
    context.add_init_script("localStorage.setItem('osg-studio.tour', 'seen')")
    context.add_cookies([{"name": WITHOUT_SCENE, "value": "1", "url": server.address}])
    page = context.new_page()
    answer = library.recognise("line")
    page.goto(
        f"{server.address}/?clip={library.clip}&language={library.language}&recognition={answer}"
    )
    expect(page.get_by_role("region", name="Why")).to_contain_text("'line'")
    yield page
    context.close()


def box_of(element: Locator) -> FloatRect:
    expect(element).to_be_visible()
    box = element.bounding_box()
    assert box is not None
    return box


def end_of(tabs: Locator) -> bytes:
    """Return the picture of the last few pixels of the row of views."""
    box = box_of(tabs)
    end = FloatRect(x=box["x"] + box["width"] - 4, y=box["y"] + 2, width=4, height=6)
    return tabs.page.screenshot(clip=end)


def test_the_picker_shows_a_name_and_the_views_a_shade_where_more_follow(touched: Page) -> None:
    assert touched.get_by_label("Language", exact=True).evaluate(CUT) <= 0
    tabs = touched.get_by_role("navigation", name="Views")
    shaded = end_of(tabs)
    tabs.evaluate("(row) => { row.scrollLeft = row.scrollWidth; }")
    expect(tabs.get_by_role("link", name="Live")).to_be_in_viewport(ratio=0.9)
    assert end_of(tabs) != shaded
    studio = touched.url
    touched.goto(f"{studio}&view=live")
    expect(tabs.get_by_role("link", name="Live")).to_be_in_viewport(ratio=0.9)
    touched.goto(studio)
    expect(touched.get_by_role("region", name="Why")).to_contain_text("'line'")


def test_the_answer_follows_the_picture(touched: Page) -> None:
    expect(touched.get_by_role("img", name="Trajectory image: this take")).to_be_visible()
    parts = (
        "#lab-box",
        "#outcome",
        ".why-sentence",
        "#timeline",
        ".vote-images",
        ".vote-table",
    )
    tops = [box_of(touched.locator(part).first)["y"] for part in parts]
    assert tops == sorted(tops)
    assert touched.evaluate("document.documentElement.scrollWidth") <= PHONE["width"]
    touched.get_by_role("button", name="New language").click()
    dialog = touched.get_by_role("dialog", name="New language")
    expect(dialog).to_be_visible()
    assert dialog.evaluate("(box) => box.scrollWidth <= box.clientWidth")
    touched.keyboard.press("Escape")
    expect(dialog).to_be_hidden()


def test_every_target_is_high_enough_for_a_thumb(touched: Page, library: Library) -> None:
    test_set = f"/api/v1/languages/{library.language}/test-set"
    take = {"clip_id": library.clip, "expected": "line"}
    library.client.post(test_set, json={"takes": [take]}).raise_for_status()
    library.client.post(f"{test_set}/run").raise_for_status()
    small = {"studio": touched.evaluate(SMALL, LEAST)}
    tabs = touched.get_by_role("navigation", name="Views").get_by_role("link")
    for name in ("Languages", "Phrases", "Health", "Practice", "Live"):
        tabs.get_by_text(name, exact=True).click()
        expect(touched.locator(".view:visible").locator("button, a").first).to_be_visible()
        small[name] = touched.evaluate(SMALL, LEAST)
    assert {name: found for name, found in small.items() if found} == {}
    tabs.get_by_text("Studio", exact=True).click()


def test_two_fingers_enlarge_the_picture_alone_and_one_moves_it(touched: Page) -> None:
    picture = touched.locator("#lab-box")
    before = box_of(picture)
    middle = (before["x"] + before["width"] / 2, before["y"] + before["height"] / 2)
    fingers = touched.context.new_cdp_session(touched)

    def put(kind: str, *places: tuple[float, float]) -> None:
        points = [{"x": x, "y": y, "id": number} for number, (x, y) in enumerate(places)]
        fingers.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    def apart(by: float) -> list[tuple[float, float]]:
        return [(middle[0] - by, middle[1]), (middle[0] + by, middle[1])]

    put("touchStart", *apart(30))
    for by in (40, 60, 90):
        put("touchMove", *apart(by))
    put("touchEnd")
    enlarged = box_of(picture)
    assert enlarged["width"] > 1.8 * before["width"]
    # What lay between the fingers lies there still.
    assert enlarged["x"] + enlarged["width"] / 2 == pytest.approx(middle[0], abs=3)
    assert touched.evaluate("visualViewport.scale") == 1
    put("touchStart", middle)
    for by in (10, 30, 50):
        put("touchMove", (middle[0] + by, middle[1]))
    put("touchEnd")
    assert box_of(picture)["x"] > enlarged["x"] + 10
    put("touchStart", *apart(90))
    for by in (60, 30, 10):
        put("touchMove", *apart(by))
    put("touchEnd")
    assert box_of(picture) == pytest.approx(before)


def test_on_a_tablet_the_bars_take_a_third_of_the_height_and_buttons_lie_beside_drawings(
    touched: Page,
) -> None:
    touched.set_viewport_size(TABLET)
    picture = box_of(touched.locator("#lab-area"))
    assert picture["height"] >= 2 / 3 * TABLET["height"]
    assert picture["y"] + picture["height"] <= TABLET["height"]
    expect(touched.get_by_role("button", name="Take 1,")).to_be_in_viewport(ratio=1)
    expect(touched.get_by_role("button", name="Recognise", exact=True)).to_be_in_viewport(ratio=1)
    card = touched.get_by_role("list", name="Gestures").get_by_role("listitem").first
    drawing = box_of(card.get_by_role("img"))
    for name in ("Change circle", "Delete circle"):
        button = card.get_by_role("button", name=name)
        expect(button).to_be_visible()
        assert box_of(button)["y"] >= drawing["y"] + drawing["height"]
