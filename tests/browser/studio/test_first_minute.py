"""The first minute: what a salute is, the example, and a language of one's own."""

from __future__ import annotations

import re
from pathlib import Path

import httpx
import pytest
from playwright.sync_api import Browser, Page, Route, expect

from app.recognition import Recording
from app.settings import Settings
from tests.api.running import Running, running, until
from tests.browser.conftest import WITHOUT_SCENE, EmptyFrames, OpenPage
from tests.browser.library import add_clip
from tests.conftest import RECORDINGS

SAMPLE = "Table 2: eight signs"

MISREAD = "unfinished-triangle"
"""Name of the example's clip."""


def sample_id(client: httpx.Client) -> str:
    """Return the id of the sample language."""
    listed = client.get("/api/v1/languages").json()
    return next(str(each["id"]) for each in listed if each["name"] == SAMPLE)


def add_example(server: Running, clips: Path) -> None:
    """Add the example's clip, unless it exists; finding poses is tested elsewhere."""
    video = clips / f"{MISREAD}.mp4"
    if not any(each.clip.name == video.name for each in server.studio.clips.all()):
        found = Recording.load(RECORDINGS / "avx512" / f"{MISREAD}.npz")
        add_clip(server, name=video.name, video=video, recording=found)


def test_the_start_shows_a_salute_and_the_example_stays_at_hand(
    open_page: OpenPage, server: Running, clips: Path
) -> None:
    page = open_page(scene=False)
    expect(page.get_by_role("button", name="Film: a circle")).to_be_visible()
    start = page.locator("#welcome")
    expect(start).to_contain_text("the take, what lies between the salutes")
    words = page.locator("#view-studio").inner_text()
    assert [word for word in ("voter", "code", "Revision") if word in words] == []
    # On a phone the page scrolls, and nothing within it.
    page.set_viewport_size({"width": 390, "height": 844})
    assert start.evaluate("(box) => box.scrollHeight <= box.clientHeight")
    page.set_viewport_size({"width": 1280, "height": 800})
    add_example(server, clips)
    add_clip(server, "circle", name="mine.mp4")
    page.reload()
    expect(page.get_by_role("heading", name="mine.mp4")).to_be_visible()
    page.get_by_role("button", name="All keys").click()
    page.get_by_role("button", name="Example").click()
    why = page.get_by_role("region", name="Why")
    # The strokes in words show at a glance that the take is upside down and unfinished.
    strokes = why.get_by_role("group", name="Strokes in words")
    expect(strokes).to_contain_text("You showed: down right, up right, left")
    expect(strokes).to_contain_text("'triangle': down left, right, up left")
    expect(strokes.locator(".differs")).to_have_text(["down right", "down left"])
    strokes.get_by_role("button", name="up right").click()
    expect(page.locator("#clock")).to_have_text(re.compile(r"^3\.[4-9]"))


def test_after_seven_strokes_the_rest_is_folded_and_gestures_that_are_alike_lead_to_health(
    open_page: OpenPage, server: Running, clips: Path
) -> None:
    def change(route: Route) -> None:
        answer = route.fetch()
        why = answer.json()
        cause = {"kind": "near_gesture", "sentence": "They are nearly alike.", "start": None}
        why.update(causes=[cause], sentence=cause["sentence"], blame=[])
        word = why["strokes"][0][1]
        words = [word | {"text": f"stroke {n}"} for n in range(9)]
        more = word | {"text": ", then 2 more", "start": None, "folded": words[7:]}
        why["strokes"][0] = [*words[:7], more]
        route.fulfill(response=answer, json=why)

    add_example(server, clips)
    page = open_page(scene=False)
    page.route("**/explanation*", change)
    page.get_by_role("button", name="All keys").click()
    page.get_by_role("button", name="Example").click()
    shown = page.get_by_role("group", name="Strokes in words").locator("p").first
    expect(shown.get_by_role("button", name="stroke 6")).to_be_visible()
    expect(shown.get_by_role("button", name="stroke 8")).to_be_hidden()
    shown.get_by_text("then 2 more").click()
    expect(shown.get_by_role("button", name="stroke 8")).to_be_visible()
    page.get_by_role("button", name="Change one in Health").click()
    expect(page.locator("#view-health")).to_be_visible()


def test_the_tour_shows_its_steps_on_the_example(
    open_page: OpenPage, server: Running, clips: Path
) -> None:
    add_example(server, clips)
    page = open_page(scene=False)
    expect(page.get_by_text("Connected")).to_be_visible()
    # As on a first visit, whatever clips other tests left.
    page.evaluate(
        "import(document.scripts[0].src.replace('main.js', 'core/state.js'))"
        ".then(({ update }) => update({ clip: null }))"
    )
    page.keyboard.press("?")
    page.get_by_role("button", name="Tour").click()
    tour = page.locator(".tour")
    for number in (1, 2):
        expect(tour).to_contain_text(f"{number} of 5")
        page.keyboard.press("Enter")
    tour.get_by_role("button", name="Open the example").click()
    # The tour points at elements that appear, and the focus stays where it was.
    expect(page.get_by_role("region", name="Why")).to_contain_text("'triangle'")
    expect(tour.get_by_role("button", name="Open the example")).to_have_count(0)
    expect(tour.get_by_role("button", name="Next")).to_be_focused()
    page.keyboard.press("Enter")
    expect(tour).to_contain_text("4 of 5")
    why, ring = (page.locator(each).bounding_box() for each in ("#why", "#tour-ring"))
    assert why is not None
    assert ring is not None
    assert ring["y"] == pytest.approx(why["y"] - 4, abs=2)


