"""The library of languages: cards, history, two tabs on one language, and the tour."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

import pytest
from playwright.sync_api import Locator, Page, expect

from app.recognition import Language
from tests.api.running import Running, client_of, until
from tests.browser.conftest import OpenPage
from tests.browser.files import drop
from tests.browser.library import Library


@pytest.fixture
def name(library: Library) -> str:
    return str(library.client.get(f"/api/v1/languages/{library.language}").json()["name"])


def card(page: Page, name: str) -> Locator:
    cards = page.get_by_role("list", name="Languages", exact=True)
    return cards.locator(":scope > li").filter(has=page.get_by_role("link", name=name, exact=True))


def command(page: Page, name: str, text: str) -> None:
    page.get_by_label(f"What to do with {name}", exact=True).click()
    item = card(page, name).get_by_role("button", name=text)
    # A click would scroll it into view.
    expect(item).to_be_in_viewport()
    item.click()


def test_a_language_is_renamed_duplicated_and_deleted_and_all_is_taken_back(
    open_page: OpenPage, name: str
) -> None:
    page = open_page({"view": "languages"}, scene=False)
    expect(card(page, name).get_by_text("2 gestures")).to_be_visible()
    command(page, name, "Rename")
    page.get_by_label("Name", exact=True).fill("the reef")
    page.get_by_label("Author").fill("Ada")
    page.get_by_role("button", name="Save").click()
    expect(card(page, "the reef").get_by_text("Rename to the reef")).to_be_visible()
    command(page, "the reef", "Duplicate")
    expect(card(page, "the reef (copy)").get_by_text("in use")).to_be_visible()
    command(page, "the reef", "Delete")
    expect(card(page, "the reef")).to_have_count(0)
    toast = page.get_by_role("status").filter(has_text="Language deleted")
    toast.get_by_role("button", name="Undo").click()
    expect(page.get_by_text("Deletion of the reef", exact=True)).to_be_visible()
    expect(card(page, "the reef")).to_have_count(1)
    page.keyboard.press("Control+z")
    expect(page.get_by_text("Copy of the reef", exact=True)).to_be_visible()
    expect(card(page, "the reef (copy)")).to_have_count(0)
    page.keyboard.press("Control+z")
    expect(card(page, name)).to_have_count(1)


def test_a_language_that_is_exported_and_dropped_again_is_the_same_and_undo_takes_it_away(
    open_page: OpenPage, library: Library, tmp_path: Path
) -> None:
    name = "Zeichen für Höhlen, 2. Fassung ✋"
    tuning = {"simplification": 2.5, "weights": {"velocity": 0.5}}
    change = {"name": name, "author": "Čeněk", "tuning": tuning}
    original = copy_of_the_sample_with_phrases(library, change)
    page = open_page({"view": "languages", "language": original}, scene=False)
    page.get_by_role("button", name="Export").click()
    dialog = page.get_by_role("dialog", name="Export")
    written = dialog.locator("#export-command").inner_text()
    with page.expect_download() as download:
        dialog.get_by_role("link", name="Download").click()
    file = tmp_path / download.value.suggested_filename
    assert file.name == "Zeichen-fur-Hohlen-2.-Fassung.json"
    assert f"--language {file.name} " in written
    download.value.save_as(file)
    library.client.delete(f"/api/v1/languages/{original}").raise_for_status()
    expect(card(page, name)).to_have_count(0)
    drop(page, file)
    expect(page.get_by_text("Language imported")).to_be_visible()
    expect(card(page, name).get_by_text("8 gestures")).to_be_visible()
    listed = library.client.get("/api/v1/languages").json()
    (again,) = [each["id"] for each in listed if each["name"] == name]
    assert again != original
    exported = library.client.get(f"/api/v1/languages/{again}/export")
    assert exported.content == file.read_bytes()
    page.keyboard.press("Control+z")
    expect(card(page, name)).to_have_count(0)


def copy_of_the_sample_with_phrases(library: Library, change: Mapping[str, object]) -> str:
    """Return the id of a changed copy of the larger sample, one gesture with its own switches."""
    listed = library.client.get("/api/v1/languages").json()
    (sample,) = [each["id"] for each in listed if each["name"] == "Table 2: eight signs"]
    copy = str(library.client.post(f"/api/v1/languages/{sample}/duplicate").json()["id"])
    place = f"/api/v1/languages/{copy}"
    library.client.patch(place, json=change).raise_for_status()
    switches = {"tempo": "on", "mirror": "off", "command": {"do": "turn", "by": [0.5, -1]}}
    library.client.patch(f"{place}/gestures/circle", json=switches).raise_for_status()
    return copy


def test_a_language_is_found_by_a_gesture_and_keys_reach_every_command_of_its_card(
    open_page: OpenPage, name: str
) -> None:
    page = open_page({"view": "languages"}, scene=False)
    find = page.get_by_label("Find languages")
    find.fill("infinity")
    expect(card(page, "Table 2: eight signs")).to_be_visible()
    expect(card(page, "Table 1: three signs")).to_have_count(0)
    find.fill("no such gesture")
    expect(page.get_by_text("No language is called")).to_be_visible()
    find.fill("")
    page.get_by_label(f"What to do with {name}", exact=True).focus()
    page.keyboard.press("Enter")
    for text in ("Rename\u2026", "Duplicate", "History", "Invite people", "Export", "Delete"):
        page.keyboard.press("ArrowDown")
        expect(page.locator(":focus")).to_have_text(text)
    page.keyboard.press("Escape")
    expect(card(page, name).get_by_text("Duplicate")).to_be_hidden()
    command(page, name, "Invite people")
    expect(page.get_by_role("heading", name=f"Health of {name}")).to_be_visible()
    page.get_by_role("button", name="Invite people").click()
    expect(page.get_by_role("dialog", name=f"Invite people to {name}")).to_be_visible()


def test_two_revisions_are_compared_under_an_address_of_their_own_on_a_phone_too(
    open_page: OpenPage, library: Library, name: str
) -> None:
    library.client.delete(f"/api/v1/languages/{library.language}/gestures/line")
    page = open_page({"view": "languages"}, scene=False)
    page.set_viewport_size({"width": 390, "height": 844})
    expect(card(page, name)).to_be_visible()
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    command(page, name, "History")
    expect(page.get_by_role("heading", name=name)).to_be_visible()
    changes = page.get_by_role("list", name="What changed")
    expect(changes.get_by_role("listitem")).to_contain_text(["removed"])
    expect(changes.get_by_role("img", name="Trajectory of line")).to_be_visible()
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    page.set_viewport_size({"width": 1280, "height": 800})
    page.get_by_label("from", exact=True).select_option("nothing")
    page.get_by_label("to", exact=True).select_option("revision 3")
    expect(changes.locator(":scope > li")).to_have_count(2)
    colleague = open_page(scene=False, alone=True)
    colleague.goto(page.url)
    expect(colleague.get_by_text("Gestures: 2 added.")).to_be_visible()
    colleague.get_by_role("link", name="All languages").click()
    expect(card(colleague, name)).to_be_visible()


def test_going_back_to_a_revision_can_itself_be_taken_back(
    open_page: OpenPage, library: Library
) -> None:
    query = {"view": "languages", "language": library.language, "panel": "history"}
    page = open_page(query, scene=False)
    page.get_by_role("button", name="Go back to revision 2").click()
    newest = page.get_by_role("list", name="Revisions").get_by_role("listitem").first
    expect(newest).to_contain_text("Go back to revision 2")
    expect(page.get_by_text("1 removed")).to_be_visible()
    page.keyboard.press("Control+z")
    expect(newest).to_contain_text("Go back to revision 3")
    expect(page.get_by_text("1 added")).to_be_visible()


def test_undo_of_a_new_language_does_not_take_back_what_others_did(
    open_page: OpenPage, library: Library, tmp_path: Path
) -> None:
    page = open_page({"view": "languages"}, scene=False)
    page.get_by_role("button", name="New language").first.click()
    page.get_by_role("textbox", name="Name", exact=True).fill("shared")
    page.get_by_role("button", name="Create").click()
    expect(page.get_by_text("Language made")).to_be_visible()
    listed = library.client.get("/api/v1/languages").json()
    (made,) = (each for each in listed if each["name"] == "shared")
    place = f"/api/v1/languages/{made['id']}"
    assert library.client.patch(place, json={"author": "Bo"}).status_code == 200
    page.keyboard.press("Control+z")
    refusal = page.get_by_text("The language was changed elsewhere as well (revision 2")
    expect(refusal).to_be_visible()
    assert library.client.get(place).json()["author"] == "Bo"

    # So it is with an imported one, and with the repeated deletion of a restored one.
    page.get_by_role("button", name="Dismiss").last.click()
    file = tmp_path / "brought.json"
    file.write_text(Language("brought", []).to_json(), "utf-8")
    drop(page, file)
    expect(page.get_by_text("Language imported")).to_be_visible()
    listed = library.client.get("/api/v1/languages").json()
    place = next(f"/api/v1/languages/{each['id']}" for each in listed if each["name"] == "brought")
    command(page, "brought", "Delete")
    expect(page.get_by_text("Language deleted")).to_be_visible()
    page.keyboard.press("Control+z")
    expect(card(page, "brought")).to_be_visible()
    assert library.client.patch(place, json={"author": "Bo"}).status_code == 200
    page.keyboard.press("Control+Shift+Z")
    expect(refusal).to_be_visible()
    page.get_by_role("button", name="Dismiss").last.click()
    page.keyboard.press("Control+z")
    expect(refusal).to_be_visible()
    assert library.client.get(place).json()["author"] == "Bo"


def lose_race(page: Page, library: Library, description: str) -> None:
    """Relabel the line while somebody else edits its description."""
    line = page.get_by_role("list", name="Gestures").get_by_role("listitem")
    line.filter(has_text="line").hover()
    page.get_by_role("button", name="Change line", exact=True).click()
    expect(page.get_by_label("Label")).to_have_value("line")
    place = f"/api/v1/languages/{library.language}/gestures/line"
    library.client.patch(place, json={"description": description}).raise_for_status()
    page.get_by_label("Label").fill("stroke")
    page.get_by_role("button", name="Save", exact=True).click()
    expect(page.get_by_role("dialog", name="Changed in two places")).to_be_visible()


def gestures(library: Library) -> dict[str, str]:
    """Return the language's gestures with their descriptions."""
    language = library.client.get(f"/api/v1/languages/{library.language}").json()
    return {gesture["label"]: gesture["description"] for gesture in language["gestures"]}


