"""The shell of all views: keys, undo and redo; and explanations with trials of changes."""

from __future__ import annotations

import re
from pathlib import Path

from playwright.sync_api import Page, Route, expect

from tests.api.recordings import recording_of
from tests.browser.conftest import OpenPage
from tests.browser.library import Library


def delete_line(page: Page) -> None:
    card = page.get_by_role("list", name="Gestures").get_by_role("listitem").filter(has_text="line")
    card.hover()
    card.get_by_role("button", name="Delete line", exact=True).click()
    expect(page.get_by_role("img", name="Trajectory of line")).to_have_count(0)


def test_a_deleted_gesture_comes_back_even_after_a_reload_but_not_over_anothers_change(
    open_page: OpenPage, library: Library
) -> None:
    page = open_page(library.address, scene=False)
    delete_line(page)
    page.reload()
    expect(page.get_by_role("img", name="Trajectory of circle")).to_be_visible()
    page.keyboard.press("Control+z")
    expect(page.get_by_role("img", name="Trajectory of line")).to_be_visible()
    page.keyboard.press("Control+Shift+Z")
    expect(page.get_by_role("img", name="Trajectory of line")).to_have_count(0)
    place = f"/api/v1/languages/{library.language}/gestures/circle"
    library.client.patch(place, json={"label": "round"}).raise_for_status()
    expect(page.get_by_role("img", name="Trajectory of round")).to_be_visible()
    page.keyboard.press("Control+z")
    alert = page.get_by_role("alert")
    expect(alert.get_by_text("changed elsewhere")).to_be_visible()
    expect(alert.get_by_text("Undoing failed")).to_be_visible()
    expect(page.get_by_role("img", name="Trajectory of round")).to_be_visible()


def test_why_is_told_and_a_change_can_be_tried_and_taken_back(
    open_page: OpenPage, library: Library, tmp_path: Path
) -> None:
    page = open_page({**library.address, "recognition": library.recognise("line")}, scene=False)
    why = page.get_by_role("region", name="Why")
    expect(why).to_contain_text("'line'")
    expect(
        page.get_by_role("img", name="Difference of the right wrist along the clip")
    ).to_be_visible()
    moments = page.get_by_role("region", name="Moments")
    drawn = moments.get_by_role("figure").filter(has_text="lineexpected")
    beside = drawn.get_by_text(re.compile(r"s of line: [\d.]+ %"))
    # The keys work once the workspace shows the clip.
    frames = len(recording_of("circle").poses)
    expect(page.locator("#clock")).to_have_text(re.compile(f" of {frames}$"))
    before = beside.inner_text()
    page.keyboard.press("Shift+.")
    expect(beside).not_to_have_text(before)
    at = page.locator("#clock").inner_text()
    drawn.get_by_role("img").click(position={"x": 20, "y": 20})
    expect(page.locator("#clock")).not_to_have_text(at)
    joint = moments.get_by_label("Joint whose paths are drawn")
    expect(joint).to_have_value("right_wrist")
    expect(drawn.get_by_role("img", name="The right wrist in this take")).to_be_visible()
    # The explanation of the trial arrives only after the trial was discarded.
    held: list[Route] = []
    page.route("**/explanation?*", lambda route: held.append(route))
    page.get_by_label(re.compile("^Weight of velocity:")).select_option("2")
    trial = why.get_by_role("status")
    expect(trial).to_contain_text("with 2 times the weight on the comparison velocity")
    trial.get_by_role("button", name=re.compile("Discard|Back to as it was")).click()
    expect(page.locator("#outcome")).to_contain_text("Recognised as circle, expected line")
    while not held:
        page.wait_for_timeout(10)
    with page.expect_response("**/explanation?*") as told:
        held[0].continue_()
    told.value.finished()
    expect(page.get_by_role("button", name="Recognise", exact=True)).to_be_enabled()
    expect(why).to_contain_text("'line'")

    # The explanation is exported as a file that works without a server or network.
    with page.expect_download() as download:
        why.get_by_role("link", name="Share as one file").click()
    analysis = tmp_path / "analysis.html"
    download.value.save_as(analysis)
    page.context.set_offline(True)
    page.goto(analysis.as_uri())
    expect(page.get_by_role("region", name="Why")).to_contain_text("You showed")
    frame = page.get_by_label("Frame", exact=True)
    expect(frame).to_have_value("0")
    page.get_by_role("button", name="Play", exact=True).click()
    expect(frame).not_to_have_value("0")
