"""Phrases in the browser: made in a form, checked as they change, tried by clicking gestures."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from tests.api.running import Running, client_of
from tests.browser.accessibility import SCHEMES, faults
from tests.browser.conftest import OpenPage
from tests.browser.library import Library, library_of


@pytest.fixture(scope="module")
def library(server: Running) -> Iterator[Library]:
    with client_of(server.address) as client:
        yield library_of(server, client, "phrasing")


def sample(library: Library) -> dict[str, str]:
    """Return the address of a copy of the sample language with phrases."""
    listed = library.client.get("/api/v1/languages").json()
    (original,) = [each["id"] for each in listed if each["name"] == "Table 2: eight signs"]
    copy = library.client.post(f"/api/v1/languages/{original}/duplicate").json()
    library.client.patch(f"/api/v1/languages/{copy['id']}", json={"name": "Missions"})
    return {"view": "phrases", "language": copy["id"]}


def grammar_of(library: Library, query: dict[str, str]) -> dict[str, object]:
    language = library.client.get(f"/api/v1/languages/{query['language']}").json()
    grammar: dict[str, object] = language["grammar"]
    return grammar


def test_a_phrase_is_tried_by_clicking_what_may_come_next(
    open_page: OpenPage, library: Library
) -> None:
    page = open_page(sample(library), scene=False)
    gestures = page.get_by_role("list", name="Gestures to show")
    for label in ("circle", "square", "three"):
        gestures.get_by_role("button", name=f"Show {label}, may come next").click()
        expect(page.get_by_role("list", name="Gestures shown")).to_contain_text(label)
    expect(page.locator("#said")).to_have_text("circle, square, three: then circle")
    gestures.get_by_role("button", name="Show circle, may come next").click()
    expect(page.locator("#said")).to_have_text("mission: align yourself, 3 times")
    expect(page.locator(".obeyed")).to_contain_text('{"do":"align","times":3}')
    assert faults(page) == []
    colleague = open_page(scene=False, alone=True)
    colleague.goto(page.url)
    expect(colleague.locator("#said")).to_have_text("mission: align yourself, 3 times")
    # The next gesture begins another message; one that was not recognised is asked for again.
    gestures.get_by_role("button", name="Show circle").click()
    page.get_by_role("button", name="Not recognised").click()
    expect(page.locator("#said")).to_contain_text("not recognised, show it again")
    gestures.get_by_role("button", name="Show three").click()
    expect(page.locator("#said")).to_contain_text("three does not follow circle")
    gestures.get_by_role("button", name="Show circle").click()
    page.get_by_role("button", name="Pause too long").click()
    expect(page.locator("#said")).to_contain_text("waited too long")


def test_a_pair_is_tried_and_asked_for_its_place(open_page: OpenPage, library: Library) -> None:
    page = open_page(sample(library), scene=False)
    gestures = page.get_by_role("list", name="Gestures to show")
    for label in ("circle", "square"):
        gestures.get_by_role("button", name=f"Show {label}, may come next").click()
    page.get_by_role("button", name="Between two").click()
    gestures.get_by_role("button", name="Show three, may come next").click()
    expect(page.get_by_role("button", name="three or \u2026?")).to_be_visible()
    gestures.get_by_role("button", name="Show square").click()
    said = page.locator(".said.asked")
    expect(said).to_have_text("? gesture 3: three or square? show it again Speak")
    expect(page.locator(".chip.asked")).to_have_text("three or square?")
    expect(page.get_by_role("button", name="Between two")).to_have_attribute(
        "aria-pressed", "false"
    )
    assert faults(page) == []
    for label in ("three", "circle"):
        gestures.get_by_role("button", name=f"Show {label}, may come next").click()
    expect(page.locator("#said")).to_have_text("mission: align yourself, 3 times")


def test_a_first_phrase_is_made_with_a_slot_and_tried(
    open_page: OpenPage, library: Library
) -> None:
    query = {"view": "phrases", "language": library.language}
    page = open_page(query, scene=False)
    page.get_by_role("button", name="Add the first phrase").click()
    name = page.get_by_label("Name", exact=True)
    expect(name).to_be_focused()
    name.fill("photo")
    name.press("Enter")
    expect(page.get_by_role("button", name="Try photo")).to_be_visible()
    page.get_by_label("Ends with").select_option("circle")
    page.get_by_label("Gesture", exact=True).select_option("line")
    page.get_by_role("button", name="Slot").click()
    slot = page.get_by_label("Name of the slot")
    slot.fill("times")
    page.get_by_label("Spoken back").fill("photo {times} times")
    page.get_by_label("Command for the robot").fill('{"do": "photo", "times": "{times}"}')
    page.get_by_label("Command for the robot").blur()
    expect(page.locator("#said")).to_be_visible()
    page.get_by_role("button", name="Try photo").click()
    expect(page.locator("#said")).to_contain_text("mission: photo 1 times")
    expect(page.locator(".obeyed")).to_contain_text('{"do":"photo","times":1}')
    # Undo takes back one step after the other, and redo does it again.
    page.locator("h1:visible").click()
    page.keyboard.press("Control+z")
    expect(page.get_by_label("Command for the robot")).to_have_value("")
    page.keyboard.press("Control+Shift+z")
    expect(page.get_by_label("Command for the robot")).not_to_have_value("")
    page.get_by_role("button", name="Delete photo").click()
    expect(page.get_by_text("No phrases yet")).to_be_visible()
    page.get_by_role("button", name="Undo").click()
    expect(page.get_by_role("button", name="Try photo")).to_be_visible()


def test_an_ambiguity_is_told_at_once_and_can_be_tried(
    open_page: OpenPage, library: Library
) -> None:
    query = sample(library)
    page = open_page(query, scene=False)
    expect(page.get_by_text("Nothing ambiguous")).to_be_visible()
    page.get_by_label("Ends with").select_option("")
    ambiguities = page.get_by_role("list", name="Ambiguities")
    expect(ambiguities).to_contain_text("the message is complete, but may continue")
    expect(page.get_by_text("4 ambiguities")).to_be_visible()
    assert faults(page) == []
    ambiguities.get_by_role("button", name="Try: circle, square").first.click()
    expect(page.get_by_text("The message may be over")).to_be_visible()
    page.get_by_role("button", name="Pause too long").click()
    expect(page.locator("#said")).to_have_text("mission: align yourself")
    page.get_by_label("Ends with").select_option("circle")
    expect(ambiguities).to_have_count(0)


def test_parts_are_moved_made_optional_and_taken_out(open_page: OpenPage, library: Library) -> None:
    query = sample(library)
    page = open_page({**query, "phrase": "survey"}, scene=False)
    page.get_by_role("button", name="Move slot 2 up").click()
    expect(page.get_by_role("button", name="Move slot 1 down")).to_be_visible()
    page.locator("#part-0-optional").click()
    # The spoken text needs the slot's value: making it optional is refused, and the form shows the
    # saved state.
    refused = page.get_by_role("alert").filter(has_text="Changing the phrases failed")
    expect(refused).to_have_count(1)
    expect(page.locator("#part-0-optional")).not_to_be_checked()
    refused.get_by_role("button", name="Dismiss").click()
    expect(refused).to_have_count(0)
    page.get_by_role("button", name="Delete group 3").click()
    expect(refused).to_have_count(1)
    page.get_by_label("Spoken back").fill("survey[ {metres} metres]")
    page.get_by_label("Command for the robot").fill('{"do": "survey"}')
    page.get_by_label("Command for the robot").blur()
    page.get_by_role("button", name="Delete group 3").click()
    expect(page.get_by_role("list", name="Parts of the group")).to_have_count(0)
    page.locator("#part-0-optional").click()
    expect(page.locator("#part-0-default")).to_be_visible()
    assert grammar_of(library, query)["phrases"][4]["parts"][0]["least"] == 0  # type: ignore[index]


def test_a_gesture_of_a_phrase_is_renamed_with_it_and_not_deleted(
    open_page: OpenPage, library: Library
) -> None:
    query = sample(library)
    page = open_page({**query, "view": "studio"}, scene=False)
    page.get_by_role("button", name="Delete sweep", exact=True).click()
    refused = page.get_by_text("needed by the phrase 'come here'")
    expect(refused).to_be_visible()
    expect(refused).to_have_text(re.compile("^'sweep' cannot be removed"))
    place = f"/api/v1/languages/{query['language']}/gestures/sweep"
    library.client.patch(place, json={"label": "beckon"})
    page.get_by_role("link", name="Phrases").click()
    expect(page.locator(".phrase").first).to_contain_text("beckon")


def test_the_open_form_is_accessible_and_fits_a_phone(
    open_page: OpenPage, library: Library, picture: Callable[[Page, str], Path]
) -> None:
    query = {**sample(library), "phrase": "survey", "shown": "circle\nwedge\nthree"}
    page = open_page(query, scene=False, size=(1280, 1000))
    expect(page.locator("#said")).to_contain_text("then circle or square")
    page.locator(".try-gesture img").last.evaluate("(image) => image.decode()")
    picture(page, "phrases")
    for width, height in ((1280, 1000), (390, 844)):
        page.set_viewport_size({"width": width, "height": height})
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        for scheme in SCHEMES:
            page.emulate_media(color_scheme=scheme)
            assert faults(page) == []
