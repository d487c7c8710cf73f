"""A pose of the arms as trigger: chosen from a clip without any hand, used, and undone."""

from __future__ import annotations

from collections.abc import Iterator

import httpx
import pytest
from playwright.sync_api import expect

from tests.api.running import Running, client_of
from tests.browser.accessibility import faults
from tests.browser.conftest import OpenPage
from tests.browser.library import Library, add_clip, library_of
from tests.posed import posed_clip, posed_recording


@pytest.fixture
def library(server: Running) -> Iterator[Library]:
    with client_of(server.address) as client:
        clips = [
            add_clip(server, name=f"{name}.mp4", video=posed_clip(name), recording=recording)
            for name in ("circle-by-belly-2", "circle-by-belly")
            for recording in [posed_recording(name)]
        ]
        made = client.post("/api/v1/languages", json={"name": "by arms"}).json()
        yield Library(clips[-1], made["id"], client)


def test_a_gesture_is_defined_and_recognised_between_two_poses(
    open_page: OpenPage, library: Library
) -> None:
    page = open_page(library.address | {"start": "1", "end": "2"}, scene=False)
    expect(page.get_by_text("No Vulcan salute was found")).to_be_visible()
    expect(page.get_by_text("Takes lie between two salutes.", exact=True)).to_be_visible()
    page.get_by_role("button", name="Change what begins and ends a take").click()
    dialog = page.get_by_role("dialog", name="What begins and ends a gesture")
    expect(dialog.get_by_role("radio", name="A Vulcan salute")).to_be_checked()
    expect(dialog.get_by_role("button", name="Save")).to_be_disabled()
    dialog.get_by_role("radio", name="A held pose of the arms").check()
    assert faults(page) == []
    dialog.get_by_role("button", name="Save").click()
    expect(dialog).to_be_hidden()
    expect(page.get_by_text("left hand before the body").first).to_be_visible()
    expect(page.get_by_role("button", name="Take 1,")).to_be_visible()

    page.get_by_role("button", name="Save as gesture").click()
    page.get_by_label("Label").fill("circle")
    page.get_by_role("button", name="Save gesture").click()
    expect(page.get_by_text("Gesture saved")).to_be_visible()
    page.get_by_role("button", name="Show circle-by-belly-2.mp4").click()
    expect(page.get_by_role("button", name="Take 1,")).to_be_visible()
    page.get_by_role("button", name="Recognise", exact=True).click()
    expect(page.locator("#outcome")).to_contain_text("circle")

    live = open_page({"view": "live", "language": library.language}, scene=False)
    expect(live.get_by_text("Hold the pose of the arms, show the gesture")).to_be_visible()
    steps = live.locator("#live-steps").get_by_role("listitem")
    expect(steps).to_have_text(["Pose", "Gesture", "Pose"])
    expect(live.get_by_text("Stop after the closing arm pose")).to_have_count(1)
    assert faults(live) == []

    page.keyboard.press("Control+z")
    page.keyboard.press("Control+z")
    expect(page.get_by_text("Takes lie between two salutes.", exact=True)).to_be_visible()
    expect(page.get_by_text("No Vulcan salute was found")).to_be_visible()


def test_one_gesture_begins_takes_and_another_one_ends_them(
    open_page: OpenPage, server: Running, client: httpx.Client
) -> None:
    library = library_of(server, client, "by gestures")
    page = open_page(library.address, scene=False)
    page.get_by_role("button", name="Change what begins and ends a take").click()
    dialog = page.get_by_role("dialog", name="What begins and ends a gesture")
    dialog.get_by_role("radio", name="A gesture of the language").check()
    dialog.get_by_label("Gesture that begins a take").select_option("line")
    dialog.get_by_label("Gesture that ends a take").select_option("circle")
    assert faults(page) == []
    dialog.get_by_role("button", name="Save").click()
    expect(dialog).to_be_hidden()
    expect(page.get_by_text("between the gestures 'line' and 'circle'").first).to_be_visible()
    page.get_by_role("button", name="Change what begins and ends a take").click()
    expect(dialog.get_by_label("Gesture that begins a take")).to_have_value("line")
    expect(dialog.get_by_label("Gesture that ends a take")).to_have_value("circle")
    expect(dialog.get_by_role("radio", name="A gesture of the language")).to_be_checked()
    # Another gesture at the end is a change by itself.
    expect(dialog.get_by_role("button", name="Save")).to_be_disabled()
    dialog.get_by_label("Gesture that ends a take").select_option("the same")
    expect(dialog.get_by_role("button", name="Save")).to_be_enabled()
