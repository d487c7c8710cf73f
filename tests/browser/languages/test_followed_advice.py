"""A user who follows the advice of the page: every figure agrees with a table made by hand."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import pytest
from playwright.sync_api import Page, expect

from app.recognition import Gesture, Language, Recognizer
from app.recognition.recording.clip_range import find_clip_range
from tests.api.recordings import recording_of
from tests.api.running import Running, client_of
from tests.browser.conftest import OpenPage
from tests.browser.library import Library, add_clip, answer_late

NONE = "none of these"

TAKES = {
    "round 1": ("circle", "circle"),
    "round 2": ("circle", "circle backwards"),
    "square 1": ("square", "square"),
    "square 2": ("square", "square"),
    "square 3": ("square", "rounded square"),
    "line demo": ("line", "line"),
    "square demo": ("square", "narrow square"),
    "other 1": (NONE, "valley"),
    "other 2": (NONE, "dip"),
}
"""Label and shape of every labelled take; the demonstration of square was too narrow."""

Shown = Mapping[str, Sequence[str]]
"""Clips of the demonstrations of each gesture."""

FIRST: Shown = {"circle": ["circle demo"], "line": ["line demo"], "square": ["square demo"]}


@dataclass(frozen=True)
class Row:
    """How a take is read by the demonstrations other than itself."""

    expected: str
    label: str | None
    pair: tuple[str, str] | None

    @property
    def right(self) -> bool:
        return self.label == self.expected or (
            self.expected == NONE and self.label is None and self.pair is None
        )

    @property
    def worth(self) -> int:
        return 2 if self.right else int(self.pair is not None and self.expected in self.pair)


def table_of(shown: Shown) -> dict[str, Row | None]:
    """Read each take by the demonstrations that it is not; None where its gesture has no other."""
    rows: dict[str, Row | None] = {}
    for name, (expected, shape) in TAKES.items():
        others = {label: [each for each in clips if each != name] for label, clips in shown.items()}
        if expected != NONE and not others[expected]:
            rows[name] = None
            continue
        answer = Recognizer(Language("by hand", [*map(teach, others, others.values())])).recognize(
            find_clip_range(recording_of(shape)).poses
        )
        rows[name] = Row(expected, answer.label, answer.pair)
    return rows


def teach(label: str, clips: Sequence[str]) -> Gesture:
    first, *further = [
        find_clip_range(recording_of(TAKES.get(each, ("", "circle"))[1])).poses for each in clips
    ]
    gesture = Gesture.from_demonstration(label, first)
    for poses in further:
        gesture = gesture.with_demonstration(poses)
    return gesture


def headline_of(rows: Mapping[str, Row | None]) -> str:
    right = sum(row is not None and row.right for row in rows.values())
    apart = sum(row is None for row in rows.values())
    return f"Of the test set {right} of {len(rows)} takes are read right, {apart} cannot be tested."


def verdict_of(rows: Mapping[str, Row | None], errors: int) -> str:
    words = [f"{errors} error{'s' if errors > 1 else ''}"] if errors else []
    untested = []
    for label in FIRST:
        tested = [row.right for row in rows.values() if row is not None and row.expected == label]
        if not tested:
            untested.append(f"{label} untested")
        elif 2 * sum(tested) < len(tested):
            words.append(f"{label} {sum(tested)} of {len(tested)}")
    return ", ".join([*(words or ["no errors"]), *untested])


def change_of(before: Mapping[str, Row | None], after: Mapping[str, Row | None]) -> str:
    pairs = [(before[name], after[name]) for name in TAKES]
    gains = [now.worth - was.worth for was, now in pairs if was is not None and now is not None]
    worse, better = sum(gain < 0 for gain in gains), sum(gain > 0 for gain in gains)
    apart = len(pairs) - len(gains)
    counts = [
        f"{count} take{'s' if count > 1 else ''} {kind}"
        for count, kind in ((worse, "worse"), (better, "better"))
        if count
    ]
    assert counts, "a step that changes nothing shows nothing"
    return (
        f"{', '.join(counts)} since the revision before; "
        f"{apart} take{'s' if apart > 1 else ''} cannot be compared"
    )


@dataclass(frozen=True)
class Studio:
    """The page, with the ids of the clips and of the language."""

    page: Page
    library: Library
    clips: Mapping[str, str]

    def open(self, view: str) -> None:
        self.page.get_by_role("navigation", name="Views").get_by_role("link", name=view).click()

    def expect_figures(self, rows: Mapping[str, Row | None]) -> None:
        """Expect headline, verdict, test and card of the language to say what the table says."""
        page = self.page
        check = f"/api/v1/languages/{self.library.language}/check"
        found = self.library.client.get(check, timeout=60).json()["warnings"]
        verdict = verdict_of(rows, sum(each["error"] for each in found))
        self.open("Health")
        expect(page.locator(".expectation .first")).to_contain_text(headline_of(rows))
        expect(page.locator(".verdict b")).to_have_text(verdict)
        summary = page.locator(".test-summary")
        count = headline_of(rows).split()[4:7]
        expect(summary).to_contain_text(f"{' '.join(count)} recognised as labelled")
        for label in FIRST:
            of_label = [row for row in rows.values() if row is not None and row.expected == label]
            words = f"{label} {sum(row.right for row in of_label)} of {len(of_label)}"
            expect(page.get_by_role("list", name="Rate of each gesture")).to_contain_text(words)
        self.open("Languages")
        card = page.get_by_role("listitem").filter(has_text="advised").locator(".health")
        expect(card).to_contain_text(re.compile(f"^\\s*{verdict}(:|\\s*$)"))

    def expect_change(
        self, before: Mapping[str, Row | None], after: Mapping[str, Row | None]
    ) -> None:
        expect(self.page.locator("#toasts")).to_contain_text(f"{change_of(before, after)}.")


@pytest.fixture
def studio(open_page: OpenPage, server: Running) -> Studio:
    client = client_of(server.address)
    language = client.post("/api/v1/languages", json={"name": "advised"}).json()["id"]
    library = Library("", language, client)
    shapes = {name: shape for name, (_, shape) in TAKES.items()} | {"circle demo": "circle"}
    clips = {name: add_clip(server, shape, name=f"{name}.mp4") for name, shape in shapes.items()}
    for label, (demonstration,) in FIRST.items():
        library.add_gesture(label, clips[demonstration])
    takes = [
        {"clip_id": clips[name]}
        | ({"expected_none": True} if expected == NONE else {"expected": expected})
        for name, (expected, _) in TAKES.items()
    ]
    test_set = f"/api/v1/languages/{language}/test-set"
    client.post(test_set, json={"takes": takes}).raise_for_status()
    client.post(f"{test_set}/run").raise_for_status()
    misread = replace(library, clip=clips["square 1"])
    query = {**misread.address, "recognition": misread.recognise("square")}
    return Studio(open_page(query, scene=False), library, clips)


def test_all_that_the_page_advises_changes_only_what_a_table_by_hand_says(studio: Studio) -> None:
    page = studio.page
    first = table_of(FIRST)
    remedied = table_of({**FIRST, "square": ["square demo", "square 1"]})
    made = table_of({**FIRST, "square": ["square demo", "square 1", "square 3"]})

    # The remedy is tried on the other takes of the language's gestures that can be tested.
    known = [
        (was, remedied[name])
        for name, was in first.items()
        if was is not None and was.expected != NONE and name != "square 1"
    ]
    repaired = sum(not was.right and now is not None and now.right for was, now in known)
    broken = sum(was.right and not (now is not None and now.right) for was, now in known)
    remedy = page.locator(".remedies").filter(has_text="with this take as another demonstration")
    expect(remedy).to_contain_text(
        f"repairs {repaired}, breaks {broken} of {len(known)} other takes"
    )
    studio.expect_figures(first)

    studio.open("Studio")
    # The answer of the server may arrive after its event, and after the new test set.
    page.route("**/gestures?*", answer_late, times=1)
    remedy.get_by_role("button").click()
    page.get_by_role("button", name="Keep", exact=True).click()
    studio.expect_change(first, remedied)
    studio.expect_figures(remedied)

    studio.open("Studio")
    # What the language reads unticks rows: a box that is drawn anew under a click is ticked by it.
    with page.expect_response(lambda answer: answer.url.endswith("/take-table")):
        page.get_by_role("button", name="Make gestures of these clips").click()
    dialog = page.get_by_role("dialog", name="Make gestures of these clips")
    rows = dialog.get_by_role("listitem")
    expect(rows.filter(has_text="square 3.mp4").get_by_role("checkbox")).not_to_be_checked()
    for box in dialog.get_by_role("checkbox").all():
        box.uncheck()
    rows.filter(has_text="square 3.mp4").get_by_role("checkbox").check()
    dialog.get_by_role("button", name="Save 1 demonstration").click()
    studio.expect_change(remedied, made)
    studio.expect_figures(made)

    for before, after in ((made, remedied), (remedied, first)):
        page.keyboard.press("Control+z")
        studio.expect_change(before, after)
        studio.expect_figures(after)
