"""The stage: the flat picture first, the cube beside it, and the whole decision in sight."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import httpx
import numpy as np
import pytest
from playwright.sync_api import Locator, Page, expect

from app.recognition.voters.registry import MOTION_VOTERS
from app.ui import workspace
from tests.api.recordings import recording_of
from tests.api.running import Running, client_of, until
from tests.browser.conftest import OpenPage
from tests.browser.library import Library, add_clip, library_of
from tests.browser.numbered_clips import corners_on, number_on, numbered_clip, painted_corners

WITHOUT_WEBGL = """
const original = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
  return kind.startsWith("webgl") ? null : original.call(this, kind, ...rest);
};
"""


@pytest.fixture
def library(server: Running, request: pytest.FixtureRequest) -> Iterator[Library]:
    with client_of(server.address) as client:
        # A short name: a long one takes lines of its own.
        yield library_of(server, client, request.node.name.removeprefix("test_")[:12])


@pytest.fixture
def numbered(server: Running, library: Library, tmp_path: Path) -> Library:
    """Return the library with a clip whose pictures carry their numbers."""
    video = tmp_path / "numbered.mp4"
    recording = recording_of("circle")
    times = np.array(numbered_clip(video, len(recording.poses)))
    recording = replace(recording, poses=replace(recording.poses, time=times))
    clip = add_clip(server, name="numbered.mp4", video=video, recording=recording)
    return replace(library, clip=clip)


def canvas_of(page: Page) -> Locator:
    """Return the canvas of viser's frame."""
    return page.frame_locator("#lab").locator("canvas[data-engine]")


def is_square(picture: Locator) -> Callable[[], bool]:
    """Return whether a picture lies square in its box and fills it."""

    def check() -> bool:
        corners = corners_on(picture.screenshot())
        return corners is not None and np.allclose(corners, painted_corners(), atol=0.02)

    return check


def test_the_flat_picture_comes_first_and_the_cube_is_a_key_away_and_remembered(
    open_page: OpenPage, numbered: Library, monkeypatch: pytest.MonkeyPatch
) -> None:
    page = open_page(numbered.address, size=(1440, 900))
    canvas = canvas_of(page)
    until(is_square(canvas))
    cube = page.get_by_role("button", name="Space-time cube")
    expect(cube).to_have_attribute("aria-pressed", "false")
    page.keyboard.press("v")
    expect(cube).to_have_attribute("aria-pressed", "true")
    until(lambda: not is_square(canvas)())
    page.reload()
    expect(cube).to_have_attribute("aria-pressed", "true")
    expect(page.locator("#lab-loading")).to_be_hidden()
    cube.click()
    until(is_square(canvas))
    page.reload()
    until(is_square(canvas))

    # The way to it is seen by those who welcome motion: slow enough here for screenshots.
    monkeypatch.setattr(workspace, "TRANSITION_SECONDS", 30.0)
    page.emulate_media(reduced_motion="no-preference")
    seen: set[bytes] = set()

    def is_on_the_way() -> bool:
        seen.add(canvas.screenshot())
        return len(seen) > 3

    page.keyboard.press("v")
    until(is_on_the_way)
    monkeypatch.setattr(workspace, "TRANSITION_SECONDS", 0.0)
    # With reduced motion, the way back is one step.
    page.emulate_media(reduced_motion="reduce")
    page.keyboard.press("v")
    until(is_square(canvas))


def test_answer_picture_drawings_and_first_voters_are_in_sight_and_nothing_jumps(
    open_page: OpenPage, server: Running, library: Library
) -> None:
    clip = add_clip(server, "circle", name="second dive of the team, left camera.mp4")
    page = open_page(library.address | {"clip": clip}, size=(1440, 900), scene=False)
    expect(page.get_by_role("button", name="Recognise", exact=True)).to_be_enabled()
    page.get_by_label("Expected", exact=True).select_option("line")
    before = page.locator("#lab-box").bounding_box()
    page.get_by_role("button", name="Recognise", exact=True).click()
    expect(page.get_by_role("region", name="Why")).to_contain_text("'line'")
    after = page.locator("#lab-box").bounding_box()
    assert before is not None
    assert after is not None
    assert after["y"] == pytest.approx(before["y"], abs=4)
    assert after["height"] >= 480
    table = page.get_by_role("table", name="Votes")
    for part in (
        page.locator("#lab-box"),
        page.locator("#outcome"),
        page.locator(".why-sentence"),
        page.get_by_role("img", name="Trajectory image: this take"),
        table.locator("tbody tr").first,
    ):
        expect(part).to_be_in_viewport(ratio=1)
    page.get_by_role("button", name="Show the comparisons without weight").click()
    expect(table.locator("tbody tr")).to_have_count(len(MOTION_VOTERS))


