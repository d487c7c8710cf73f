"""A dive recording dropped on the page, and the gestures that come out of it."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import httpx
import pytest
from playwright.sync_api import Page, expect

from app.recognition.recording.video import read_frames
from tests.api.recordings import recording_of
from tests.api.running import Running
from tests.bags.bag_files import (
    DELAY,
    START,
    Row,
    compressed,
    file_of,
    published_rows,
    write_bag,
    zipped,
)
from tests.bags.exports import checked
from tests.browser.accessibility import faults
from tests.browser.conftest import OpenPage
from tests.browser.files import drop
from tests.browser.library import Library, add_clip, library_of

EXTRACTION_MS = 300_000
"""Longest wait for the poses of a clip of seven seconds on a loaded machine."""


def takes_of(client: httpx.Client, clip_id: str) -> list[dict[str, Any]]:
    takes: list[dict[str, Any]] = client.get(f"/api/v1/clips/{clip_id}/takes").json()
    return takes


def labels_of(library: Library, clip_id: str) -> list[str | None]:
    """Recognise every take of a clip by the library's language."""
    found = []
    for take in takes_of(library.client, clip_id):
        body = {"clip_id": clip_id, "language_id": library.language}
        body |= {"start": take["stroke_start"], "end": take["stroke_end"]}
        found.append(library.client.post("/api/v1/recognitions", json=body).json()["label"])
    return found


def clip_shown(page: Page) -> str:
    """Return the id of the clip on display, as the address tells it."""
    (clip_id,) = re.findall(r"[?&]clip=(\w+)", page.url)
    return str(clip_id)


def test_a_bag_comes_out_as_the_same_gestures_as_the_clip_itself(
    open_page: OpenPage, server: Running, client: httpx.Client, tmp_path: Path
) -> None:
    library = library_of(server, client, "recorded")
    shapes = ("line", "circle", "circle backwards")
    itself = add_clip(server, *shapes, name="itself.mp4")
    bag = zipped(write_bag(tmp_path / "dive", published_rows(recording_of(*shapes)), "sqlite3"))
    page = open_page({"language": library.language}, scene=False)
    drop(page, bag)
    expect(page.locator("#clip-name")).to_have_text(bag.name)
    expect(page.get_by_role("button", name=re.compile("^Take 3"))).to_be_visible()
    from_bag = clip_shown(page)
    assert takes_of(client, from_bag) == takes_of(client, itself)
    assert labels_of(library, from_bag) == labels_of(library, itself)
    assert labels_of(library, from_bag)[:2] == ["line", "circle"]
    expect(page.get_by_text("there is no picture: the skeleton is drawn")).to_be_visible()


def test_the_topic_is_chosen_in_a_dialogue(
    open_page: OpenPage,
    server: Running,
    client: httpx.Client,
    tmp_path: Path,
    picture: Callable[[Page, str], Path],
) -> None:
    library = library_of(server, client, "two divers")
    rows: list[Row] = []
    for diver, shape in (("buddy", "line"), ("leader", "circle")):
        rows += [
            (f"/{diver}{topic}", content, received)
            for topic, content, received in published_rows(recording_of(shape))
        ]
    bag = write_bag(tmp_path / "two-divers", sorted(rows, key=lambda row: row[2]))
    page = open_page({"language": library.language}, scene=False)
    drop(page, file_of(bag), names=("two-divers.mcap",))
    dialog = page.get_by_role("dialog", name="Choose a topic")
    expect(dialog.get_by_role("radio")).to_have_count(2)
    expect(dialog.get_by_role("radio", name="/buddy/pose_keypoints")).to_be_checked()
    picture(page, "topics")
    assert faults(page) == []
    page.emulate_media(color_scheme="light")
    assert faults(page) == []

    # A user who decides later finds the question at the clip, and can answer it by keyboard.
    dialog.get_by_role("button", name="Later").click()
    card = page.get_by_role("list", name="Clips", exact=True).get_by_role("listitem").first
    expect(card.get_by_text("2 topics: choose one")).to_be_visible()
    panel = page.locator("#welcome")
    expect(panel.get_by_role("heading", name="This recording holds 2 topics")).to_be_visible()
    assert faults(page) == []
    panel.get_by_role("button", name="Choose a topic").click()
    page.keyboard.press("Escape")
    card.get_by_role("button", name="Choose the topic of two-divers.mcap").press("Enter")
    page.keyboard.press("ArrowDown")
    expect(dialog.get_by_role("radio", name="/leader/pose_keypoints")).to_be_checked()
    page.keyboard.press("Enter")
    expect(page.get_by_role("button", name=re.compile("^Take 1"))).to_be_visible()
    expect(dialog).to_have_count(0)
    assert labels_of(library, clip_shown(page)) == ["circle"]

    # Poses and recognitions are exported as a file that Foxglove opens.
    page.get_by_role("button", name="Recognise", exact=True).click()
    why = page.get_by_role("region", name="Why")
    with page.expect_download() as download:
        why.get_by_role("button", name="Session as MCAP").click()
    assert download.value.suggested_filename == "two-divers.mcap"
    download.value.save_as(tmp_path / "session.mcap")
    found = checked(tmp_path / "session.mcap")
    assert [content["label"] for _, content in found["/recognitions"]] == ["circle", "circle"]
    assert len(found["/video"]) == len(recording_of("circle").poses)
    page.get_by_label("Expected", exact=True).select_option("line")
    page.get_by_role("button", name="Recognise", exact=True).click()
    expect(why.get_by_role("link", name="Share as one file")).to_be_visible()


def test_pictures_in_a_bag_are_read_like_the_clip_they_come_from(
    open_page: OpenPage, client: httpx.Client, thin_clip: Callable[[str], Path], tmp_path: Path
) -> None:
    languages = client.get("/api/v1/languages").json()
    language = next(each for each in languages if each["name"].startswith("Table 1"))
    rows: list[Row] = []
    frames = list(read_frames(thin_clip("circle-demonstration")))
    for frame in frames:
        stamp = START + round(frame.time * 1e9)
        content = compressed(frame.image, ".jpg", stamp)
        rows.append(("/camera/image/compressed", content, stamp + DELAY))
    page = open_page({"language": language["id"]}, scene=False)
    bag = file_of(write_bag(tmp_path / "dive", rows))
    drop(page, bag)
    expect(page.locator("#clip-name")).to_have_text(bag.name)
    expect(page.get_by_role("button", name=re.compile("^Take 1"))).to_be_visible(
        timeout=EXTRACTION_MS
    )
    clip_id = clip_shown(page)
    poses = client.get(f"/api/v1/clips/{clip_id}/poses").json()
    assert poses["time"] == pytest.approx([frame.time for frame in frames], abs=1e-6)
    library = Library(clip_id, language["id"], client)
    assert labels_of(library, clip_id) == ["circle"]