def test_of_a_lost_race_both_versions_are_shown_and_any_or_both_can_be_kept(
    open_page: OpenPage, library: Library
) -> None:
    page = open_page(library.address, scene=False)
    lose_race(page, library, "a long line")
    theirs = page.get_by_role("region", name="Theirs, saved")
    expect(theirs).to_contain_text("line: description was empty, is “a long line”")
    expect(page.get_by_role("region", name="Yours, not saved yet")).to_contain_text("stroke")
    page.get_by_role("button", name="Keep both").click()
    expect(page.get_by_role("img", name="Trajectory of stroke")).to_be_visible()
    assert gestures(library) == {"circle": "", "stroke": "a long line"}
    page.keyboard.press("Control+z")
    expect(page.get_by_role("img", name="Trajectory of line")).to_be_visible()
    assert gestures(library) == {"circle": "", "line": "a long line"}

    lose_race(page, library, "a longer line")
    page.get_by_role("button", name="Decide later").click()
    expect(page.get_by_role("alert")).to_contain_text("Nothing was saved")
    page.get_by_role("button", name="Save", exact=True).click()
    page.get_by_role("button", name="Keep theirs").click()
    expect(page.get_by_role("dialog")).to_have_count(0)
    assert gestures(library) == {"circle": "", "line": "a longer line"}

    lose_race(page, library, "the longest line")
    page.get_by_role("button", name="Keep yours").click()
    expect(page.get_by_role("img", name="Trajectory of stroke")).to_be_visible()
    assert gestures(library) == {"circle": "", "stroke": "a longer line"}


