"""A keypoint file of another program dropped on the page, and the gesture that comes out of it."""

from __future__ import annotations

import re
from pathlib import Path

import httpx
import pytest
from playwright.sync_api import expect

from app.recognition.poses.skeletons import BODY_25
from tests.api.ingest.test_keypoint_clips import packed
from tests.api.running import Running
from tests.browser.accessibility import faults
from tests.browser.conftest import OpenPage
from tests.browser.files import drop
from tests.browser.library import add_clip, answer_late, library_of
from tests.keypoint_files.files import renamed, write_named, write_openpose
from tests.recognition.strategies import BODY, circle, recording

ARMS = tuple(BODY)


def test_a_folder_of_openpose_becomes_a_clip_and_a_gesture(
    open_page: OpenPage, server: Running, client: httpx.Client, tmp_path: Path
) -> None:
    library = library_of(server, client, "theirs")
    poses = recording(circle, frames=40, landmarks=ARMS)
    archive = packed(write_openpose(tmp_path / "dive", poses, BODY_25))
    page = open_page({"language": library.language}, scene=False)
    drop(page, archive)
    # The page asks for data missing in the files; a user who does not know it now finds Retry.
    dialog = page.get_by_role("dialog", name="What was the video like?")
    expect(dialog).to_contain_text("dive.zip holds keypoints and no video")
    assert faults(page) == []
    page.keyboard.press("Escape")
    upload = page.get_by_role("list", name="Uploads").get_by_role("listitem")
    expect(upload).to_contain_text("give the frames per second of its video")
    upload.get_by_role("button", name="Retry dive.zip").click()
    dialog.get_by_label("Frames a second").fill("many")
    dialog.get_by_role("button", name="Add the clip").click()
    expect(dialog.get_by_role("alert")).to_contain_text("is no number of frames a second")
    dialog.get_by_label("Frames a second").fill("20")
    page.keyboard.press("Enter")
    expect(page.locator("#clip-name")).to_have_text("dive.zip")
    expect(page.locator("#clip-warnings")).to_contain_text("the skeleton is drawn")
    expect(page.locator("#clip-warnings")).to_contain_text("choose the range of a gesture by hand")

    # Nobody salutes: a range of it, chosen frame by frame, is recognised and becomes a gesture.
    start = page.get_by_role("slider", name="Start of the range")
    start.focus()
    page.keyboard.press("ArrowRight")
    expect(page).to_have_url(re.compile(r"start=0\.05"))
    page.get_by_role("button", name="Recognise", exact=True).click()
    expect(page.locator("#outcome")).to_contain_text(re.compile("circle.*distance"))
    page.get_by_role("button", name="Save as gesture").click()
    page.get_by_label("Label").fill("their circle")
    page.get_by_role("button", name="Save gesture").click()
    expect(page.get_by_role("img", name="Trajectory of their circle")).to_be_visible()


def test_a_language_of_other_landmarks_and_files_of_other_kinds_are_told_apart(
    open_page: OpenPage, server: Running, client: httpx.Client, tmp_path: Path
) -> None:
    library = library_of(server, client, "other landmarks")
    paws = renamed(recording(circle, frames=40, landmarks=ARMS), {"right_wrist": "paw"})
    page = open_page({"language": library.language}, scene=False)
    drop(page, write_named(tmp_path / "paws.csv", paws))
    expect(page.locator("#clip-name")).to_have_text("paws.csv")
    recognise = page.get_by_role("button", name="Recognise", exact=True)
    expect(recognise).to_be_enabled()
    recognise.click()
    expect(page.get_by_role("alert")).to_contain_text("paws.csv gives no landmark 'right_wrist'")

    # A single frame, a language and a recording all end in .json.
    frame = tmp_path / "one_0_keypoints.json"
    frame.write_text('{"version": 1.3, "people": []}')
    drop(page, frame)
    expect(page.get_by_text("One frame of OpenPose is not a clip")).to_be_visible()
    landmarks = tmp_path / "landmarks.json"
    landmarks.write_text('{"frames": []}')
    drop(page, landmarks)
    upload = page.get_by_role("list", name="Uploads").get_by_role("listitem")
    expect(upload).to_contain_text("landmarks.json")
    expect(upload.get_by_role("button", name="Retry landmarks.json")).to_be_visible()


@pytest.mark.parametrize("meanwhile", ["chosen", "deleted"])
def test_an_upload_that_ends_replaces_no_clip_but_one_that_the_page_chose(
    open_page: OpenPage, server: Running, client: httpx.Client, tmp_path: Path, meanwhile: str
) -> None:
    library = library_of(server, client, f"a clip is {meanwhile}")
    other, first, late = (f"{meanwhile} {name}" for name in ("other.mp4", "first.mp4", "late.csv"))
    add_clip(server, "line", name=other)
    clip = add_clip(server, "line", name=first)
    page = open_page(library.address | {"clip": clip}, scene=False)
    clips = page.get_by_role("list", name="Clips").get_by_role("listitem")
    poses = recording(circle, frames=40, landmarks=ARMS)
    # The server's event lists the clip before the page has the answer to its upload.
    page.route("**/api/v1/uploads/*", answer_late, times=1)
    drop(page, write_named(tmp_path / "late.csv", poses), names=(late,))
    expect(clips.filter(has_text=late)).to_be_visible()
    pressed = other if meanwhile == "chosen" else f"Delete {first}"
    clips.get_by_role("button", name=pressed).first.click()
    expect(page.get_by_role("list", name="Uploads").get_by_role("listitem")).to_have_count(0)
    expect(page.locator("#clip-name")).to_have_text(other if meanwhile == "chosen" else late)
