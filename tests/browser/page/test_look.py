"""The look of the page: wide and narrow, dark and light, and usable by keyboard alone."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import pytest
from playwright.sync_api import Page, expect

from tests.api.running import Running, client_of
from tests.browser.conftest import OpenPage
from tests.browser.library import Library, add_clip, library_of


@pytest.fixture(scope="module")
def library(server: Running) -> Iterator[Library]:
    with client_of(server.address) as client:
        yield library_of(server, client, "a name as long as those that cameras give to their files")


def test_everything_is_in_reach_on_a_phone(open_page: OpenPage, library: Library) -> None:
    query = {**library.address, "recognition": library.recognise("circle")}
    page = open_page(query, size=(390, 844), scene=False)
    expect(page.get_by_role("button", name="Play", exact=True)).to_be_visible()
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    for name in ("Record with the camera", "Save as gesture", "Recognise", "New language"):
        expect(page.get_by_role("button", name=name)).to_be_in_viewport()
    expect(page.locator("#outcome")).to_contain_text("as expected")
    # Clips and the place to drop them stand above the picture, and nothing lies over the flat one.
    for part in (page.locator(".drop label"), page.locator("#clips .chosen")):
        expect(part).to_be_in_viewport()
    picture = page.locator("#lab-box").bounding_box()
    clips = page.locator("#clips").bounding_box()
    assert picture is not None
    assert clips is not None
    assert clips["y"] + clips["height"] <= picture["y"]
    page.get_by_role("list", name="Gestures").scroll_into_view_if_needed()
    expect(page.get_by_role("button", name="Delete circle", exact=True)).to_be_in_viewport()
    page.get_by_role("button", name="Change circle", exact=True).click()
    expect(page.get_by_label("Start frame")).to_be_visible()
    assert page.evaluate("document.documentElement.scrollWidth") <= 390


def test_at_a_desk_one_button_stands_out_all_have_names_and_the_bar_has_room_for_them(
    open_page: OpenPage, server: Running, library: Library
) -> None:
    add_clip(server, "line", name="unused one.mp4")
    add_clip(server, "line", name="unused two.mp4")
    page = open_page(library.address, scene=False)
    expect(page.get_by_role("button", name="Export")).to_be_enabled()
    expect(page.get_by_role("button", name="Recognise", exact=True)).to_be_enabled()
    expect(page.locator("button.primary:visible")).to_have_text(["Recognise"])
    check_names_and_focus(page)
    # On a tablet too.
    for width in (768, 1024, 1180, 1280):
        page.set_viewport_size({"width": width, "height": 800})
        check_bar(page, width)


def check_bar(page: Page, width: int) -> None:
    """Check that the bar's controls lie beside or below each other, within the window."""
    picker = page.get_by_label("Language", exact=True).bounding_box()
    assert picker is not None
    assert picker["width"] >= 160
    parts = [part.bounding_box() for part in page.locator(".bar button:visible, .bar select").all()]
    boxes = [box for box in parts if box is not None]
    assert max(box["x"] + box["width"] for box in boxes) <= width
    for one, other in combinations(boxes, 2):
        across = min(each["x"] + each["width"] for each in (one, other))
        down = min(each["y"] + each["height"] for each in (one, other))
        is_beside = across <= max(one["x"], other["x"]) + 1
        assert is_beside or down <= max(one["y"], other["y"]) + 1


COVERED = """(box) => {
  const { left, right, top, bottom } = box.getBoundingClientRect();
  const seen = Math.min(bottom, innerHeight);
  return [[left, top], [right, top], [left, seen], [right, seen], [left + right, top + seen]]
    .map(([x, y], i) => i < 4
      ? [x + (i % 2 ? -4 : 4), y + (i < 2 ? 4 : -4)] : [x / 2, y / 2])
    .filter(([x, y]) => !box.contains(document.elementFromPoint(x, y)));
}"""
"""The covered points among the corners and the middle of the visible part of a box."""


def test_the_picture_of_a_chosen_clip_is_in_sight_on_a_phone(
    open_page: OpenPage, server: Running, library: Library
) -> None:
    # Enough clips to show the search, of another aspect ratio than the one on display.
    for number in range(5):
        add_clip(server, "line", name=f"dive {number}.mp4")
    page = open_page(library.address, size=(390, 844), scene=False)
    check_picture(page, "dive 2.mp4")
    page.keyboard.press("Shift+L")
    expect(page.locator("html")).to_have_attribute("data-look", "sun")
    check_picture(page, "dive 3.mp4")