def test_the_tour_comes_once_and_again_when_asked_for(open_page: OpenPage) -> None:
    page = open_page(scene=False, first_visit=True)
    tour = page.locator(".tour")
    expect(tour).to_contain_text("1 of 5")
    # Who begins by himself needs no tour.
    page.get_by_role("link", name="Languages", exact=True).click()
    expect(tour).to_have_count(0)
    page.get_by_role("link", name="Studio", exact=True).click()
    page.reload()
    expect(page.get_by_text("Connected")).to_be_visible()
    expect(tour).to_have_count(0)
    page.keyboard.press("?")
    page.get_by_role("button", name="Tour").click()
    tour.get_by_role("button", name="Skip").click()
    expect(tour).to_have_count(0)
    page.keyboard.press("?")
    page.get_by_role("button", name="Tour").click()
    for number in range(1, 5):
        expect(tour).to_contain_text(f"{number} of 5")
        page.keyboard.press("Enter")
    expect(tour).to_contain_text("5 of 5")
    expect(tour.get_by_role("button", name="Skip")).to_have_count(0)
    page.keyboard.press("Escape")
    expect(tour).to_have_count(0)


def test_who_comes_by_a_link_is_not_shown_around(open_page: OpenPage, library: Library) -> None:
    page = open_page(library.address, scene=False, first_visit=True)
    expect(page.get_by_role("img", name="Trajectory of line")).to_be_visible()
    expect(page.locator(".tour")).to_have_count(0)


