"""An invitation in the browser: three people finish a language, two of them by its link."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import httpx
import pytest
from playwright.sync_api import Browser, BrowserContext, Page, Route, ViewportSize, expect

from app.recognition import Language
from app.settings import Settings
from tests.api.invitations import divers_of
from tests.api.running import Running, client_of
from tests.browser.accessibility import faults
from tests.browser.camera import OTHER_VIEWS, looked_often, watch_looks
from tests.browser.conftest import WATCH_POLICY, OpenPage, new_context
from tests.short_clips import thinned

PHONE = ViewportSize(width=390, height=844)

GESTURES = ("circle", "line")

LONGEST = 25.0
"""Seconds from which on a recording was not ended by the salute, but by its limit."""

JUDGED_MS = 300_000
"""Longest wait for the poses of a clip of a few seconds on a loaded machine."""

CAMERA = """
const canvas = document.createElement("canvas");
Object.assign(canvas, { width: 640, height: 480 });
const context = canvas.getContext("2d");
const video = Object.assign(document.createElement("video"), { muted: true });
const draw = () => {
  context.drawImage(video, 0, 0, canvas.width, canvas.height);
  context.fillStyle = context.fillStyle === "#000000" ? "#ffffff" : "#000000";
  context.fillRect(0, 0, 1, 1); // A still picture would not be sent again.
  requestAnimationFrame(draw);
};
const clips = {};
navigator.mediaDevices.getUserMedia = async () => {
  const way = OTHER_VIEWS ? "back" : "test";
  for (const label of LABELS) {
    const clip = await (await fetch(`/recorded/${label}-${way}.mp4`)).blob();
    clips[label] = URL.createObjectURL(clip);
  }
  video.src = Object.values(clips)[0];
  await video.play(); // The person stands there.
  video.pause();
  draw();
  return canvas.captureStream(25);
};
new MutationObserver((changes) => {
  for (const { target } of changes)
    if (target.matches?.(".camera-picture.recording") && video.paused) {
      video.src = clips[document.querySelector("h2").textContent];
      setTimeout(() => video.play(), 4000); // later than the shortest recording allows
    }
}).observe(document, { subtree: true, attributes: true, attributeFilter: ["class"] });
"""
"""A camera before which a person shows the gesture that is asked for, as on a recorded clip, and
goes the way of the drawing's arrow on the screen."""


@pytest.fixture(scope="module")
def client(server: Running) -> httpx.Client:
    return client_of(server.address)


@pytest.fixture(scope="module")
def language(client: httpx.Client, settings: Settings) -> str:
    """Return the id of a language of two gestures, shown by one person."""
    sample = Language.from_json((settings.samples_dir / "osg-table-2.json").read_text("utf-8"))
    gestures = [sample.gesture(label) for label in GESTURES]
    gestures = [
        replace(each, diver="Ana", switches=replace(each.switches, direction="on"))
        for each in gestures
    ]
    content = replace(sample, name="deck", gestures=gestures, grammar=None).to_json()
    return str(client.post("/api/v1/languages/import", content=content).json()["id"])


@pytest.fixture
def phone(browser: Browser) -> Iterator[Callable[..., Page]]:
    """Return a function that opens a link on a phone of its own, with a script before the page."""
    contexts, errors = list[BrowserContext](), list[str]()

    def open_link(link: str, script: str = "") -> Page:
        context = new_context(browser)
        contexts.append(context)
        page = context.new_page()
        page.set_viewport_size(PHONE)
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.add_init_script(WATCH_POLICY)
        if script:
            page.add_init_script(script)
        page.goto(link)
        return page

    yield open_link
    for context in contexts:
        context.close()
    assert errors == []


def begin(page: Page, name: str) -> None:
    page.get_by_label("Your name").fill(name)
    page.get_by_role("button", name="Begin").click()
    expect(page.get_by_text("0 of 2 added")).to_be_visible()


def shows(page: Page, label: str, words: str) -> None:
    row = page.get_by_role("list", name="Gestures").get_by_role("listitem").filter(has_text=label)
    expect(row).to_contain_text(words, timeout=JUDGED_MS)