def check_picture(page: Page, clip: str) -> None:
    """Choose a clip, and check that its picture is in sight and its timeline below it."""
    expect(page.get_by_role("button", name="Read all takes")).to_be_visible()
    expect(page.get_by_label("Find clips")).to_be_visible()
    page.get_by_role("button", name=f"Show {clip}").click()
    expect(page.get_by_role("heading", name=clip)).to_be_in_viewport()
    picture = page.locator("#lab-box")
    box = picture.bounding_box()
    assert box is not None
    assert 0 < box["y"] <= 844 - 200
    assert box["width"] == 390
    assert picture.evaluate(COVERED) == []
    assert page.evaluate("scrollY") == 0
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    # The take, the heart of the clip's controls, is below it.
    timeline = page.locator("#timeline")
    expect(timeline).to_be_visible()
    place = timeline.bounding_box()
    assert place is not None
    assert place["y"] >= box["y"] + box["height"]


def test_colours_follow_the_system_in_the_page_and_in_the_frame(
    open_page: OpenPage, library: Library
) -> None:
    page = open_page(library.address, size=(1440, 900), scheme="light")
    scheme = page.frame_locator("#lab").locator("html")
    expect(scheme).to_have_attribute("data-mantine-color-scheme", "light")
    bodies = page.locator("body"), page.frame_locator("#lab").locator("body")
    light = [body.evaluate("(body) => getComputedStyle(body).backgroundColor") for body in bodies]
    page.emulate_media(color_scheme="dark")
    expect(scheme).to_have_attribute("data-mantine-color-scheme", "dark")
    for body, colour in zip(bodies, light, strict=True):
        expect(body).not_to_have_css("background-color", colour)


def check_names_and_focus(page: Page) -> None:
    """Check that every control has a name and shows the focus."""
    nameless = page.evaluate(
        """() => [...document.querySelectorAll("button, select, input, a, summary, iframe, img")]
          .filter((e) => e.checkVisibility() && !(e.tagName === "IMG" && e.alt === ""))
          .filter((e) => !(e.getAttribute("aria-label") || e.title || e.alt || e.labels?.length
                           || e.textContent.trim()))
          .map((e) => e.outerHTML)"""
    )
    assert nameless == []
    seen = set()
    for _ in range(20):
        page.keyboard.press("Tab")
        focused = page.evaluate(
            """() => {
              const e = document.activeElement;
              const shown = e.matches("input[type=file]") ? e.nextElementSibling : e;
              const { outlineStyle, outlineWidth } = getComputedStyle(shown);
              return [e.id || e.getAttribute("aria-label") || e.textContent.trim(),
                      outlineStyle !== "none" && parseFloat(outlineWidth) >= 2];
            }"""
        )
        seen.add(focused[0])
        assert focused[1], f"no visible focus on {focused[0]!r}"
    assert {"language", "new-language", "file"} <= seen


def test_what_to_do_before_the_camera_has_a_line_of_its_own(
    open_page: OpenPage, library: Library
) -> None:
    page = open_page(library.address | {"view": "live"}, scene=False)
    expect(page.get_by_role("img", name="Hand in a Vulcan salute")).to_be_visible()
    for width in (768, 1024):
        page.set_viewport_size({"width": width, "height": 800})
        boxes = [page.locator(each).bounding_box() for each in ("#live-instruction", "#live-meter")]
        words, meter = (box for box in boxes if box is not None)
        assert words["y"] >= meter["y"] + meter["height"]
        assert words["height"] < 60


def test_the_library_is_made_wider_by_mouse_and_keys_and_stays_so(
    open_page: OpenPage, library: Library
) -> None:
    page = open_page(library.address, scene=False)
    divider = page.get_by_role("separator", name="Width of the library")

    def width() -> float:
        box = page.get_by_role("complementary", name="Library").bounding_box()
        assert box is not None
        return box["width"]

    assert width() == 316
    page.mouse.move(316, 400)
    page.mouse.down()
    page.mouse.move(420, 400)
    page.mouse.up()
    assert width() == 420
    divider.press("ArrowLeft")
    assert width() == 400
    expect(divider).to_have_attribute("aria-valuenow", "400")
    page.reload()
    expect(divider).to_have_attribute("aria-valuenow", "400")
    assert width() == 400
    divider.dblclick()
    assert width() == 316
