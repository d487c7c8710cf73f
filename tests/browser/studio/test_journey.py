"""From a clip to a file for the robot, as a person walks through it."""

from __future__ import annotations

import os
import re
import signal
from collections.abc import Callable
from pathlib import Path

import httpx
from playwright.sync_api import FrameLocator, Locator, Page, expect

from app.recognition import Language
from app.recognition.voters.registry import MOTION_VOTERS
from app.ui.workspace import initial_frame
from tests.api.running import Running, until
from tests.api.running_workers import hold_worker, linux
from tests.browser.conftest import Film, OpenPage
from tests.browser.files import drop
from tests.short_clips import thinned

EXTRACTION_MS = 300_000
"""Longest wait for the poses of a clip of six seconds on a loaded machine."""


def lab_of(page: Page) -> FrameLocator:
    """Return viser's frame, once it draws."""
    lab = page.frame_locator("#lab")
    expect(lab.locator("canvas[data-engine]")).to_be_visible()
    return lab


def support_in(table: Locator) -> dict[str, int]:
    """Read every gesture's weight of voters, in per cent, off the vote table."""
    gestures = [head.inner_text() for head in table.locator("th.gesture span:first-child").all()]
    totals = [
        int(cell.inner_text().removeprefix("<").removesuffix(" %"))
        for cell in table.locator("td.votes-for").all()
    ]
    return dict(zip(gestures, totals, strict=True))


def upload(page: Page, clip: Path) -> None:
    """Drop a clip, watch its poses arrive, and wait for its take."""
    drop(page, clip)
    progress = page.locator("#welcome").get_by_text(re.compile(r"Finding poses, \d+ of \d+ frames"))
    expect(progress).to_be_visible(timeout=EXTRACTION_MS)
    # The skeleton lies over the clip itself, and is gone with the panel when all are found.
    expect(page.locator("#welcome video")).to_be_visible()
    bones = page.locator("#welcome .skeleton .bones")
    expect(bones).to_have_attribute("d", re.compile("^M"))
    take = page.get_by_role("button", name=re.compile("^Take 1"))
    expect(take).to_be_visible(timeout=EXTRACTION_MS)
    expect(take).to_have_attribute("aria-pressed", "true")
    expect(bones).to_have_count(0)
    # Takes come before the end; a gesture is saved after it.
    expect(page.locator("#save-gesture")).to_be_enabled(timeout=EXTRACTION_MS)


def first_shown(page: Page, server: Running) -> int:
    """Return the frame at which the only take of the clip on display is first shown."""
    (clip_id,) = re.findall(r"[?&]clip=(\w+)", page.url)
    place = f"{server.address}/api/v1/clips/{clip_id}"
    (take,) = httpx.get(f"{place}/takes", timeout=60).json()
    times = httpx.get(f"{place}/timeline", timeout=60).json()["time"]
    stroke = [at for at in times if take["stroke_start"] <= at <= take["stroke_end"]]
    return int(times.index(stroke[0])) + initial_frame(len(stroke))


