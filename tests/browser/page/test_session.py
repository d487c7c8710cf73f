"""The page of a server with named tokens: sign-in, limits of a role, log-out."""

from __future__ import annotations

import re
from pathlib import Path

from playwright.sync_api import Browser, Route, expect

from app.settings import Settings
from app.store import Role, TokenFile
from tests.api.running import client_of, running
from tests.browser.files import drop
from tests.browser.library import add_clip, library_of

MISREAD = "unfinished-triangle.mp4"
"""Name of the example's clip."""

CLIPS = re.compile(r"/api/v1/clips(\?|$)")
"""Addresses of the list of clips."""


def test_a_reader_signs_in_sees_why_nothing_can_be_changed_and_logs_out(
    browser: Browser, tmp_path: Path
) -> None:
    settings = Settings(data_dir=tmp_path / "data", samples_dir=tmp_path / "none")
    tokens = TokenFile(settings.tokens)
    token, editor = tokens.add("Ada", Role.READ), tokens.add("Eve", Role.EDIT)
    with (
        running(settings) as server,
        client_of(server.address, headers={"Authorization": f"Bearer {editor}"}) as client,
    ):
        library_of(server, client, "circle")
        page = browser.new_context(base_url=server.address).new_page()
        page.add_init_script("localStorage.setItem('osg-studio.tour', 'seen')")
        page.route("**/viser/**", lambda route: route.fulfill(body=""))
        page.goto("/")
        page.get_by_label("Token").fill(token)
        page.get_by_role("button", name="Sign in").click()
        expect(page.locator("#session")).to_contain_text("Signed in as Ada (read)")
        assert "token" not in page.url
        refused = page.evaluate(
            "fetch('/api/v1/languages', {method: 'POST', body: '{\"name\": \"x\"}', "
            "headers: {'Content-Type': 'application/json'}}).then((answer) => answer.json())"
        )
        assert refused["code"] == "role_required"
        for control in (
            "New language",
            "Save as gesture",
            "Make gestures of these clips",
            "Delete circle.mp4",
            "Delete line",
        ):
            button = page.get_by_role("button", name=control, exact=control.startswith("Delete"))
            expect(button).to_be_disabled()
            expect(button).to_have_attribute("title", re.compile("has the role read"))
        file = tmp_path / "pool.json"
        file.write_text("{}", encoding="utf-8")
        drop(page, file)
        expect(page.get_by_text("Nothing was added")).to_be_visible()
        # Recognition changes no shared data.
        page.get_by_role("list", name="Clips").get_by_role("button", name="Show circle.mp4").click()
        page.get_by_role("button", name="Recognise", exact=True).click()
        expect(page.locator("#outcome")).to_contain_text("Recognised as circle")
        page.get_by_role("button", name="Log out").click()
        expect(page.get_by_label("Token")).to_be_visible()
        page.context.close()


def test_a_page_whose_session_has_ended_asks_to_sign_in(browser: Browser, tmp_path: Path) -> None:
    settings = Settings(data_dir=tmp_path / "data", samples_dir=tmp_path / "none")
    tokens = TokenFile(settings.tokens)
    token = tokens.add("Ada", Role.EDIT)
    with running(settings) as server:
        context = browser.new_context(base_url=server.address)
        context.add_init_script("localStorage.setItem('osg-studio.tour', 'seen')")
        context.route("**/viser/**", lambda route: route.fulfill(body=""))
        page = context.new_page()
        page.goto(f"/?token={token}")
        expect(page.locator("#connection")).to_have_text("Connected")
        other = context.new_page()
        other.goto("/")
        other.get_by_role("button", name="Log out").click()
        # Chromium may never close a page whose navigation has just begun.
        expect(other.get_by_label("Token")).to_be_visible()
        other.close()
        expect(page.get_by_label("Token")).to_be_visible(timeout=30_000)
        page.get_by_label("Token").fill(token)
        page.get_by_role("button", name="Sign in").click()
        expect(page.locator("#connection")).to_have_text("Connected")
        tokens.remove("Ada")
        expect(page.get_by_label("Token")).to_be_visible(timeout=30_000)
        context.close()


def test_a_reader_is_told_who_can_open_the_example(browser: Browser, tmp_path: Path) -> None:
    settings = Settings(data_dir=tmp_path / "data")
    token = TokenFile(settings.tokens).add("Ada", Role.READ)
    with running(settings) as server:
        page = browser.new_context(base_url=server.address).new_page()
        page.add_init_script("localStorage.setItem('osg-studio.tour', 'seen')")
        page.route("**/viser/**", lambda route: route.fulfill(body=""))
        page.goto("/")
        page.get_by_label("Token").fill(token)
        page.get_by_role("button", name="Sign in").click()
        welcome = page.locator("#welcome")
        expect(welcome.get_by_role("button", name="Why was a")).to_be_disabled()
        expect(welcome).to_contain_text("Ask someone whose token has the role edit")
        page.get_by_role("button", name="All keys").click()
        page.get_by_role("dialog").get_by_role("button", name="Example").click()
        expect(page.get_by_text("The example needs the role edit")).to_be_visible()
        # Once somebody has added its clip, readers can open it too, even before the list is loaded.
        add_clip(server, "circle", name=MISREAD)
        held: list[Route] = []
        page.route(CLIPS, lambda route: held.append(route))
        page.reload()
        page.get_by_role("button", name="All keys").click()
        page.get_by_role("dialog").get_by_role("button", name="Example").click()
        page.unroute(CLIPS)
        held.pop().continue_()
        expect(page.locator("#clip-name")).to_have_text(MISREAD)
        expect(page.locator("#outcome")).to_contain_text("ecognised")
        page.context.close()


def test_an_administrator_reads_who_changed_what_and_an_editor_what_is_left(
    browser: Browser, tmp_path: Path
) -> None:
    settings = Settings(data_dir=tmp_path / "data", samples_dir=tmp_path / "none")
    tokens = TokenFile(settings.tokens)
    admin, editor = tokens.add("Mia", Role.ADMIN), tokens.add("Eve", Role.EDIT, quota_clips=5)
    with running(settings) as server:
        headers = {"Authorization": f"Bearer {editor}"}
        with client_of(server.address, headers=headers) as client:
            client.post("/api/v1/languages", json={"name": "pool"})
        page = browser.new_context(base_url=server.address).new_page()
        page.add_init_script("localStorage.setItem('osg-studio.tour', 'seen')")
        page.route("**/viser/**", lambda route: route.fulfill(body=""))
        page.goto(f"/?token={admin}")
        page.get_by_role("button", name="Audit log").click()
        dialog = page.get_by_role("dialog", name="Audit log")
        change = dialog.get_by_role("row").nth(1)
        expect(change).to_contain_text("Eve")
        expect(change).to_contain_text("POST /api/v1/languages")
        nothing = dialog.get_by_text("Nobody has changed anything of that kind.")
        for field, value in (("Name", "Mia"), ("From", "2999-01-01"), ("To", "1999-12-31")):
            control = dialog.get_by_label(field, exact=True)
            control.fill(value)
            control.blur()
            expect(nothing).to_be_visible()
            control.fill("")
            control.blur()
            expect(change).to_contain_text("Eve")
        page.goto("/")
        page.get_by_role("button", name="Log out").click()
        page.get_by_label("Token").fill(editor)
        page.get_by_role("button", name="Sign in").click()
        expect(page.locator("#quota")).to_have_text("Your quota: 0 of 5 clips used")
        expect(page.locator("#audit-log")).to_be_hidden()
        page.context.close()