def test_three_people_finish_a_language(
    open_page: OpenPage,
    phone: Callable[..., Page],
    server: Running,
    client: httpx.Client,
    language: str,
    clips: Path,
    thin_clip: Callable[[str], Path],
    picture: Callable[[Page, str], Path],
    tmp_path: Path,
) -> None:
    def recorded(route: Route) -> None:
        label, way = Path(route.request.url).stem.split("-")
        clip = clips / f"{label}-test-1.mp4"
        if way == "back":
            clip = thinned(clip, tmp_path / f"{label}.mp4", every=1, backward=True)
        route.fulfill(path=clip, content_type="video/mp4")

    page = open_page({"view": "health", "language": language}, scene=False)
    expected = page.get_by_role("region", name="What to expect")
    expect(expected).to_contain_text("Ask two more people")
    expected.get_by_role("button", name="Invite people").click()
    dialog = page.get_by_role("dialog")
    expect(dialog.get_by_label("People")).to_have_value("2")
    dialog.get_by_role("button", name="Make the link").click()
    expect(dialog.get_by_role("img", name="QR code of the link")).to_be_visible()
    expect(dialog).to_contain_text("Phones do not reach this address")
    link = dialog.locator(".link-text").inner_text()
    assert faults(page) == []
    dialog.get_by_role("button", name="Close").click()
    invitation = page.get_by_role("list", name="Invitations").locator(".invitation")
    expect(invitation).to_contain_text("0 of 12 takes sent")

    # Bo shows every gesture hands-free before the camera of the phone.
    views = OTHER_VIEWS % (".figure", ".camera-picture video")
    camera = CAMERA.replace("LABELS", json.dumps(GESTURES)).replace("OTHER_VIEWS", views)
    bo = phone(link, camera)
    looks = watch_looks(bo)
    bo.route("**/recorded/*", recorded)
    expect(bo.get_by_role("heading", name="Show the gestures of deck")).to_be_visible()
    assert faults(bo) == []
    begin(bo, "Bo")
    assert faults(bo) == []
    # The gesture that is chosen comes first.
    bo.get_by_role("list", name="Gestures").get_by_role("button", name="line").click()
    bo.get_by_role("button", name="Show hands-free").click()
    expect(bo.get_by_text("Next: line. Step back.")).to_be_visible()
    expect(bo.locator(".camera-picture.recording")).to_be_visible()
    # What the server sees is told as in Live.
    expect(bo.locator(".step")).to_have_text(re.compile("^(Waiting for|Salute|Show the gesture, )"))
    picture(bo, "invitation")
    expect(bo.get_by_text("This is sent in a moment.")).to_be_visible()
    expect(bo.get_by_text("All gestures are added. Thank you!")).to_be_visible(timeout=JUDGED_MS)
    # The salute ends a recording, unless a loaded machine looks too seldom to see it.
    recordings = [each.clip for each in server.studio.clips.all() if each.clip.name[:3] == "Bo "]
    durations = [each.duration for each in recordings]
    # The server's first look takes longest: it is at a picture of the countdown.
    assert any(second - first > 1.0 for first, second, *_ in looks)
    assert min(filter(None, durations)) < LONGEST or not any(map(looked_often, looks)), durations

    # Cy has no live camera: first a clip without a take, then the right ones.
    cy = phone(link, "delete MediaDevices.prototype.getUserMedia;")
    begin(cy, "Cy")
    expect(cy.get_by_role("button", name="Show hands-free")).to_have_count(0)
    chosen = cy.get_by_label("Choose a clip")
    chosen.set_input_files(thin_clip("ordinary-movement"))
    shows(cy, "circle", "show it again")
    reason = "The salute was not seen twice. Hold it longer, before and after."
    shows(cy, "circle", reason)
    # Phones drop the page while their own recorder is open.
    cy.reload()
    cy.get_by_role("button", name="Begin").click()
    shows(cy, "circle", reason)
    cy.get_by_role("button", name="circle").click()
    expect(cy.get_by_role("alert")).to_contain_text("salute was not seen twice")
    expect(cy.get_by_role("heading", name="circle", exact=True)).to_be_visible()
    assert faults(cy) == []
    for label in GESTURES:
        expect(cy.get_by_role("heading", name=label, exact=True)).to_be_visible()
        cy.get_by_label("Record with the phone").set_input_files(thin_clip(f"{label}-test-2"))
    expect(cy.get_by_text("All gestures are added. Thank you!")).to_be_visible(timeout=JUDGED_MS)

    for label in GESTURES:
        assert divers_of(client, language, label) == ["Ana", "Bo", "Cy"]
    expect(expected).to_contain_text("Of 6 demonstrations", timeout=JUDGED_MS)
    expect(page.get_by_role("img", name=re.compile("^Read right of people"))).to_be_visible()
    takes = invitation.get_by_role("row")
    expect(takes.filter(has_text="circle by Bo")).to_contain_text("added")
    expect(takes.filter(has_text="circle by Cy").first).to_contain_text(f"returned: {reason}")

    # Di shows a line where a circle is asked for, and says that it is one.
    di = phone(link)
    begin(di, "Di")
    di.get_by_label("Choose a clip").set_input_files(thin_clip("line-test-2"))
    question = "This looks like 'line'. Is it 'circle'?"
    expect(di.get_by_role("alert")).to_contain_text(question, timeout=JUDGED_MS)
    assert faults(di) == []
    wrong = takes.filter(has_text="circle by Di")
    expect(wrong).to_contain_text(f"Di is asked: {question}")
    # The take is seen again, and no answer to the doubt is recommended.
    expect(di.get_by_label("Your take of circle")).to_be_visible()
    expect(di.get_by_role("button", name="Yes, it is")).not_to_have_class("primary")
    picture(di, "invitation-asked")
    di.get_by_role("button", name="Yes, it is").click()
    shows(di, "circle", "is looked at by whoever invited you")
    expect(wrong).to_contain_text("Waits for you. It is read as 'line'. Di says")
    expect(wrong.get_by_label("The take of circle")).to_be_visible()
    expect(wrong.get_by_text("No take of the test set or of practice tells")).to_be_visible()
    assert faults(page) == []
    wrong.get_by_role("button", name="Remove").click()
    expect(wrong).to_contain_text("removed")
    expect(page.get_by_text("Take of circle removed")).to_be_visible()
    expect(page.get_by_role("button", name="Add it after all")).to_be_visible()
    assert divers_of(client, language, "circle") == ["Ana", "Bo", "Cy"]

    # The link does nothing any more once it is withdrawn, and what came in can be taken back.
    invitation.get_by_role("button", name="Withdraw").click()
    expect(invitation).to_contain_text("withdrawn")
    invitation.get_by_role("button", name="Take back what came in").click()
    expect(takes.filter(has_text="removed")).to_have_count(5)
    assert [divers_of(client, language, label) for label in GESTURES] == [["Ana"], ["Ana"]]
    late = phone(link)
    expect(late.get_by_role("heading", name="Invitation closed")).to_be_visible()
    expect(late.get_by_text("This invitation was withdrawn; ask")).to_be_visible()