def test_a_clip_becomes_a_gesture_a_recognition_and_a_file(
    open_page: OpenPage,
    server: Running,
    thin_clip: Callable[[str], Path],
    tmp_path: Path,
    picture: Callable[[Page, str], Path],
) -> None:
    page = open_page(size=(1440, 900))
    expect(page.get_by_role("heading", name="One demonstration makes a gesture")).to_be_visible()
    page.get_by_label("Language", exact=True).select_option(label="Table 2: eight signs")
    page.get_by_text("of the sample").click()
    cards = page.get_by_role("list", name="Gestures").get_by_role("listitem")
    expect(cards).to_have_count(8)
    expect(page.locator("#welcome").get_by_role("button", name="circle test 1")).to_be_visible()

    # One press on the start page, without any choice, leads to why the sample was misread.
    page.locator("#welcome").get_by_role("button", name="Why was a triangle read").click()
    why = page.get_by_role("region", name="Why")
    expect(why).to_contain_text("'triangle'", timeout=EXTRACTION_MS)
    expect(page.get_by_label("Expected", exact=True)).to_have_value("triangle")
    lab_of(page)
    expect(page.get_by_role("table", name="Votes")).to_be_visible()
    expect(page.locator("#lab-loading")).to_be_hidden()
    picture(page, "why")

    # A clip is dropped, its poses arrive, its take is seen, and becomes a gesture.
    upload(page, thin_clip("circle-demonstration"))
    page.get_by_role("button", name="Save as gesture").click()
    page.get_by_role("button", name="Save into the sample").click()
    page.get_by_label("Label").fill("our circle")
    page.get_by_label("Command").fill("Hold your depth")
    expect(page.get_by_text("Distance of the nearest gestures")).to_be_visible(
        timeout=EXTRACTION_MS
    )
    picture(page, "editor")
    page.get_by_role("button", name="Save gesture").click()
    expect(page.get_by_text("Gesture saved")).to_be_visible()
    expect(cards).to_have_count(9)

    # A clip of another diver is recognised; every voter's choice can be read. Not a circle again:
    # the language has two by now.
    upload(page, thin_clip("infinity-test-1"))
    page.get_by_label("Expected", exact=True).select_option("infinity")
    page.get_by_role("button", name="Recognise").click()
    lab = lab_of(page)
    table = page.get_by_role("table", name="Votes")
    expect(table).to_be_visible()
    support = support_in(table)
    assert len(support) == 9
    assert 95 <= sum(support.values()) <= 105
    silent = page.locator("#votes").get_by_text(re.compile(r"^\d+ comparisons? without weight"))
    without_weight = int(silent.inner_text().split()[0])
    assert table.locator("tbody tr").count() == len(MOTION_VOTERS) - without_weight
    page.get_by_role("button", name="Show the comparisons without weight").click()
    expect(table.locator("tbody tr")).to_have_count(len(MOTION_VOTERS))
    page.get_by_role("button", name="Hide the comparisons without weight").click()
    outcome = page.locator("#outcome")
    expect(outcome).to_have_text(re.compile(r"Recognised as .*distance [\d.]+"))
    winner = outcome.locator("b.chosen").inner_text()
    expect(table.locator("th.chosen")).to_have_attribute("title", re.compile(winner))
    expect(table.locator("th", has_text="expected")).to_have_attribute(
        "title", re.compile("infinity")
    )

    # Stepping moves the clock.
    clock = page.locator("#clock")
    at = first_shown(page, server)
    expect(clock).to_have_text(re.compile(rf"frame {at} of \d+$"))
    page.keyboard.press(",")
    expect(clock).to_have_text(re.compile(rf"frame {at - 1} of \d+$"))
    page.keyboard.press("Shift+.")
    expect(clock).to_have_text(re.compile(rf"frame {at + 9} of \d+$"))
    expect(page.locator(".toast")).to_have_count(0)
    assert picture(page, "studio").stat().st_size < 600_000
    # viser in a tab of its own has all of it, and follows; in the page's frame it has no panel.
    with page.context.expect_page() as opened:
        page.get_by_role("link", name="Open the scene in its own tab").click()
    alone = opened.value
    expect(alone.locator("canvas[data-engine]")).to_be_visible()
    expect(alone.get_by_text("Recognised as")).to_be_visible()
    compared = alone.get_by_role("img", name="trajectory image: infinity")
    expect(compared).to_be_visible()
    distances = alone.get_by_role("table", name="Votes")
    expect(distances.get_by_role("row", name="velocity")).to_be_visible()
    expect(alone.get_by_role("img", name="Vulcan salute, confidence")).to_be_visible()
    expect(alone.get_by_role("img", name=re.compile("Right wrist, torso lengths"))).to_be_visible()
    expect(lab.get_by_role("table", name="Votes")).to_be_hidden()
    # Another range has no answer yet.
    page.get_by_role("button", name="Start here").click()
    expect(alone.get_by_text("Not recognised yet")).to_be_visible()
    expect(distances).to_have_count(0)
    alone.close()
    page.get_by_role("button", name="Play", exact=True).click()
    expect(page.get_by_role("button", name="Pause", exact=True)).to_be_visible()

    # The language leaves as the file that a robot loads.
    page.get_by_role("button", name="Export").click()
    dialog = page.get_by_role("dialog", name="Export")
    expect(dialog.get_by_role("radio", name="OSG Studio language")).to_be_checked()
    dialog.get_by_text("What the robot needs").click()
    expect(dialog.get_by_text("left wrist, right wrist")).to_be_visible()
    expect(dialog.locator("#export-command")).to_have_text(
        "osg-studio robot --language Table-2-eight-signs.json --source 0"
    )
    picture(page, "export")
    with page.expect_download() as download:
        dialog.get_by_role("link", name="Download").click()
    exported = tmp_path / "exported.json"
    download.value.save_as(exported)
    language = Language.load(exported)
    assert language.labels[-1] == "our circle"
    assert language.gesture("our circle").command == "Hold your depth"
    assert len(language.gestures) == 9


