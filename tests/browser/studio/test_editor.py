"""Editing a gesture: previewed before it is saved, undone, and never lost."""

from __future__ import annotations

from typing import Any

from playwright.sync_api import Locator, Page, expect

from tests.api.running import Running
from tests.browser.conftest import OpenPage
from tests.browser.library import Library, add_clip


def gesture(library: Library, label: str) -> dict[str, Any]:
    members = library.client.get(f"/api/v1/languages/{library.language}").json()["gestures"]
    return next(member for member in members if member["label"] == label)


def revision(library: Library) -> int:
    return int(library.client.get(f"/api/v1/languages/{library.language}").json()["revision"])


def editing(open_page: OpenPage, library: Library, label: str = "circle") -> Page:
    page = open_page(library.address | {"view": "gesture", "gesture": label}, scene=False)
    expect(page.get_by_role("heading", name=f"Edit {label}")).to_be_visible()
    expect(page.get_by_text("Distance of the nearest gestures")).to_be_visible()
    return page


def keypoint(page: Page, name: str) -> Locator:
    return page.get_by_role("list", name="Keypoints").get_by_role("checkbox", name=name)


def test_a_take_becomes_a_gesture_seen_before_it_is_saved(
    open_page: OpenPage, library: Library
) -> None:
    page = open_page(library.address, scene=False)
    page.get_by_role("button", name="Save as gesture").click()
    expect(page.get_by_label("Label")).to_be_focused()
    expect(page.get_by_role("list", name="Nearest gestures")).to_contain_text("circle")
    expect(page.get_by_role("region", name="Trajectory image")).to_contain_text("Strokes: ")
    page.keyboard.type("ring")
    page.get_by_label("Command").fill('{"move": ')
    page.get_by_role("button", name="Save gesture").click()
    expect(page.get_by_role("alert").filter(has_text="JSON object but is none")).to_be_visible()
    page.get_by_label("Command").fill('{"move": [1, 0]}')
    page.get_by_role("group", name="Mirror").get_by_text("On", exact=True).click()
    page.get_by_role("button", name="Save gesture").click()
    expect(page.get_by_text("Gesture saved")).to_be_visible()
    saved = gesture(library, "ring")
    strokes = saved["demonstrations"][0]["strokes"]
    assert "loop" in strokes
    expect(page.get_by_text(f"ring: {strokes}")).to_be_visible()
    expect(page.get_by_role("listitem").filter(has_text="ring")).to_contain_text(strokes)
    assert saved["command"] == {"move": [1, 0]}
    assert saved["mirror"] == "on"
    page.keyboard.press("Control+z")
    expect(page.get_by_text("New gesture ring", exact=True)).to_be_visible()
    assert "ring" not in [each["label"] for each in _gestures(library)]


def _gestures(library: Library) -> list[dict[str, object]]:
    answer = library.client.get(f"/api/v1/languages/{library.language}").json()
    gestures: list[dict[str, object]] = answer["gestures"]
    return gestures


def test_keypoints_are_switched_and_the_draft_is_undone_step_by_step_and_saved_as_one_revision(
    open_page: OpenPage, library: Library
) -> None:
    page = editing(open_page, library)
    before = revision(library)
    drawing = page.get_by_role("img", name="Trajectory image")
    first = drawing.get_attribute("src")
    expect(keypoint(page, "right wrist")).to_be_checked()
    page.locator("circle[data-landmark=left_wrist]").click()
    expect(keypoint(page, "left wrist")).to_be_checked()
    expect(drawing).not_to_have_attribute("src", str(first))
    keypoint(page, "left wrist").uncheck()
    expect(drawing).to_have_attribute("src", str(first))
    keypoint(page, "right wrist").click()
    expect(page.get_by_role("alert").filter(has_text="At least one keypoint")).to_be_visible()
    assert revision(library) == before

    page.get_by_label("Description").fill("round")
    page.locator("circle[data-landmark=left_wrist]").click()
    page.get_by_role("group", name="Direction").get_by_text("Off").click()
    expect(page.get_by_text("Draft, not saved yet")).to_be_visible()
    page.keyboard.press("Control+z")
    expect(
        page.get_by_role("group", name="Direction").get_by_role("radio", name="Auto")
    ).to_be_checked()
    page.keyboard.press("Control+z")
    expect(keypoint(page, "right wrist")).to_be_checked()
    page.keyboard.press("Control+Shift+z")
    expect(keypoint(page, "left wrist")).to_be_checked()
    page.get_by_role("button", name="Save", exact=True).click()
    expect(page.get_by_text("Gesture saved")).to_be_visible()
    saved = gesture(library, "circle")
    assert saved["description"] == "round"
    assert saved["direction"] == "auto"
    assert saved["salient"] == ["left_wrist", "right_wrist"]
    assert revision(library) == before + 1
    page.keyboard.press("Control+z")
    expect(page.get_by_text("Change of circle", exact=True)).to_be_visible()
    assert gesture(library, "circle")["description"] == ""