def test_tracks_and_once_there_is_an_answer_the_expected_stroke_lie_over_the_flat_picture(
    open_page: OpenPage, library: Library
) -> None:
    page = open_page(library.address, size=(1440, 900), scene=False)
    track = page.get_by_role("img", name="Track of the right wrist")
    page.get_by_role("button", name="Tracks", exact=True).click()
    expect(track).to_be_visible()
    expect(track.locator("path").first).to_have_attribute("d", re.compile("^M"))
    expect(page.get_by_role("img", name="Track of the left wrist")).to_have_count(0)
    page.reload()
    expect(track).to_be_visible()
    page.keyboard.press("g")
    expect(track).to_be_hidden()
    expect(page.get_by_role("button", name="Recognise", exact=True)).to_be_enabled()
    over = page.locator("#stroke-over")
    expect(over).to_be_hidden()
    page.get_by_role("button", name="Recognise", exact=True).click()
    expect(over.get_by_role("img")).to_have_accessible_name(
        "The stroke of circle, over the one shown"
    )
    expect(over).to_have_text("circle chosen")
    # The same circle is the language's: both strokes lie on each other in the picture.
    drawn = over.locator("path").first.evaluate("""path => {
        const { x, y, width, height } = path.getBBox();
        return [x, y, x + width, y + height];
    }""")
    poses = library.client.get(f"/api/v1/clips/{library.clip}/poses").json()
    (take,) = library.client.get(f"/api/v1/clips/{library.clip}/takes").json()
    wrist = np.array(
        [
            points[poses["landmarks"].index("right_wrist")]
            for points, at in zip(poses["xy"], poses["time"], strict=True)
            if take["stroke_start"] <= at <= take["stroke_end"]
        ],
        dtype=float,
    )
    shown = [*np.nanmin(wrist, axis=0), *np.nanmax(wrist, axis=0)]
    assert drawn == pytest.approx(shown, abs=0.1 * (shown[2] - shown[0]))
    assert over.bounding_box() == page.locator("#lab-box").bounding_box()

    page.get_by_role("button", name="line", exact=True).click()
    expect(over).to_have_text("line expected")
    page.keyboard.press("v")
    expect(over).to_be_hidden()


def test_on_a_phone_the_decision_on_eight_gestures_is_not_cut(
    open_page: OpenPage, library: Library
) -> None:
    for label in ("square", "wedge", "sweep", "infinity", "three", "triangle"):
        library.add_gesture(label)
    query = {**library.address, "recognition": library.recognise("circle")}
    page = open_page(query, size=(390, 844), scene=False)
    table = page.get_by_role("table", name="Votes")
    expect(table.locator("th.gesture")).to_have_count(8)
    expect(page.get_by_role("img", name="Trajectory image: this take")).to_be_visible()
    parts = page.locator("#votes *").evaluate_all("""all => all
        .filter((part) => part.getBoundingClientRect().right > innerWidth)
        .map((part) => part.outerHTML.slice(0, 80))""")
    assert parts == []


def test_a_refused_take_names_one_gesture_as_nearest_and_none_as_chosen(
    open_page: OpenPage, server: Running, library: Library
) -> None:
    clip = add_clip(server, "corner", name="corner.mp4")
    refused = replace(library, clip=clip)
    page = open_page(refused.address, size=(1440, 900), scene=False)
    for expected, role in ((None, "nearest"), ("circle", "expected"), ("line", "expected")):
        if expected:
            page.get_by_label("Expected", exact=True).select_option(expected)
        page.get_by_role("button", name="Recognise", exact=True).click()
        expect(page.locator("#outcome")).to_contain_text("Not recognised; nearest is circle")
        expect(page.locator("#stroke-over")).to_have_text(f"{expected or 'circle'} {role}")
        captions = page.locator("#votes figcaption")
        nearest = "nearest and expected" if expected == "circle" else "nearest"
        expect(captions.last).to_have_text(f"circle ({nearest})")
        expect(page.locator(".vote-table th.gesture").first).to_contain_text("circle")
        if expected:
            expect(page.get_by_role("region", name="Why")).to_contain_text(f"'{expected}'")
        expect(page.get_by_text(re.compile("chosen"))).to_have_count(0)