def takes_so_far(server: Running, name: str) -> bool:
    """Return whether the server has found a take of the clip of this name."""
    for stored in server.studio.clips.all():
        if stored.clip.name == name:
            place = f"{server.address}/api/v1/clips/{stored.clip.id}/takes"
            answer = httpx.get(place, params={"so_far": True}, timeout=60)
            return answer.is_success and bool(answer.json())
    return False


def test_poses_that_are_being_found_can_be_cancelled_and_found_after_all(
    open_page: OpenPage, clips: Path, tmp_path: Path
) -> None:
    page = open_page(scene=False)
    # So long that it is cancelled before its end, however late the page learns of its beginning.
    drop(page, thinned(clips / "line-demonstration.mp4", tmp_path / "cancelled.mp4", times=12))
    item = page.get_by_role("list", name="Clips").get_by_role("listitem").first
    item.get_by_role("button", name="Cancel cancelled.mp4").click()
    expect(item.get_by_text("Cancelled before its poses were found")).to_be_visible()
    item.get_by_role("button", name="Retry cancelled.mp4").click()
    expect(item.get_by_role("progressbar")).to_be_visible()
    item.get_by_role("button", name="Cancel cancelled.mp4").click()
    expect(item.get_by_role("progressbar")).to_have_count(0)


@linux
def test_a_take_is_recognised_while_the_rest_of_its_clip_is_read(
    open_page: OpenPage,
    server: Running,
    sample_clips: Path,
    installed_models: None,
    tmp_path: Path,
) -> None:
    page = open_page(scene=False)
    page.get_by_label("Language", exact=True).select_option(label="Table 2: eight signs")
    clip = thinned(sample_clips / "line-test-2.mp4", tmp_path / "dive.mp4", times=4)
    drop(page, clip)
    # Held as soon as the server knows of a take; the page may learn of it much later.
    until(lambda: takes_so_far(server, "dive.mp4"))
    worker = hold_worker(os.getpid())
    expect(page.get_by_role("button", name=re.compile("^Take 1"))).to_be_visible()
    expect(page.locator("#clip-meta")).to_contain_text("Still being read")
    expect(page.locator("#save-gesture")).to_be_disabled()
    few = page.get_by_role("button", name=re.compile("^Take ")).count()
    page.get_by_role("button", name="Recognise").click()
    expect(page.locator("#outcome")).to_contain_text("line")
    os.kill(worker, signal.SIGCONT)
    expect(page.locator("#save-gesture")).to_be_enabled(timeout=EXTRACTION_MS)
    assert page.get_by_role("button", name=re.compile("^Take ")).count() > few
    expect(page.locator("#outcome")).to_contain_text("line")


def test_a_dropped_clip_is_misread_and_explained_stroke_by_stroke(
    open_page: OpenPage, sample_clips: Path, installed_models: None, tmp_path: Path, film: Film
) -> None:
    page = open_page(size=(1440, 900))
    page.get_by_label("Language", exact=True).select_option(label="Table 2: eight signs")
    expect(page.locator("#gestures")).to_contain_text("triangle")
    film(page, 1.0)
    drop(page, thinned(sample_clips / "unfinished-triangle.mp4", tmp_path / "triangle at 6 m.mp4"))
    expect(page.locator("#welcome progress")).to_be_visible()
    for _ in range(6):
        film(page, 0.3)
    expect(page.locator("#save-gesture")).to_be_enabled(timeout=EXTRACTION_MS)
    page.get_by_label("Expected", exact=True).select_option("triangle")
    lab_of(page)
    expect(page.locator("#lab-loading")).to_be_hidden()
    film(page, 1.2)
    page.get_by_role("button", name="Recognise").click()
    outcome = page.locator("#outcome")
    expect(outcome).to_contain_text("Recognised as wedge, expected triangle")
    why = page.get_by_role("region", name="Why")
    expect(why).to_contain_text("You showed: down right, up right, left")
    # An unfinished triangle, upside down, is no demonstration of one, and nothing else helps.
    expect(why.locator(".remedies")).to_have_count(0)
    film(page, 2.8)
    stroke = why.get_by_role("group", name="Strokes in words").get_by_role("button").first
    stroke.hover()
    film(page, 0.8)
    stroke.click()
    film(page, 2.4)
