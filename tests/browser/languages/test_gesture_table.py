"""Gestures of several clips: named in one table, saved in one step, in few clicks."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import httpx
from playwright.sync_api import Locator, Page, expect

from tests.api.running import Running
from tests.browser.accessibility import faults
from tests.browser.conftest import OpenPage
from tests.browser.library import add_clip, answer_late, library_of

EXTRACTION_MS = 300_000
"""Longest wait for the poses of a clip of six seconds on a loaded machine."""

COUNT_PRESSES = """
window.presses = 0;
addEventListener("pointerdown", () => { window.presses += 1; }, { capture: true });
"""

NAMES = ("up", "down", "stop", "follow me", "bring light", "take picture", "return", "stay")


def presses(page: Page) -> int:
    """Return how often a button of the mouse was pressed since the page was opened."""
    return int(page.evaluate("window.presses"))


def counting(page: Page) -> Page:
    """Start counting."""
    page.evaluate(COUNT_PRESSES)
    return page


def open_table(page: Page) -> Locator:
    """Open the table by its button, which is in sight above the clips."""
    button = page.get_by_role("button", name="Make gestures of these clips")
    expect(button).to_be_in_viewport()
    button.click()
    return page.get_by_role("dialog", name="Make gestures of these clips")


def test_the_first_gesture_of_an_own_clip_takes_four_clicks_and_a_name(
    open_page: OpenPage, thin_clip: Callable[[str], Path]
) -> None:
    page = counting(open_page(scene=False, first_visit=True))
    page.get_by_role("button", name="Skip").click()
    with page.expect_file_chooser() as chooser:
        page.get_by_role("button", name="Choose clips").click()
    clip = thin_clip("circle-demonstration")
    chooser.value.set_files(
        {"name": "GX010001.mp4", "mimeType": "video/mp4", "buffer": clip.read_bytes()}
    )
    dialog = open_table(page)
    name = dialog.get_by_label("Label of GX010001.mp4")
    expect(name).to_have_value("")  # A camera's number is no label.
    name.fill("circle")
    save = dialog.get_by_role("button", name="Save 1 gesture")
    expect(save).to_be_enabled(timeout=EXTRACTION_MS)
    save.click()
    expect(
        page.get_by_role("list", name="Gestures", exact=True).get_by_text("circle")
    ).to_be_visible()
    expect(page.get_by_label("Language", exact=True)).to_contain_text("My gestures")
    assert presses(page) <= 4


def test_eight_clips_become_eight_gestures_in_one_step_that_can_be_undone(
    open_page: OpenPage, server: Running, client: httpx.Client
) -> None:
    language = client.post("/api/v1/languages", json={"name": "eight"}).json()["id"]
    for number in range(8):
        add_clip(server, "circle", name=f"IMG_{number:04}.mp4")
    page = counting(open_page({"language": language}, scene=False))
    expect(page.get_by_role("list", name="Clips").get_by_text("IMG_0000.mp4")).to_be_visible()
    button = page.get_by_role("button", name="Make gestures of these clips")
    expect(button).to_have_class(re.compile("primary"))
    dialog = open_table(page)
    for row in dialog.get_by_role("listitem").all():
        if "IMG_" not in row.inner_text():
            row.get_by_role("checkbox").uncheck()  # Clips of other tests, which are left out here.
    expect(dialog).to_contain_text("8 rows without a name")
    before = presses(page)
    for number, label in enumerate(NAMES):
        dialog.get_by_label(f"Label of IMG_{number:04}.mp4").fill(label)
    dialog.get_by_role("button", name="Save 8 gestures").click()
    cards = page.get_by_role("list", name="Gestures", exact=True).get_by_role("listitem")
    expect(cards).to_have_count(8)
    assert presses(page) - before + 1 <= 10
    assert client.get(f"/api/v1/languages/{language}").json()["revision"] == 2
    page.keyboard.press("Control+z")
    expect(cards).to_have_count(0)
    page.keyboard.press("Control+Shift+Z")
    expect(cards).to_have_count(8)


def test_before_a_sample_the_next_step_is_a_language_of_ones_own(
    open_page: OpenPage, server: Running, client: httpx.Client
) -> None:
    clip, _ = (add_clip(server, "circle", name=f"own {number}.mp4") for number in range(2))
    sample = next(each for each in client.get("/api/v1/languages").json() if each["sample"])
    page = open_page({"language": sample["id"], "clip": clip}, scene=False)
    recognise = page.get_by_role("button", name="Recognise", exact=True)
    expect(recognise).to_be_enabled()
    expect(recognise).not_to_have_class("primary")
    make = page.get_by_role("button", name="Make gestures of these clips")
    expect(make).to_have_class("primary")
    own = library_of(server, client, "one's own")
    page.get_by_label("Language", exact=True).select_option(own.language)
    expect(recognise).to_have_class("primary")
    expect(make).not_to_have_class("primary")


def test_a_row_says_what_is_wrong_with_it(
    open_page: OpenPage, server: Running, client: httpx.Client
) -> None:
    library = library_of(server, client, "warned")
    add_clip(server, name="no salute.mp4")
    page = open_page({"language": library.language}, scene=False)
    dialog = open_table(page)
    row = dialog.get_by_role("listitem").filter(has_text="no salute.mp4")
    for box in dialog.get_by_role("checkbox").all():
        box.uncheck()
    expect(dialog.get_by_role("button", name="Save 0 gestures")).to_be_disabled()
    row.get_by_role("textbox").fill("circle")
    expect(row).to_contain_text("No Vulcan salute was found")
    row.get_by_role("textbox").fill("still")
    expect(row).to_contain_text("No Vulcan salute was found")
    assert faults(page) == []
    dialog.get_by_role("button", name="Save 1 gesture").click()
    expect(row).to_contain_text("still: ")  # Nothing moves in it.
    expect(dialog).to_be_visible()


def test_takes_of_known_gestures_become_further_demonstrations_where_they_are_misread(
    open_page: OpenPage, server: Running, client: httpx.Client
) -> None:
    library = library_of(server, client, "known")
    add_clip(server, "circle", name="circle t2.mp4")
    add_clip(server, "corner", name="circle t3.mp4")
    corner = add_clip(server, "corner", name="IMG_2222.mp4")
    takes = [{"clip_id": corner, "expected": "line"}]
    place = f"/api/v1/languages/{library.language}"
    assert client.post(f"{place}/test-set", json={"takes": takes}).status_code == 201
    page = open_page({"language": library.language}, scene=False)
    dialog = open_table(page)
    row = {
        name: dialog.get_by_role("listitem").filter(has_text=f"{name}.mp4")
        for name in ("circle t2", "circle t3", "IMG_2222")
    }
    expect(row["circle t3"].get_by_role("checkbox")).to_be_checked()
    expect(row["circle t2"]).to_contain_text("It is read as \u201ccircle\u201d already.")
    expect(row["circle t2"].get_by_role("checkbox")).not_to_be_checked()
    expect(row["IMG_2222"].get_by_role("textbox")).to_have_value("line")
    expect(row["IMG_2222"].get_by_role("checkbox")).not_to_be_checked()  # It is in the test set.
    row["IMG_2222"].get_by_role("checkbox").check()
    page.route("**/api/v1/languages", answer_late, times=1)  # One of them is saved into.
    page.reload()
    dialog = open_table(page)
    expect(row["IMG_2222"].get_by_role("checkbox")).to_be_checked()
    assert faults(page) == []
    for each in dialog.get_by_role("listitem").all():
        text = each.inner_text()
        if "circle t3" not in text and "IMG_2222" not in text:
            each.get_by_role("checkbox").uncheck()  # Clips of other tests.
    dialog.get_by_role("button", name="Save 2 demonstrations").click()
    expect(page.get_by_text("2 demonstrations saved")).to_be_visible()

    def shown() -> dict[str, int]:
        gestures = client.get(place).json()["gestures"]
        return {each["label"]: len(each["demonstrations"]) for each in gestures}

    assert shown() == {"circle": 2, "line": 2}
    page.keyboard.press("Control+z")
    expect(page.get_by_text("Undone")).to_be_visible()
    assert shown() == {"circle": 1, "line": 1}

    # One take by itself: the editor proposes what it is expected to be.
    page.goto(re.sub(r"\?.*", f"?language={library.language}&clip={corner}", page.url))
    page.get_by_label("Expected").select_option("line")
    page.get_by_role("button", name="Save as gesture").click()
    expect(page.get_by_label("Label", exact=True)).to_have_value("line")
    page.get_by_role("button", name="Add to line").click()
    expect(page.get_by_text("Demonstration added")).to_be_visible()
    assert shown() == {"circle": 1, "line": 2}


def test_why_a_clip_was_misread_takes_one_click_after_recognising(
    open_page: OpenPage, server: Running, client: httpx.Client
) -> None:
    library = library_of(server, client, "misread")
    query = {**library.address, "recognition": library.recognise()}
    page = counting(open_page(query, scene=False))
    why = page.get_by_role("region", name="Why")
    meant = why.get_by_role("group", name="Gesture that was meant")
    meant.get_by_role("button", name="line").click()
    expect(why).to_contain_text(re.compile(".line."))
    assert presses(page) == 1


def test_of_rows_that_are_alike_the_best_are_kept_and_the_others_say_why(
    open_page: OpenPage, server: Running, client: httpx.Client
) -> None:
    language = client.post("/api/v1/languages", json={"name": "chosen"}).json()["id"]
    names = {"box": "square", "frame": "square", "corner": "corner"}
    for name, shape in names.items():
        add_clip(server, shape, name=f"{name}.mp4")
    page = open_page({"language": language}, scene=False, size=(390, 800))
    page.get_by_role("button", name="Make gestures of these clips").click()
    dialog = page.get_by_role("dialog", name="Make gestures of these clips")
    for row in dialog.get_by_role("listitem").all():
        if not any(f"{name}.mp4" in row.inner_text() for name in names):
            row.get_by_role("checkbox").uncheck()  # Clips of other tests, which are left out here.
    keep = dialog.get_by_label("Rows to keep")
    expect(dialog).to_contain_text("of 3")
    expect(keep).to_have_value("2")
    dialog.get_by_role("button", name="Keep the best").click()
    expect(dialog.get_by_text("By the distances of one person")).to_be_visible()
    expect(dialog.get_by_role("button", name="Save 2 gestures")).to_be_visible()
    expect(dialog.get_by_label("Make a gesture of corner.mp4")).to_be_checked()
    left_out = dialog.get_by_role("listitem").filter(has_text="Left out; nearest is")
    expect(left_out).to_contain_text("nearly alike")
    assert faults(page) == []
    left_out.get_by_role("checkbox").check()
    expect(left_out).to_have_count(0)
    expect(dialog).to_contain_text("of 3")
    # A phone shows every field.
    for field in dialog.get_by_role("listitem").first.locator("input").all():
        box = field.bounding_box()
        assert box is not None
        assert 0 <= box["x"] <= box["x"] + box["width"] <= 390
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    page.keyboard.press("Escape")
    expect(dialog).to_be_hidden()
