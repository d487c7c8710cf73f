"""The page: links, tabs, undo, files, names with markup, and error messages."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import Page, Route, expect

from app.recognition.language.file import short_code
from tests.api.running import Running
from tests.browser.conftest import OpenPage
from tests.browser.files import drop
from tests.browser.library import Library, add_clip
from tests.recognition.damaged_clips import write_clip

MARKUP = '<img src=x onerror="window.broken=1">'


def workspace_of(page: Page) -> str:
    """Return the address of the tab's workspace, as soon as it has one."""
    frame = page.locator("#lab")
    expect(frame).to_have_attribute("src", re.compile(r"^viser/[\w-]"))
    return str(frame.get_attribute("src"))


def test_a_key_pressed_right_after_a_tab_counts_and_a_missing_camera_is_explained(
    open_page: OpenPage,
) -> None:
    page = open_page(scene=False)
    page.get_by_role("link", name="Live").click()
    page.keyboard.press("Space")
    problem = page.locator("#view-live .camera-problem")
    expect(problem).to_contain_text("No camera found")
    expect(problem).to_contain_text("play a clip as if live")
    expect(problem.get_by_role("button", name="Try again")).to_be_visible()
    expect(page.get_by_role("link", name="Live")).to_be_focused()


def test_a_link_shows_the_same_with_its_images_and_a_reload_keeps_the_workspace(
    open_page: OpenPage, library: Library
) -> None:
    query = {**library.address, "recognition": library.recognise("line")}
    page = open_page(query, scene=False)
    outcome = page.locator("#outcome")
    expect(outcome).to_contain_text("Recognised as circle, expected line")
    expect(page.get_by_role("table", name="Votes")).to_be_visible()
    expect(page.get_by_label("Expected", exact=True)).to_have_value("line")
    expect(page.get_by_role("button", name=re.compile("^Take 1"))).to_have_attribute(
        "aria-pressed", "true"
    )
    check_start_and_direction(page)
    workspace = workspace_of(page)
    page.reload()
    expect(outcome).to_contain_text("Recognised as circle, expected line")
    assert workspace_of(page) == workspace


def check_start_and_direction(page: Page) -> None:
    """Check that cards and compared images show where a movement begins and leads to."""
    for name in ("Trajectory of circle, from the dot along the arrow", "Trajectory image: this"):
        image = page.get_by_role("img", name=name)
        expect(image).to_be_visible()
        coloured = image.evaluate(
            """async (image) => {
              await image.decode();
              const canvas = document.createElement("canvas");
              [canvas.width, canvas.height] = [image.naturalWidth, image.naturalHeight];
              const context = canvas.getContext("2d");
              context.drawImage(image, 0, 0);
              const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
              let count = 0;
              for (let i = 0; i < data.length; i += 4) count += data[i + 2] > data[i] + 60;
              return count;
            }"""
        )
        assert coloured > 100


def test_a_link_is_copied_and_says_when_what_it_shows_is_gone(
    open_page: OpenPage, server: Running, library: Library
) -> None:
    clip = add_clip(server, "circle", "line", name="two takes.mp4")
    for number in range(6):
        add_clip(server, name=f"other {number}.mp4")
    page = open_page({**library.address, "clip": clip}, scene=False)
    clips = page.get_by_role("list", name="Clips").get_by_role("listitem")
    find = page.get_by_label("Find clips")
    find.fill("Two T")
    expect(clips).to_have_count(1)
    find.fill("no such clip")
    expect(page.get_by_text("No clip is called")).to_be_visible()
    find.fill("")
    expect(page.get_by_role("button", name="Show two takes.mp4")).to_be_in_viewport()
    find.blur()
    expect(page.get_by_role("button", name=re.compile("^Take 1"))).to_have_attribute(
        "aria-pressed", "true"
    )
    expect(page.locator("#clock")).to_have_text(re.compile("frame"))
    page.keyboard.press("t")
    expect(page.get_by_role("button", name=re.compile("^Take 2"))).to_have_attribute(
        "aria-pressed", "true"
    )
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    page.get_by_role("button", name="Copy a link to this view").click()
    expect(page.get_by_text("Link copied")).to_be_visible()
    link = page.evaluate("navigator.clipboard.readText()")
    assert f"clip={clip}&take=1" in link
    library.client.delete(f"/api/v1/clips/{clip}").raise_for_status()
    colleague = open_page(scene=False, alone=True)
    colleague.goto(link)
    expect(colleague.get_by_role("alert").get_by_text("The clip of this link")).to_be_visible()