def test_a_draft_survives_a_reload_and_leaving_it_asks_first(
    open_page: OpenPage, library: Library
) -> None:
    page = open_page(library.address, scene=False)
    page.get_by_role("button", name="Change circle", exact=True).click()
    page.get_by_label("Description").fill("half finished")
    page.go_back()
    page.get_by_role("button", name="Go on editing").click()
    expect(page.get_by_label("Description")).to_have_value("half finished")
    page.reload()
    expect(page.get_by_label("Description")).to_have_value("half finished")
    page.get_by_role("button", name="Discard the draft").click()
    expect(page.get_by_label("Description")).to_have_value("")
    page.reload()
    expect(page.get_by_role("heading", name="Edit circle")).to_be_visible()
    expect(page.get_by_text("is restored")).to_be_hidden()

    page.get_by_role("button", name="Cancel").click()
    page.get_by_role("button", name="Change circle", exact=True).click()
    page.get_by_label("Description").fill("round")
    page.get_by_role("link", name="Languages").click()
    page.get_by_role("button", name="Go on editing").click()
    expect(page.get_by_role("heading", name="Edit circle")).to_be_visible()
    page.get_by_role("button", name="Cancel").click()
    page.get_by_role("button", name="Keep the draft").click()
    page.get_by_role("button", name="Change circle", exact=True).click()
    expect(page.get_by_label("Description")).to_have_value("round")
    page.get_by_role("button", name="Cancel").click()
    page.get_by_role("button", name="Discard", exact=True).click()
    page.get_by_role("button", name="Change circle", exact=True).click()
    expect(page.get_by_label("Description")).to_have_value("")


def test_a_draft_survives_that_its_language_is_deleted_elsewhere(
    open_page: OpenPage, library: Library
) -> None:
    page = editing(open_page, library)
    page.get_by_label("Description").fill("half finished")
    expect(page.get_by_text("Draft, not saved yet")).to_be_visible()
    library.client.delete(f"/api/v1/languages/{library.language}").raise_for_status()
    alert = page.get_by_role("alert").filter(has_text="was deleted elsewhere")
    expect(page.get_by_role("heading", name="Edit circle")).to_be_hidden()
    alert.get_by_role("button", name="Bring it back").click()
    expect(page.get_by_label("Description")).to_have_value("half finished")
    expect(page.get_by_label("Language", exact=True)).to_have_value(library.language)


def change(library: Library, label: str, values: dict[str, str]) -> None:
    """Change a gesture as another tab does."""
    place = f"/api/v1/languages/{library.language}"
    tag = library.client.get(place).headers["etag"]
    answer = library.client.patch(
        f"{place}/gestures/{label}", json=values, headers={"If-Match": tag}
    )
    answer.raise_for_status()


def test_a_draft_goes_on_under_the_label_that_the_gesture_was_given_elsewhere(
    open_page: OpenPage, library: Library
) -> None:
    page = editing(open_page, library)
    page.get_by_label("Description").fill("half finished")
    expect(page.get_by_text("Draft, not saved yet")).to_be_visible()
    change(library, "circle", {"label": "ring", "command": "stop"})
    expect(page.get_by_role("heading", name="Edit ring")).to_be_visible()
    expect(page.get_by_text("was renamed elsewhere")).to_be_visible()
    expect(page.get_by_label("Label", exact=True)).to_have_value("ring")
    expect(page.get_by_label("Command")).to_have_value("stop")
    expect(page.get_by_label("Description")).to_have_value("half finished")
    page.get_by_role("button", name="Save", exact=True).click()
    expect(page.get_by_text("Gesture saved")).to_be_visible()
    saved = gesture(library, "ring")
    assert (saved["description"], saved["command"]) == ("half finished", "stop")


