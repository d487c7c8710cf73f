"""Trials of counterfactuals: each is tried by one press, and kept or discarded."""

from __future__ import annotations

import re
from dataclasses import replace

from playwright.sync_api import APIResponse, Locator, Page, Route, expect

from app.recognition import Recording
from tests.api.recordings import recording_of
from tests.api.running import Running
from tests.browser.conftest import OpenPage
from tests.browser.library import Library, add_clip
from tests.recognition.damaged_poses import with_sides_exchanged

REPAIR = "with exchanged sides put right and jumps left out"


def exchanged() -> Recording:
    """Return a circle with left and right exchanged for a while."""
    recording = recording_of("circle")
    return replace(recording, poses=with_sides_exchanged(recording.poses, range(32, 40)))


def opened_at_a_mistake(open_page: OpenPage, server: Running, library: Library) -> Page:
    """Open the page at a circle that is taken for a line."""
    clip = add_clip(server, recording=exchanged(), name="sides exchanged.mp4")
    mistaken = replace(library, clip=clip)
    recognition = mistaken.recognise("circle", profile="paper")
    return open_page({**mistaken.address, "recognition": recognition}, scene=False)


def try_out(page: Page, words: str | re.Pattern[str]) -> Locator:
    """Press a counterfactual, and wait for the result of its trial."""
    page.get_by_role("region", name="Why").get_by_role("button", name=words).first.click()
    trial = page.get_by_role("region", name="Why").get_by_role("status")
    expect(trial).to_contain_text(words)
    return trial


def test_a_change_is_tried_taken_back_kept_and_goes_with_the_language(
    open_page: OpenPage, server: Running, library: Library
) -> None:
    page = opened_at_a_mistake(open_page, server, library)
    outcome = page.locator("#outcome")
    expect(outcome).to_contain_text("Recognised as line, expected circle")
    trial = try_out(page, REPAIR)
    expect(outcome).to_contain_text("Recognised as circle, as expected")
    trial.get_by_role("button", name="Discard").click()
    expect(outcome).to_contain_text("Recognised as line, expected circle")
    assert library.client.get(f"/api/v1/languages/{library.language}").json()["tuning"] is None

    trial = try_out(page, REPAIR)
    trial.get_by_role("button", name="Keep").click()
    tuning = page.locator("#tuning")
    expect(tuning).to_contain_text(f"Recognised by the profile paper, {REPAIR}")
    expect(trial).to_have_count(0)
    expect(outcome).to_contain_text(re.compile(r"as expectedconfidence \d+ %, \d+ % of the votes$"))

    # The export for the robot has the change too.
    page.get_by_role("button", name="Export").click()
    expect(page.get_by_role("dialog")).to_contain_text(REPAIR)
    page.get_by_role("button", name="Close").click()
    exported = library.client.get(f"/api/v1/languages/{library.language}/export").json()
    assert exported["profile"] == "paper"
    assert exported["tuning"] == {"keypoints_repaired": True}

    tuned = outcome.inner_text()
    page.keyboard.press("Control+z")
    expect(tuning).to_be_hidden()
    page.get_by_role("button", name="Recognise", exact=True).click()
    expect(outcome).not_to_have_text(tuned)
    # The server's event shows the redone change before the page has the answer to its redo.
    held: list[tuple[Route, APIResponse]] = []
    page.route("**/revert*", lambda route: held.append((route, route.fetch())), times=1)
    page.keyboard.press("Control+Shift+Z")
    expect(tuning).to_be_visible()
    tuning.get_by_role("button", name="As the profile full does").click()
    done = page.get_by_role("status").filter(has_text="Recognised as any language")
    expect(done).to_be_visible()
    expect(tuning).to_be_hidden()
    route, answer = held.pop()
    route.fulfill(response=answer)
    expect(page.get_by_role("status").filter(has_text="Redone")).to_be_visible()
    expect(done.get_by_role("button", name="Undo")).to_be_visible()
    page.keyboard.press("Control+z")
    expect(tuning).to_contain_text(REPAIR)
    # Both can be undone, in their order.
    page.keyboard.press("Control+z")
    expect(tuning).to_be_hidden()