def without_clips(page: Page) -> bool:
    """Show the start as on a first visit; the list that is being loaded may undo it."""
    page.evaluate(
        "import(document.scripts[0].src.replace('main.js', 'core/state.js'))"
        ".then(({ update }) => update({ clip: null, clips: [] }))"
    )
    page.wait_for_timeout(500)
    return page.locator(".question").is_visible()


def test_the_tour_frames_what_it_speaks_of_and_never_covers_it(
    open_page: OpenPage, server: Running, clips: Path
) -> None:
    add_example(server, clips)
    page = open_page({"view": "studio"}, scene=False)
    expect(page.locator("#connection")).to_contain_text("Connected")
    until(lambda: without_clips(page))
    check_tour(page)
    page.keyboard.press("?")
    page.get_by_role("button", name="Example").click()
    expect(page.get_by_role("region", name="Why")).to_contain_text("'triangle'")
    expect(page.locator("#stroke-over")).to_be_visible()
    check_tour(page)


def check_tour(page: Page) -> None:
    """Check where the tour and what it frames are, on several screens."""
    tour, ring = page.locator(".tour"), page.locator("#tour-ring")
    for width, height in ((1440, 900), (1024, 768), (768, 1024), (390, 844)):
        page.set_viewport_size({"width": width, "height": height})
        page.keyboard.press("?")
        page.get_by_role("button", name="Tour").click()
        for number in range(1, 5):
            tour.get_by_role("button", name="Show me" if number == 1 else "Next").click()
            expect(tour).to_contain_text(f"{number + 1} of 5")
            expect(tour).to_be_in_viewport(ratio=1)
            expect(ring).to_be_in_viewport(ratio=0.9)
            card, framed = tour.bounding_box(), ring.bounding_box()
            assert card is not None
            assert framed is not None
            assert (
                card["x"] >= framed["x"] + framed["width"]
                or framed["x"] >= card["x"] + card["width"]
                or card["y"] >= framed["y"] + framed["height"]
                or framed["y"] >= card["y"] + card["height"]
            ), (number, width, card, framed)
        page.keyboard.press("Escape")


def test_the_first_gesture_goes_into_a_language_of_ones_own_unless_the_sample_is_chosen(
    open_page: OpenPage, server: Running, client: httpx.Client
) -> None:
    clip = add_clip(server, "circle", name="own.mp4")
    query = {"clip": clip, "language": sample_id(client)}
    page = open_page(query, scene=False)
    page.get_by_role("button", name="Save as gesture").click()
    dialog = page.get_by_role("dialog", name="New language")
    expect(dialog).to_contain_text("is a sample")
    dialog.get_by_label("Name").fill("Our dive")
    dialog.get_by_role("button", name="Create").click()
    expect(page.get_by_role("heading", name="New gesture")).to_be_visible()
    expect(page.locator(".in-language")).to_have_text("in Our dive")

    page = open_page(query, scene=False)
    page.get_by_role("button", name="Save as gesture").click()
    page.get_by_role("button", name="Save into the sample").click()
    expect(page.locator(".in-language")).to_have_text(f"in {SAMPLE}")


def test_a_film_shows_how_a_gesture_is_made_and_what_is_not_ones_own_is_folded(
    browser: Browser, tmp_path: Path
) -> None:
    with running(Settings(data_dir=tmp_path), EmptyFrames) as server:
        context = browser.new_context(base_url=server.address)
        context.add_cookies([{"name": WITHOUT_SCENE, "value": "1", "url": server.address}])
        context.add_init_script("localStorage.setItem('osg-studio.tour', 'seen')")
        page = context.new_page()
        page.goto("/")
        film = page.get_by_role("button", name="Film: a circle")
        expect(film).to_be_in_viewport(ratio=1)
        video = film.locator("video")
        for name in ("muted", "loop"):
            expect(video).to_have_js_property(name, True)
        until(lambda: bool(video.evaluate("(film) => !film.paused && film.currentTime > 0.5")))
        film.click()
        expect(video).to_have_js_property("paused", True)
        # Who wants no motion sees the end, with the drawing, until a click.
        page.emulate_media(reduced_motion="reduce")
        page.reload()
        until(lambda: bool(video.evaluate("(film) => film.currentTime > 3")))
        expect(video).to_have_js_property("paused", True)

        folded = page.get_by_text("of the sample \u201cTable 2: eight signs\u201d")
        expect(folded).to_be_visible()
        expect(page.get_by_role("list", name="Gestures")).to_be_hidden()
        folded.click()
        expect(page.get_by_role("list", name="Gestures").get_by_role("listitem")).to_have_count(8)
        page.reload()
        expect(page.get_by_role("list", name="Gestures")).to_be_hidden()
        # With a clip of one's own the gestures are what it is compared with.
        add_clip(server, "circle", name="mine.mp4")
        page.reload()
        expect(page.get_by_role("list", name="Gestures").get_by_role("listitem")).to_have_count(8)
        expect(page.get_by_text("Takes lie between two salutes.", exact=True)).to_be_visible()
        context.close()