def test_two_tabs_are_two_workspaces_and_hear_of_each_others_changes(
    open_page: OpenPage, library: Library
) -> None:
    query = {**library.address, "recognition": library.recognise()}
    first, second = open_page(query, scene=False), open_page(library.address, scene=False)
    expect(first.get_by_role("table", name="Votes")).to_be_visible()
    expect(second.get_by_text("No decision yet")).to_be_visible()
    card = second.get_by_role("list", name="Gestures").get_by_role("listitem").nth(1)
    card.hover()
    card.get_by_role("button", name="Change line", exact=True).click()
    expect(second.get_by_label("Label")).to_have_value("line")
    second.get_by_label("Label").fill("straight")
    second.get_by_role("button", name="Save", exact=True).click()
    for page in (first, second):
        expect(page.get_by_role("img", name="Trajectory of straight")).to_be_visible()


def test_a_duplicated_tab_gets_a_workspace_of_its_own(open_page: OpenPage) -> None:
    first = open_page(scene=False)
    workspace = workspace_of(first)
    # Like the browser's command to duplicate a tab, this copies the tab's sessionStorage.
    with first.expect_popup() as opened:
        first.evaluate("open(location.href)")
    assert workspace_of(opened.value) != workspace
    first.reload()
    assert workspace_of(first) == workspace


def test_the_slate_is_fetched_as_a_pdf_and_an_svg_beside_the_code_that_a_robot_shows(
    open_page: OpenPage, library: Library, tmp_path: Path
) -> None:
    page = open_page(library.address, scene=False)
    exported = library.client.get(f"/api/v1/languages/{library.language}/export").json()
    code = short_code(exported["sha256"])
    expect(page.locator("#carried")).to_contain_text(f"A robot that has revision 3 shows {code}")
    page.get_by_role("button", name="Export").click()
    dialog = page.get_by_role("dialog", name="Export")
    expect(dialog).to_contain_text(f"code {code}")
    files = {}
    for kind in ("PDF", "SVG"):
        with page.expect_download() as download:
            dialog.get_by_role("link", name=kind, exact=True).click()
        # Named like the language file, which a shell takes without quotes.
        assert re.fullmatch(rf"[\w.-]+\.{kind.lower()}", download.value.suggested_filename)
        files[kind] = tmp_path / download.value.suggested_filename
        download.value.save_as(files[kind])
    assert files["PDF"].read_bytes().startswith(b"%PDF-")
    # The browser draws it: each gesture by its name, with strokes that begin at a dot.
    page.goto(files["SVG"].as_uri())
    for text in ("circle", "line", "R"):
        expect(page.locator("text").get_by_text(text, exact=True).first).to_be_visible()
    expect(page.locator("polygon").first).to_be_visible()  # an arrow's head


def card_of(label: str) -> str:
    """Return the alternative text of a gesture's card."""
    return f"Trajectory of {label}, from the dot along the arrow"


def press(page: Page, name: str) -> None:
    """Press a button by the keyboard, because the last message may cover it for a while."""
    page.get_by_role("button", name=name, exact=True).focus()
    page.keyboard.press("Enter")


def test_gestures_are_shown_renamed_and_deleted_whatever_their_label(
    open_page: OpenPage, library: Library
) -> None:
    labels = ["../a", "./a", "a/", "%2e%2e", "\U0001f42c" * 40]
    for label in labels:
        library.add_gesture(label)
    library.add_gesture("plain")
    page = open_page(library.address, scene=False)
    cards = page.get_by_role("list", name="Gestures").get_by_role("listitem")
    expect(cards).to_have_count(3 + len(labels))
    before = "plain"
    for deleted, label in enumerate(labels, 1):
        image = page.get_by_role("img", name=card_of(label), exact=True)
        image.scroll_into_view_if_needed()
        page.wait_for_function("image => image.naturalWidth > 0", arg=image.element_handle())
        press(page, f"Delete {label}")
        expect(cards).to_have_count(3 + len(labels) - deleted)
        # The label is free now, and another gesture can have it.
        press(page, f"Change {before}")
        page.get_by_label("Label").fill(label)
        page.get_by_role("button", name="Save", exact=True).click()
        expect(page.get_by_role("img", name=card_of(label), exact=True)).to_be_visible()
        before = label
    assert library.client.get(f"/api/v1/languages/{library.language}").status_code == 200


