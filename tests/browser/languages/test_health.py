"""The health of a language in the browser: forecast, two gestures side by side, test clips."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import httpx
import pytest
from playwright.sync_api import Locator, Page, Request, Route, expect

from app.recognition import Gesture, Language
from tests.api.running import Running, client_of, until
from tests.browser.accessibility import faults
from tests.browser.conftest import OpenPage
from tests.browser.files import drop
from tests.browser.library import Library, add_clip, library_of
from tests.recognition.demonstrations import shown_by, with_wrong_take
from tests.recognition.held_takes import FIST, FLAT
from tests.recognition.moving_takes import circle, draw


@pytest.fixture(scope="module")
def library(server: Running) -> Iterator[Library]:
    with client_of(server.address) as client:
        yield library_of(server, client, "pool")


def health_of(library: Library, **more: str) -> dict[str, str]:
    return {"view": "health", "language": library.language, **more}


def known_of(page: Page) -> Locator:
    return page.get_by_role("table", name="What is known of each gesture")


def test_the_nearest_gesture_opens_the_two_on_one_time_cursor(
    open_page: OpenPage, library: Library
) -> None:
    page = open_page(health_of(library), scene=False)
    near = known_of(page).get_by_role("button", name="line", exact=True)
    expect(near).to_be_visible()
    assert faults(page) == []
    near.focus()
    page.keyboard.press("Enter")
    expect(page.get_by_role("heading", name="circle and line")).to_be_focused()
    expect(page.get_by_role("slider", name="Moment of both gestures")).to_have_value("0")
    assert faults(page) == []
    expect(page.get_by_text("circle differs from line by")).to_be_visible()
    circle = page.get_by_role("img", name="The movement of circle")
    dots = circle.locator(".dots")
    before = dots.get_attribute("d")
    page.keyboard.press(".")
    expect(page.get_by_role("slider", name="Moment of both gestures")).to_have_value("1")
    expect(dots).not_to_have_attribute("d", str(before))
    colleague = open_page(scene=False, alone=True)
    colleague.goto(page.url)
    expect(colleague.get_by_role("heading", name="circle and line")).to_be_visible()
    page.keyboard.press("Escape")
    expect(near).to_be_visible()


def test_of_one_persons_language_nothing_is_foretold_and_of_an_empty_one_nothing_checked(
    open_page: OpenPage, library: Library
) -> None:
    empty = library.client.post("/api/v1/languages", json={"name": "empty"}).json()["id"]
    page = open_page(health_of(library), scene=False)
    expected = page.get_by_role("region", name="What to expect")
    expect(expected).to_contain_text("nothing can be foretold")
    expect(expected).to_contain_text("Ask two more people")
    expect(known_of(page)).not_to_contain_text("other people")
    section = page.get_by_role("region", name="What is rejected")
    expect(section).to_contain_text(
        "One person has shown this language. The limit is a cautious constant: ask two more people."
    )
    expect(section.get_by_label("Right takes refused, at most")).to_be_disabled()
    page.get_by_label("Language", exact=True).select_option(empty)
    expect(page.get_by_text("No gestures to check yet")).to_be_visible()


def test_what_to_expect_is_measured_among_people_and_the_test_set_stands_first(
    open_page: OpenPage, server: Running, picture: Callable[[Page, str], Path], client: httpx.Client
) -> None:
    content = with_wrong_take().to_json()
    language = client.post("/api/v1/languages/import?name=three", content=content).json()["id"]
    page = open_page({"view": "health", "language": language}, scene=False, size=(1440, 900))
    expected = page.get_by_role("region", name="What to expect")
    expect(expected).to_contain_text("Of 12 demonstrations")
    expect(expected).to_contain_text("are read right by those of other people")
    expect(expected).to_contain_text("read as another")
    findings = page.get_by_role("list", name="Findings")
    expect(findings).to_contain_text("Cy's is read as wedge")
    # Whose demonstration fails and the way to more people are one sight.
    expect(findings.get_by_text("Cy's is read as wedge")).to_be_in_viewport(ratio=1)
    expect(page.get_by_role("button", name="Invite people")).to_be_in_viewport(ratio=1)
    expect(known_of(page).get_by_role("row").filter(has_text="infinity")).to_contain_text("2 of 3")
    # Every keypoint is seen, and no gesture needs more than its figure: that takes no columns.
    heads = known_of(page).get_by_role("columnheader")
    expect(heads).to_have_text(
        ["Gesture", "Read right by the others\u2019 demonstrations", "Nearest gesture"]
    )
    assert faults(page) == []
    picture(page, "health")
    clip = add_clip(server, "circle", name="circle-measured.mp4")
    test_set = f"/api/v1/languages/{language}/test-set"
    take = {"clip_id": clip, "expected": "circle"}
    client.post(test_set, json={"takes": [take]}).raise_for_status()
    client.post(f"{test_set}/run").raise_for_status()
    page.reload()
    first = expected.locator("p").first
    expect(first).to_contain_text("Of the test set")
    expect(first).to_contain_text("of 1 takes are read right")
    expect(known_of(page).get_by_role("columnheader", name="Test set")).to_be_visible()
    # The test is nearer than the map, which tells less of what others will reach.
    headings = page.get_by_role("heading", level=2).all_inner_texts()
    assert headings.index("Test with clips") < headings.index("Map")


def test_the_author_answers_whether_the_hands_of_two_gestures_are_meant(
    open_page: OpenPage, client: httpx.Client, picture: Callable[[Page, str], Path]
) -> None:
    shown = (("fist", draw(FIST, circle())), ("flat", draw(FLAT, circle(0.42), seed=1)))
    content = Language(
        "hands", [Gesture.from_demonstration(label, poses) for label, poses in shown]
    ).to_json()
    language = client.post("/api/v1/languages/import?name=hands", content=content).json()["id"]
    exported = f"/api/v1/languages/{language}/export?format=osg-studio"
    page = open_page({"view": "health", "language": language}, scene=False)
    question = page.get_by_role("listitem").filter(has_text="On purpose?")
    expect(question.get_by_role("img", name="Hand of")).to_have_count(2)
    assert faults(page) == []
    picture(page, "hands-undecided")
    for answer, position in (("Yes", "on"), ("No", "off")):
        question.get_by_role("button", name=answer, exact=True).click()
        expect(question).to_have_count(0)
        assert client.get(exported).text.count(f'"hand_shape":"{position}"') == 2
        page.keyboard.press("Control+z")
        expect(question).to_be_visible()


def import_crowd(client: httpx.Client) -> str:
    """Import a language of forty gestures, whose check takes long enough to cancel it."""
    listed = client.get("/api/v1/languages").json()
    eight = next(each["id"] for each in listed if each["name"] == "Table 2: eight signs")
    document = client.get(f"/api/v1/languages/{eight}/export").json()
    del document["sha256"], document["grammar"]  # Valid for the eight only.
    document["gestures"] = [
        gesture | {"label": f"{gesture['label']} {turn}"}
        for turn in range(5)
        for gesture in document["gestures"]
    ]
    imported = client.post("/api/v1/languages/import?name=crowd", json=document)
    assert imported.status_code == 201, imported.text
    return str(imported.json()["id"])


def test_a_check_is_cancelled_and_begun_again(open_page: OpenPage, library: Library) -> None:
    crowd = import_crowd(library.client)
    page = open_page({"view": "health", "language": crowd}, scene=False)
    # At any stage, since the first is over in a moment.
    progress = page.get_by_text(re.compile(r"^(Comparing|Turning) .*, \d+ (of \d+|so far)$"))
    cancelled = page.get_by_text("The check was cancelled")
    expect(progress).to_be_visible()
    page.get_by_role("button", name="Cancel").click()
    expect(cancelled).to_be_visible()
    page.get_by_role("button", name="Check again").click()
    expect(cancelled).to_have_count(0)
    expect(progress).to_be_visible()
    page.get_by_role("button", name="Cancel").click()
    expect(cancelled).to_be_visible()


def test_the_dial_is_turned_shows_both_costs_and_is_turned_back(
    open_page: OpenPage, library: Library
) -> None:
    imported = library.client.post(
        "/api/v1/languages/import?name=three", content=shown_by(("Ann", "Bo", "Cy")).to_json()
    )
    language = imported.json()["id"]
    page = open_page({"view": "health", "language": language}, scene=False)
    section = page.get_by_role("region", name="What is rejected")
    dial = section.get_by_label("Right takes refused, at most")
    expect(dial).to_have_value("0.05")
    expect(section).to_contain_text("Of 12 right takes by other people, 8 % (1 to 35) are refused.")
    expect(section).to_contain_text("Of 12 takes of missing gestures, 0 % (0 to 24) are accepted.")
    assert faults(page) == []
    dial.focus()
    dial.select_option("0.2")
    expect(section).to_contain_text("25 % (9 to 53) are refused")
    expect(dial).to_be_focused()
    newest = library.client.get(f"/api/v1/languages/{language}").json()
    assert newest["change"] == "Refuse at most 20 % of right takes"
    page.get_by_role("button", name="Undo", exact=True).click()
    expect(page.get_by_text("Undone")).to_be_visible()
    expect(dial).to_have_value("0.05")
    expect(section).to_contain_text("8 % (1 to 35) are refused")


def test_labelled_clips_are_tested_corrected_and_opened(
    open_page: OpenPage, library: Library, server: Running, tmp_path: Path
) -> None:
    clip = add_clip(server, "circle", "line", name="circle-9.mp4")
    pending = [{"clip": clip, "language": library.language, "expected": None}]
    page = open_page(health_of(library), scene=False)
    # The page has read what was pending before, and does not write over this.
    expect(page.get_by_role("table", name="What is known of each gesture")).to_be_visible()
    page.evaluate(
        "pending => sessionStorage.setItem('osg-studio.batch', JSON.stringify(pending))", pending
    )
    page.reload()
    takes = page.get_by_role("table", name="The test clips")
    expect(takes.get_by_text("right: circle")).to_be_visible()
    expect(takes.get_by_text("wrong: line")).to_be_visible()
    grid = page.get_by_role("grid", name="Confusions of the test clips")
    expect(grid.get_by_role("gridcell", name="1 take of circle read as line")).to_be_visible()
    page.get_by_role("button", name="Leave circle-9.mp4, take 2 out of the test").click()
    expect(takes.get_by_text("wrong: line")).to_have_count(0)
    page.get_by_role("button", name="Undo", exact=True).click()
    takes.get_by_label("What circle-9.mp4, take 2 shows").select_option("line")
    expect(grid.get_by_role("gridcell", name="1 take of line read as line")).to_be_visible()
    with page.expect_download() as download:
        page.get_by_role("button", name="Export as CSV").click()
    file = tmp_path / "test.csv"
    download.value.save_as(file)
    assert file.read_text().count("circle-9.mp4") == 2
    grid.get_by_role("gridcell", name="1 take of circle read as circle").click()
    expect(page.locator("#outcome")).to_contain_text("as expected")


def test_clips_of_the_library_are_tested_and_the_only_demonstration_cannot_be(
    open_page: OpenPage, server: Running, client: httpx.Client
) -> None:
    library = library_of(server, client, "test set")
    add_clip(server, "circle", name="circle-other.mp4")
    going = add_clip(server, "line", name="going.mp4")
    test_set = f"/api/v1/languages/{library.language}/test-set"
    demonstration = {"clip_id": library.clip, "expected": "circle"}
    client.post(test_set, json={"takes": [demonstration]}).raise_for_status()
    page = open_page(health_of(library), scene=False)
    page.get_by_role("button", name="Test with clips").click()
    expect(page.get_by_role("heading", name="Test with clips")).to_be_in_viewport()
    expect(page.get_by_text("cannot be tested: the only demonstration")).to_be_visible()
    page.get_by_text("Choose from the").click()
    chosen = page.locator(".library-boxes input:checked")
    while chosen.count():
        chosen.first.uncheck()
    page.get_by_role("checkbox", name="circle-other.mp4").check()
    # A chosen clip stays chosen when another one goes.
    client.delete(f"/api/v1/clips/{going}").raise_for_status()
    expect(page.get_by_role("checkbox", name="going.mp4")).to_have_count(0)
    expect(page.get_by_role("checkbox", name="circle-other.mp4")).to_be_checked()
    page.get_by_role("button", name="Test the chosen clips").click()
    section = page.get_by_role("region", name="Test with clips")
    expect(section).to_contain_text("1 of 2 recognised as labelled, 1 cannot be tested")
    rates = page.get_by_role("list", name="Rate of each gesture")
    expect(rates).to_contain_text("circle 1 of 1")
    # A wrong result differs from a right one by more than the shade.
    page.get_by_label("What circle-other.mp4 shows").select_option("line")
    wrong = page.get_by_role("gridcell", name="1 take of line read as circle")
    expect(wrong).to_have_css("background-image", re.compile("repeating-linear-gradient"))


def test_chosen_clips_are_sent_at_once_and_a_page_that_is_left_loses_none(
    open_page: OpenPage, server: Running, client: httpx.Client
) -> None:
    library = library_of(server, client, "test of many")
    names = [f"circle-many-{number}.mp4" for number in range(4)]
    for name in names:
        add_clip(server, "circle", name=name)
    page = open_page({**health_of(library), "view": "languages"}, scene=False)
    checks: list[Route] = []
    page.route("**/check?*", lambda route: checks.append(route))
    page.get_by_role("link", name="Health", exact=True).click()
    page.get_by_role("button", name="Test with clips").click()
    page.get_by_text("Choose from the").click()
    while not checks:
        page.wait_for_timeout(20)
    # The report comes between press and release.
    box = page.get_by_role("checkbox", name=names[0])
    box.hover()
    page.mouse.down()
    place = page.locator(".library-boxes").bounding_box()
    with page.expect_response("**/check?*"):
        checks.pop().continue_()
    page.wait_for_timeout(300)
    expect(page.locator(".verdict b")).to_have_count(0)
    page.mouse.up()
    expect(box).not_to_be_checked()
    expect(page.locator(".verdict b")).to_be_visible()
    assert page.locator(".library-boxes").bounding_box() == pytest.approx(place, abs=1)
    chosen = page.locator(".library-boxes input:checked")
    while chosen.count():
        chosen.first.uncheck()
    for name in names:
        page.get_by_role("checkbox", name=name).check()
    with page.expect_request("**/test-set/run"):
        page.get_by_role("button", name="Test the chosen clips").click()
    page.wait_for_timeout(300)  # The request is on its way; the run takes longer.
    page.close()
    address = f"/api/v1/languages/{library.language}/test-set"
    until(lambda: client.get(address).json()["overall"]["asked"] == len(names))


def test_clips_can_be_chosen_once_it_is_known_which_are_tested(
    open_page: OpenPage, server: Running, client: httpx.Client
) -> None:
    library = library_of(server, client, "tests come late")
    add_clip(server, "circle", name="circle-known.mp4")
    page = open_page(scene=False)
    held: list[Route] = []
    page.route("**/test-set", lambda route: held.append(route))
    page.goto(f"{server.address}/?view=health&language={library.language}")
    expect(page.locator(".verdict b")).to_be_visible()
    choice = page.get_by_text("Choose from the")
    expect(choice).to_have_count(0)
    for route in held:
        route.continue_()
    choice.click()
    expect(page.get_by_role("checkbox", name="circle-known.mp4")).to_be_checked()


def test_a_clip_between_two_gestures_is_asked_back_and_counted_on_its_own(
    open_page: OpenPage, server: Running, client: httpx.Client
) -> None:
    library = library_of(server, client, "asking")
    library.add_gesture("ring")
    clip = add_clip(server, "circle", name="circle-asked.mp4")
    test_set = f"/api/v1/languages/{library.language}/test-set"
    take = {"clip_id": clip, "expected": "circle"}
    client.post(test_set, json={"takes": [take]}).raise_for_status()
    client.post(f"{test_set}/run").raise_for_status()
    page = open_page(health_of(library), scene=False)
    section = page.get_by_role("region", name="Test with clips")
    expect(section).to_contain_text("0 of 1 recognised as labelled")
    expect(section).to_contain_text("1 asked back, 1 of them with the right gesture")
    takes = page.get_by_role("table", name="The test clips")
    expect(takes).to_contain_text("asked back: circle or ring?, the right one is in it")
    assert faults(page) == []
    asked = page.get_by_role("gridcell", name="1 take of circle asked back")
    expect(asked).to_have_css("border-style", "dashed")
    asked.click()
    expect(page.locator("#outcome.asked")).to_contain_text("circle or ring?, expected circle")


def test_a_change_of_the_language_repeats_the_test_and_says_what_got_worse(
    open_page: OpenPage, server: Running, client: httpx.Client
) -> None:
    library = library_of(server, client, "changed")
    gesture = f"/api/v1/languages/{library.language}/gestures?label=circle"
    client.patch(gesture, json={"direction": "off"}).raise_for_status()
    clip = add_clip(server, "circle backwards", name="other way.mp4")
    tested = replace(library, clip=clip)
    query = {**tested.address, "recognition": tested.recognise("circle")}
    page = open_page(query, scene=False)
    page.get_by_role("button", name="Keep as a test").click()
    expect(page.get_by_text("In the test set")).to_be_visible()
    client.patch(gesture, json={"direction": "on"}).raise_for_status()
    expect(page.get_by_text("1 take worse since the revision before")).to_be_visible()
    page.get_by_role("button", name="Show", exact=True).last.click()
    section = page.get_by_role("region", name="Test with clips")
    expect(section).to_contain_text("1 take worse since the revision before")
    expect(section.get_by_role("row").filter(has_text="other way.mp4")).to_contain_text("worse")
    assert faults(page) == []


def is_test_set(request: Request) -> bool:
    return request.method == "GET" and request.url.endswith("/test-set")


@pytest.mark.parametrize("change", ["left out", "labelled"])
def test_a_change_while_a_clip_is_added_to_the_test_holds(
    open_page: OpenPage, server: Running, library: Library, change: str
) -> None:
    name = f"{change} in haste.mp4"
    clip = add_clip(server, "line", name=name)
    page = open_page(health_of(library), scene=False)
    held: list[Route] = []

    def hold_first(route: Route) -> None:
        if clip in (route.request.post_data or "") and not held:
            held.append(route)
        else:
            route.fallback()

    page.route("**/test-set", hold_first)
    page.get_by_text("Choose from the").click()
    page.get_by_role("checkbox", name=name).check()
    page.get_by_role("button", name="Test the chosen clips").click()
    shows = page.get_by_label(f"What {name} shows")
    with page.expect_request(lambda request: clip in (request.post_data or "")):
        shows.select_option("circle")
    # The request is told before the route is called.
    while not held:
        page.wait_for_timeout(20)
    row = page.get_by_role("row").filter(has_text=name)
    if change == "left out":
        page.get_by_role("button", name=f"Leave {name} out of the test").click()
    else:
        shows.select_option("line")
    if change == "left out":
        with page.expect_response(lambda answer: answer.request.method == "DELETE"):
            held[0].continue_()
        expect(shows).to_have_count(0)
    else:
        # The event about the take arrives before the answer to the page's request.
        with page.expect_response(lambda answer: is_test_set(answer.request)):
            answer = held[0].fetch()
        expect(row).to_have_count(1)
        expect(shows).to_have_value("line")
        held[0].fulfill(response=answer)
        expect(row).to_contain_text("right: line")
        expect(shows).to_have_value("line")


def test_a_dropped_clip_is_labelled_by_its_name(
    open_page: OpenPage, library: Library, clips: Path
) -> None:
    page = open_page(health_of(library), scene=False)
    expect(page.get_by_role("heading", name="Test with clips")).to_be_visible()
    drop(page, clips / "line-demonstration.mp4", names=("circle-dropped.mp4",))
    shows = page.get_by_label("What circle-dropped.mp4 shows")
    expect(shows).to_have_value("circle")
    shows.select_option("line")
    page.reload()
    expect(shows).to_have_value("line")
    leave = page.get_by_role("button", name="Leave circle-dropped.mp4 out of the test")
    leave.click()
    expect(shows).to_have_count(0)
    page.get_by_role("button", name="Undo", exact=True).click()
    expect(shows).to_have_value("line")
    leave.click()
    expect(shows).to_have_count(0)
    listed = library.client.get("/api/v1/clips").json()
    added = next(clip for clip in listed if clip["name"] == "circle-dropped.mp4")
    library.client.delete(f"/api/v1/jobs/{added['job_id']}")


def test_one_of_two_alike_gestures_gets_another_movement_and_undo_takes_it_back(
    open_page: OpenPage, server: Running, client: httpx.Client
) -> None:
    language = client.post("/api/v1/languages", json={"name": "alike"}).json()["id"]
    library = Library("", language, client)
    for label, shape in (("box", "circle"), ("frame", "circle"), ("line", "line")):
        clip = add_clip(server, shape, name=f"{label} of {language}.mp4")
        library.add_gesture(label, clip, f"what {label} means")
    page = open_page(health_of(library), scene=False)
    findings = page.get_by_role("list", name="Findings")
    same = findings.get_by_role("listitem").filter(has_text="box and frame are the same")
    same.get_by_role("button", name="Change one of the two").click()
    dialog = page.get_by_role("dialog", name="Change box or frame")
    expect(dialog.get_by_text("By the distances of one person")).to_be_visible()
    for width in (1280, 390):
        page.set_viewport_size({"width": width, "height": 800})
        assert faults(page) == []
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    cards = dialog.get_by_role("heading", name="Instead of frame").locator("+ ul button")
    expect(cards.first).to_contain_text("Nearest is")
    cards.first.click()
    expect(dialog).to_be_hidden()
    expect(page.get_by_text("frame has another movement")).to_be_visible()
    expect(page.locator(".verdict")).to_contain_text("no errors")
    expect(same).to_be_hidden()
    changed = client.get(f"/api/v1/languages/{language}").json()
    assert changed["labels"] == ["box", "frame", "line"]
    assert changed["gestures"][1]["description"] == "what frame means"
    page.keyboard.press("Control+z")
    expect(same).to_be_visible()


def test_proposals_can_be_left_fail_and_be_none(open_page: OpenPage, library: Library) -> None:
    page = open_page(health_of(library, pair="circle,line"), scene=False)
    waiting: list[Route] = []
    page.route("**/api/v1/languages/*/replacements*", lambda route: waiting.append(route))
    change = page.get_by_role("button", name="Change one of the two")
    dialog = page.get_by_role("dialog", name="Change circle or line")

    def answer(number: int, status: int, **body: object) -> None:
        label = ("circle", "circle", "circle", "line")[number]
        expect(dialog.get_by_text(f"Trying other movements for {label}")).to_be_visible()
        page.wait_for_timeout(200)
        waiting[number].fulfill(status=status, json=body)

    change.click()
    expect(dialog.get_by_role("progressbar", name="Comparing movements")).to_be_visible()
    expect(dialog.get_by_text("Trying other movements for circle")).to_be_visible()
    dialog.get_by_role("button", name="Cancel").click()
    expect(dialog).to_be_hidden()
    change.click()
    answer(1, 422, detail="the language is too large")
    expect(dialog.get_by_role("alert")).to_have_text("the language is too large")
    expect(dialog.get_by_role("progressbar")).to_be_hidden()
    page.keyboard.press("Escape")
    change.click()
    answer(2, 200, label="circle", people=None, replacements=[])
    answer(3, 200, label="line", people=None, replacements=[])
    expect(dialog).to_contain_text("No candidate is told apart better.")