def test_pictures_of_the_library(
    open_page: OpenPage, library: Library, picture: Callable[[Page, str], Path]
) -> None:
    languages = library.client.get("/api/v1/languages").json()
    for language in languages:
        if not language["sample"]:
            library.client.delete(f"/api/v1/languages/{language['id']}")
    library.client.post(f"/api/v1/languages/{library.language}/restore")
    place = f"/api/v1/languages/{library.language}"
    library.client.patch(place, json={"name": "Reef survey", "author": "Ada"})
    library.client.delete(f"{place}/gestures/line")
    change = {"label": "surface", "command": "come up"}
    library.client.patch(f"{place}/gestures/circle", json=change)
    page = open_page({"view": "languages"}, scene=False)
    expect(card(page, "Reef survey").get_by_text("No errors")).to_be_visible()
    # Pictures are loaded when scrolled into view.
    images = "[...document.querySelectorAll('#view-languages img')]"
    until(lambda: page.evaluate(f"{images}.every((image) => image.naturalWidth > 0)"))
    picture(page, "library")
    compared = {"language": library.language, "older": "3", "newer": "6"}
    page = open_page({"view": "languages", "panel": "history", **compared}, scene=False)
    expect(page.get_by_text("label was")).to_be_visible()
    picture(page, "history")


def test_without_languages_the_samples_are_offered(open_page: OpenPage, server: Running) -> None:
    with client_of(server.address) as client:
        for language in client.get("/api/v1/languages").json():
            client.delete(f"/api/v1/languages/{language['id']}")
    page = open_page({"view": "languages"}, scene=False)
    expect(page.get_by_text("No languages yet")).to_be_visible()
    page.get_by_role("button", name="Table 1: three signs").click()
    expect(card(page, "Table 1: three signs").get_by_role("img")).to_have_count(3)
    expect(page.get_by_role("button", name="Table 1: three signs")).to_have_count(0)
    expect(page.get_by_role("button", name="Table 2: eight signs")).to_be_visible()