def test_the_label_of_a_new_gesture_is_proposed_and_replaced_by_typing(
    open_page: OpenPage, library: Library, server: Running
) -> None:
    clip = add_clip(server, "line", name="go_up-demonstration-2.mp4")
    query = {"clip": clip, "language": library.language}
    page = open_page(query, scene=False)
    page.get_by_role("button", name="Save as gesture").click()
    label = page.get_by_label("Label", exact=True)
    expect(label).to_have_value("go up")
    # More than a label may have is not typed, so that Save is never grey without a word.
    label.fill("\U0001f42c" * 200)
    expect(label).to_have_value("\U0001f42c" * 80)
    expect(page.get_by_role("button", name="Save gesture")).to_be_enabled()
    label.fill("go up")
    page.keyboard.press("Enter")
    expect(page.get_by_text("Gesture saved")).to_be_visible()
    assert gesture(library, "go up")
    page.get_by_role("button", name="Save as gesture").click()
    # The language has this label by now.
    expect(page.get_by_label("Label", exact=True)).to_have_value("")


def test_a_gesture_is_shown_anew_trimmed_to_the_frame_and_kept_when_its_clip_is_deleted(
    open_page: OpenPage, library: Library
) -> None:
    page = editing(open_page, library)
    clip = page.get_by_label("Clip", exact=True)
    expect(clip).to_have_value(library.clip)
    expect(clip.locator("option:checked")).to_contain_text("as saved")
    expect(page.get_by_role("button", name="Save", exact=True)).to_be_disabled()
    transit = page.get_by_role("checkbox", name="Leave out the hand")
    expect(transit).to_be_checked()
    start = page.get_by_label("Start frame")
    frame = int(start.input_value())
    page.get_by_label("Start of the demonstration").focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowRight")
    expect(start).to_have_value(str(frame + 2))
    expect(transit).to_be_disabled()
    expect(page.get_by_text(f"frame {frame + 2},")).to_be_visible()
    page.get_by_label("Take", exact=True).select_option("0")
    expect(start).to_have_value(str(frame))
    transit.uncheck()
    expect(page.get_by_text("Draft, not saved yet")).to_be_visible()
    page.get_by_role("button", name="Save", exact=True).click()
    expect(page.get_by_text("Gesture saved")).to_be_visible()
    source = gesture(library, "circle")["source"]
    assert isinstance(source, dict)
    assert (source["clip_id"], source["keep_transit"]) == (library.clip, True)

    page = editing(open_page, library)
    page.get_by_label("Start frame").fill("20")
    page.get_by_label("Start frame").blur()
    expect(page.get_by_text("Draft, not saved yet")).to_be_visible()
    library.client.delete(f"/api/v1/clips/{library.clip}")
    page.reload()
    expect(page.get_by_text("its clip is not in this studio")).to_be_visible()
    expect(page.get_by_label("Clip", exact=True).locator("option:checked")).to_have_text(
        "As it is saved"
    )
    expect(page.get_by_text("As saved", exact=True)).to_be_visible()


def test_after_a_look_at_a_clip_the_demonstration_as_it_is_saved_is_chosen_again(
    open_page: OpenPage, library: Library
) -> None:
    sample = next(each for each in library.client.get("/api/v1/languages").json() if each["sample"])
    query = {"view": "gesture", "language": sample["id"], "gesture": sample["labels"][0]}
    page = open_page(query, scene=False)
    page.locator("#editor-clip").select_option(library.clip)
    expect(page.locator("#editor-take")).to_be_visible()
    page.locator("#editor-clip").select_option("As it is saved")
    expect(page.locator("#editor-take")).to_be_hidden()


def test_a_drawing_without_its_demonstration_says_what_cannot_be_edited(
    open_page: OpenPage, library: Library
) -> None:
    place = f"/api/v1/languages/{library.language}/export"
    exported = library.client.get(place, params={"format": "osg-reference"}).content
    answer = library.client.post("/api/v1/languages/import", content=exported).json()
    query = {"language": str(answer["id"]), "view": "gesture", "gesture": "circle"}
    page = open_page(query, scene=False)
    expect(
        page.get_by_text("Imported without its demonstration: it cannot be played")
    ).to_be_visible()
    expect(page.get_by_text("Imported without its demonstration: its keypoints")).to_be_visible()
    page.get_by_role("textbox", name="Label").fill("ring")
    page.get_by_role("button", name="Save", exact=True).click()
    expect(page.get_by_text("Gesture saved")).to_be_visible()
    # Without a word about a kept draft.
    expect(page.locator(".toast")).to_have_count(1)
    assert "ring" in library.client.get(f"/api/v1/languages/{answer['id']}").json()["labels"]