def test_a_deleted_clip_comes_back(open_page: OpenPage, library: Library) -> None:
    page = open_page(library.address, scene=False)
    title = page.get_by_role("heading", level=1)
    name = title.inner_text()
    page.get_by_role("button", name=f"Delete {name}").click()
    expect(page.get_by_role("button", name=f"Show {name}")).to_have_count(0)
    expect(page.locator("#clips .chosen")).to_have_count(1)
    page.get_by_role("button", name="Undo").click()
    expect(page.get_by_role("button", name=f"Show {name}")).to_have_attribute(
        "aria-pressed", "true"
    )


def test_a_label_that_is_taken_is_refused_in_the_editor(
    open_page: OpenPage, library: Library
) -> None:
    page = open_page(library.address, scene=False)
    page.get_by_role("button", name="Save as gesture").click()
    label = page.get_by_role("textbox", name="Label")
    label.fill("")
    save = page.get_by_role("button", name="Save gesture")
    for written, problem in (
        ("   ", "Label is empty; type one."),
        ("..", "Write the label in letters or digits."),
        ("<b>x</b>", "Leave out < and >."),
    ):
        label.fill(written)
        expect(page.locator("#editor-label-note")).to_have_text(problem)
        expect(save).to_be_disabled()
    label.fill("o" * 200)
    expect(label).to_have_value("o" * 80)
    expect(page.get_by_role("alert").filter(has_text="At most 80 letters")).to_be_visible()
    expect(save).to_be_enabled()
    label.fill("circle")
    expect(page.get_by_role("button", name="Add to circle")).to_be_visible()
    page.get_by_role("button", name="Cancel").click()
    page.get_by_role("button", name="Discard", exact=True).click()
    expect(page.get_by_role("button", name="Save as gesture")).to_be_visible()
    page.goto(f"{page.url}&view=gesture&gesture=line")
    label.fill("circle")
    expect(page.get_by_text("There is a gesture \u201ccircle\u201d already")).to_be_visible()
    expect(page.get_by_role("button", name="Save", exact=True)).to_be_disabled()


def test_a_range_can_be_chosen_by_hand_with_the_keyboard(
    open_page: OpenPage, library: Library
) -> None:
    page = open_page(library.address, scene=False)
    start = page.get_by_role("slider", name="Start of the range")
    (take,) = library.client.get(f"/api/v1/clips/{library.clip}/takes").json()
    times = library.client.get(f"/api/v1/clips/{library.clip}/timeline").json()["time"]
    frame = times.index(take["start"])
    expect(start).to_have_attribute("aria-valuetext", f"frame {frame}, {take['start']:.2f} s")
    start.focus()
    page.keyboard.press("ArrowRight")
    moved = times[frame + 1]
    expect(page.get_by_text(f"Range by hand: {moved:.2f} s")).to_be_visible()
    expect(page).to_have_url(re.compile(f"start={round(moved, 3):g}"))
    page.get_by_role("button", name="Back to 1 take").click()
    expect(page.get_by_text("Take 1 of 1")).to_be_visible()


def test_what_is_expected_is_proposed_by_the_clips_name_forgotten_with_it_and_waits_for_takes(
    open_page: OpenPage, server: Running, library: Library
) -> None:
    add_clip(server, "line", name="late.mp4")
    add_clip(server, "line", name="line-test-1.mp4")
    page = open_page(library.address, scene=False)
    expected = page.get_by_label("Expected", exact=True)
    expect(expected).to_be_enabled()
    expect(expected).to_have_value("")
    page.get_by_role("button", name="Show line-test-1.mp4").click()
    expect(expected).to_have_value("line")
    expected.select_option("circle")
    page.get_by_role("button", name="Recognise").click()
    outcome = page.locator("#outcome")
    expect(outcome).to_contain_text("Recognised as line, expected circle")
    page.get_by_role("button", name=re.compile(r"^Show test_what.*(?<!line)\.mp4")).click()
    expect(expected).to_have_value("")
    expect(outcome).to_be_empty()

    # Nothing acts on another clip before its own takes are there.
    expect(page.get_by_text("Take 1 of 1")).to_be_visible()
    held: list[Route] = []
    page.route("**/takes", lambda route: held.append(route))
    page.get_by_role("button", name="Show late.mp4").click()
    recognise = page.get_by_role("button", name="Recognise")
    expect(recognise).to_be_disabled()
    expect(page.get_by_role("button", name="Save as gesture")).to_be_disabled()
    while not held:
        page.wait_for_timeout(10)
    held[0].continue_()
    expect(recognise).to_be_enabled()