def test_without_webgl_the_page_draws_the_same_picture_and_says_why(
    open_page: OpenPage, numbered: Library
) -> None:
    page = open_page()
    page.add_init_script(WITHOUT_WEBGL)
    query = {**numbered.address, "recognition": numbered.recognise("circle")}
    page.goto(f"{page.url.split('?')[0]}?{httpx.QueryParams(query)}")
    expect(page.get_by_role("status").filter(has_text="offers no WebGL 2")).to_be_visible()
    expect(page.locator("#lab")).to_be_hidden()
    expect(page.get_by_role("table", name="Votes")).to_be_visible()
    clock, picture = page.locator("#clock"), page.locator("#flat .figure")
    expect(picture.locator(".trails path")).to_have_attribute("d", re.compile("^M"))
    expect(clock).to_have_text(re.compile(r"frame \d+ of"))
    video = picture.locator("video")
    # The trail and the gesture's stroke lie over the number.
    for over in (picture.locator(".figure-over"), page.locator("#stroke-over")):
        over.evaluate("(over) => { over.style.visibility = 'hidden'; }")

    def on_clock() -> int:
        return int(re.findall(r"frame (\d+)", clock.inner_text())[0])

    until(lambda: 0 < on_clock() == number_on(video.screenshot()))
    before = on_clock()
    page.keyboard.press(".")
    until(lambda: before + 1 == on_clock() == number_on(video.screenshot()))


def test_a_weight_is_tried_where_the_distances_are_shown(
    open_page: OpenPage, library: Library
) -> None:
    query = {**library.address, "recognition": library.recognise("circle")}
    page = open_page(query, size=(1440, 900), scene=False)
    weight = page.get_by_label(re.compile("^Weight of velocity:"))
    expect(weight).to_have_value("1")
    expect(page.locator("#outcome")).to_contain_text("distance 0")
    # The table ranks as the outcome does.
    table = page.get_by_role("table", name="Votes")
    expect(table.locator("th.gesture").first).to_contain_text("circle")
    expect(table.get_by_role("row").filter(has_text="distance")).to_be_visible()
    expect(table).not_to_contain_text("voter")
    joint = page.get_by_label("Joint whose paths are drawn")
    drawn = joint.input_value()
    weight.select_option("off")
    trial = page.get_by_role("region", name="Why").get_by_role("status")
    expect(trial).to_contain_text("without the comparison velocity")
    expect(page.get_by_label("Weight of velocity: 0 %")).to_have_value("0")
    expect(joint).to_have_value(drawn)
    language = f"/api/v1/languages/{library.language}"
    assert library.client.get(language).json()["tuning"] is None
    trial.get_by_role("button", name="Keep").click()
    expect(page.locator("#tuning")).to_be_visible()
    assert library.client.get(language).json()["tuning"]["weights"] == {"velocity": 0.0}


def test_one_click_turns_the_picture_of_a_diver_who_lies_on_the_side(
    open_page: OpenPage, server: Running
) -> None:
    recording = recording_of("circle")
    upright = recording.poses
    width, height = upright.frame_size
    lying = np.stack([upright.xy[..., 1], width - upright.xy[..., 0]], axis=-1)
    poses = replace(upright, xy=lying, frame_size=(height, width))
    told = "the diver lies on the side; turn the picture by 90 degrees clockwise (--turn 90)"
    shown = replace(recording, poses=poses, warnings=("no face", told))
    clip = add_clip(server, name="lying.mp4", recording=shown)
    page = open_page({"clip": clip}, scene=False)
    note = page.locator("#clip-warnings li").filter(has_text="lies on the side")
    button = note.get_by_role("button", name="Turn the picture by 90°")
    with page.expect_response(lambda answer: answer.url.endswith(f"/{clip}/turn")) as answered:
        button.click()
    assert answered.value.status == 202
    expect(page.locator("#clips .chosen .clip-open")).to_have_attribute(
        "title", f"lying.mp4, {width} \u00d7 {height} pixels"
    )
    expect(page.locator("#clip-warnings")).to_contain_text("was turned by 90°", timeout=60_000)
    expect(page.get_by_role("button", name="Turn it back")).to_be_visible()
    expect(button).to_have_count(0)
