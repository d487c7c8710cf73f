"""The robot's page: it takes language and vehicle table, after it has shown what changes."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect

from app.cli.robots.channels import describe_event
from app.robot.publishing.robot_files import FileKind, RobotFiles
from app.robot.publishing.status_page import StatusPage
from tests.robot.languages import language_of

pytestmark = pytest.mark.slow


TABLE = """
format = "osg-studio/vehicle-table"
version = 1
[gestures]
circle = { do = "lights", percent = 50 }
[phrases]
stop = { do = "hold" }
"""


def test_files_are_replaced_when_their_changes_are_confirmed(
    browser: Browser, tmp_path: Path
) -> None:
    language_of("circle").save(tmp_path / "pool.json")
    (tmp_path / "wrong.toml").write_text("x = 1")
    replaced: list[FileKind] = []
    stored = tmp_path / "language.json"
    files = RobotFiles(stored, tmp_path / "vehicle.toml", None, replaced.append)
    faults: list[str] = []
    with (
        closing(StatusPage("127.0.0.1", 0, describe_event, files)) as page,
        closing(browser.new_page()) as tab,
    ):
        page.wait_for("language.json is missing")
        tab.on("pageerror", lambda error: faults.append(str(error)))
        tab.goto(f"http://127.0.0.1:{page.port}/")
        expect(tab.locator("#state")).to_have_text(
            "The robot does not run yet: language.json is missing"
        )
        expect(tab.locator("#missing")).to_contain_text("There is no vehicle table")
        for answer in ("Keep the old one", "Replace the file"):
            tab.get_by_label("Language").set_input_files([])
            tab.get_by_label("Language").set_input_files(tmp_path / "pool.json")
            expect(tab.locator("#changes li").first).to_have_text("gesture 'circle': added")
            assert not stored.exists()
            tab.get_by_role("button", name=answer).click()
            expect(tab.locator("#proposal")).to_be_hidden()
        expect(tab.locator("#answer")).to_have_text("The language is replaced.")
        assert stored.read_bytes() == (tmp_path / "pool.json").read_bytes()
        tab.get_by_label("Vehicle table").set_input_files(tmp_path / "wrong.toml")
        expect(tab.locator("#answer")).to_contain_text("see docs/robots/mavlink.md")
        # What would be sent, before anybody dives.
        tab.get_by_text("What would be sent to the vehicle").click()
        expect(tab.locator("#no-actions")).to_be_visible()
        (tmp_path / "table.toml").write_text(TABLE)
        tab.get_by_label("Vehicle table").set_input_files(tmp_path / "table.toml")
        tab.get_by_role("button", name="Replace the file").click()
        rows = tab.get_by_role("table").get_by_role("row")
        expect(rows).to_have_text(
            [
                "ShownDoesSends",
                "gesture circlelights 50 %DO_SET_SERVO 13, 1500",
                "phrase stopholdDO_SET_MODE ALT_HOLD",
            ]
        )
    replaced.pop()
    assert replaced == ["language"]
    assert faults == []