def revision_of(library: Library) -> int:
    """Return the language's newest revision."""
    language = library.client.get(f"/api/v1/languages/{library.language}")
    return int(language.json()["revision"])


def test_the_take_as_another_demonstration_is_read_without_itself(
    open_page: OpenPage, server: Running, library: Library
) -> None:
    library.add_gesture("square", add_clip(server, "narrow square", name="narrow.mp4"))
    clip, other = (add_clip(server, "square", name=f"square {number}.mp4") for number in (1, 2))
    test_set = f"/api/v1/languages/{library.language}/test-set"
    takes = [{"clip_id": other, "expected": "square"}]
    library.client.post(test_set, json={"takes": takes}).raise_for_status()
    misread = replace(library, clip=clip)
    recognition = misread.recognise("square")
    page = open_page({**misread.address, "recognition": recognition}, scene=False)
    outcome = page.locator("#outcome")
    expect(outcome).to_contain_text("Recognised as circle, expected square")
    offered = page.locator(".remedies").get_by_role("button")
    expect(offered).to_contain_text(["with this take as another demonstration of 'square'"])
    expect(page.locator(".remedies")).to_contain_text("Other takes are read better with this take")
    trial = try_out(page, "as another demonstration of 'square'")
    expect(trial).to_contain_text("Read without itself as circle.")
    expect(outcome).to_contain_text("Recognised as circle, expected square")
    expect(outcome).to_contain_text("read without itself, a demonstration, on trial")
    trial.get_by_role("button", name="Keep").click()
    expect(page.get_by_role("button", name="2 demonstrations of square")).to_be_visible()


def test_a_change_of_a_gesture_is_left_taken_back_or_kept(
    open_page: OpenPage, server: Running, library: Library
) -> None:
    strict = f"/api/v1/languages/{library.language}/gestures/circle"
    library.client.patch(strict, json={"direction": "on"}).raise_for_status()
    clip = add_clip(server, "circle backwards", name="circle backwards.mp4")
    refused = replace(library, clip=clip)
    page = open_page({**refused.address, "recognition": refused.recognise("circle")}, scene=False)
    outcome = page.locator("#outcome")
    before = revision_of(library)
    expect(outcome).to_contain_text("Not recognised")
    why = page.get_by_role("region", name="Why")
    expect(why).to_contain_text("The take goes through 'circle' backwards.")
    # Replacing the demonstration by the take would break the gesture for all who show it correctly.
    expect(why.get_by_role("button", name=re.compile("as the demonstration"))).to_have_count(0)
    direction = re.compile("the switch direction of 'circle' off")
    try_out(page, direction)
    expect(outcome).to_contain_text("Recognised as circle, as expected")
    # A trial that is left leaves the language alone.
    page.get_by_role("list", name="Clips").get_by_role("button", name="Show").last.click()
    expect(outcome).to_be_empty()
    assert revision_of(library) == before
    page.get_by_role("button", name="Show circle backwards.mp4").click()
    expect(page.get_by_label("Expected", exact=True)).to_have_value("circle")
    page.get_by_role("button", name="Recognise", exact=True).click()
    expect(outcome).to_contain_text("Not recognised")
    trial = try_out(page, direction)
    expect(outcome).to_contain_text("Recognised as circle, as expected")
    trial.get_by_role("button", name="Discard").click()
    expect(outcome).to_contain_text("Not recognised")
    assert revision_of(library) == before
    # A trial is not evidence either: only a take kept in the test set is.
    test_set = library.client.get(f"/api/v1/languages/{library.language}/test-set").json()
    assert test_set["takes"] == []
    try_out(page, direction).get_by_role("button", name="Keep").click()
    expect(page.get_by_text("Change kept")).to_be_visible()
    switches = library.client.get(f"/api/v1/languages/{library.language}").json()["gestures"]
    assert [each["direction"] for each in switches if each["label"] == "circle"] == ["off"]
