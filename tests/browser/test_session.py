"""The page of a server with named tokens: sign in, be told what one may not, log out."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect

from app.settings import Settings
from app.store import Role, TokenFile
from tests.api.running import running

pytestmark = pytest.mark.slow


def test_a_reader_signs_in_is_refused_an_edit_with_its_reason_and_logs_out(
    browser: Browser, tmp_path: Path
) -> None:
    settings = Settings(data_dir=tmp_path / "data", samples_dir=tmp_path / "none")
    token = TokenFile(settings.tokens).add("Ada", Role.READ)
    with running(settings) as server:
        page = browser.new_context(base_url=server.address).new_page()
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
        page.get_by_role("button", name="New language").click()
        page.get_by_role("dialog").get_by_role("textbox").first.fill("pool")
        page.get_by_role("dialog").get_by_role("button", name="Create").click()
        expect(page.get_by_text("has the role read, and this needs edit")).to_be_visible()
        page.keyboard.press("Escape")
        page.get_by_role("button", name="Log out").click()
        expect(page.get_by_label("Token")).to_be_visible()
        page.context.close()