def test_what_is_expected_is_proposed_once_the_language_is_there(
    open_page: OpenPage, server: Running, library: Library
) -> None:
    add_clip(server, "line", name="line-late.mp4")
    page = open_page({"language": library.language}, scene=False)
    expect(page.get_by_text("Take 1 of 1")).to_be_visible()
    held: list[Route] = []
    # A repeated request is not held back.
    page.route(
        f"**/languages/{library.language}",
        lambda route: route.fallback() if held else held.append(route),
    )
    page.reload()
    page.get_by_role("button", name="Show line-late.mp4").click()
    while not held:
        page.wait_for_timeout(10)
    held[0].continue_()
    expect(page.get_by_label("Expected", exact=True)).to_have_value("line")


@pytest.mark.withstands(row="H15")
def test_names_with_markup_are_text_everywhere(
    open_page: OpenPage, server: Running, library: Library
) -> None:
    clip = add_clip(server, "circle", name=f"{MARKUP}.mp4")
    library.add_gesture(MARKUP, clip, description=MARKUP)
    marked = Library(clip, library.language, library.client)
    page = open_page({**marked.address, "recognition": marked.recognise(MARKUP)})
    expect(page.get_by_role("table", name="Votes")).to_contain_text(MARKUP)
    expect(page.get_by_role("list", name="Gestures")).to_contain_text(MARKUP)
    expect(page.locator("#outcome")).to_be_visible()
    for frame in page.frames:
        assert frame.evaluate("window.broken") is None
        assert frame.locator("img[src=x]").count() == 0


def test_dropped_clips_are_added_and_the_first_is_shown_but_broken_files_are_explained(
    open_page: OpenPage, tmp_path: Path
) -> None:
    names = ("one.mp4", "two.mp4", "three.mp4")
    page = open_page(scene=False)
    drop(page, *(write_clip(tmp_path / name) for name in names))
    for name in names:
        expect(page.get_by_role("button", name=f"Show {name}")).to_be_visible()
    expect(page.get_by_role("list", name="Uploads").get_by_role("listitem")).to_have_count(0)
    expect(page.get_by_role("button", name="Show one.mp4")).to_have_attribute(
        "aria-pressed", "true"
    )
    bad = tmp_path / "bad.json"
    bad.write_text('{"format": "osg-studio/gesture-language", "version": 99}')
    drop(page, bad)
    problem = page.get_by_role("alert").filter(has_text="Importing bad.json failed")
    expect(problem).to_contain_text("99")
    fake = tmp_path / "holiday.mp4"
    fake.write_text("<script>window.broken = 1</script>")
    drop(page, fake)
    item = page.get_by_role("list", name="Uploads").get_by_role("listitem")
    expect(item.get_by_role("button", name="Retry holiday.mp4")).to_be_visible()
    expect(item).to_contain_text("It is neither a video")
    item.get_by_role("button", name="Dismiss holiday.mp4").click()
    expect(item).to_have_count(0)


def test_a_view_that_does_not_load_says_so_and_can_be_tried_again(
    open_page: OpenPage, library: Library
) -> None:
    page = open_page()
    page.context.route("**/viser/**", lambda route: route.fulfill(status=502, body="Bad gateway"))
    page.reload()
    problem = page.get_by_role("alert").filter(has_text="The 3D view did not load")
    expect(problem).to_be_visible()
    page.context.unroute("**/viser/**")
    problem.get_by_role("button", name="Try again").click()
    expect(problem).to_have_count(0)
    expect(page.frame_locator("#lab").locator("canvas[data-engine]")).to_be_visible()
