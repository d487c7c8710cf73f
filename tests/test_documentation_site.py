"""The documentation's site: builds without warnings, holds the reference, needs no network."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect, sync_playwright

import app.recognition
from app.cli.application import command_line
from app.recognition import OsgError
from app.server import create_app
from app.settings import Limits, Settings
from tests.browser.conftest import started
from tests.conftest import ROOT

mkdocs = pytest.importorskip("mkdocs.commands.build")


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build the site as `make docs` does: a dead link, anchor or docstring is an error."""
    from mkdocs.config import load_config

    folder = tmp_path_factory.mktemp("site")
    configuration = load_config(str(ROOT / "mkdocs.yml"), site_dir=str(folder))
    assert configuration.strict
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(ROOT)
        configuration.plugins.on_startup(command="build", dirty=False)
        mkdocs.build(configuration)
    return folder


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with sync_playwright() as playwright, started(playwright.chromium) as browser:
        yield browser


class Loaded(HTMLParser):
    """Collects the addresses that a page loads by itself."""

    def __init__(self) -> None:
        super().__init__()
        self.addresses: set[str] = set()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        attributes = dict(attrs)
        key = {"script": "src", "img": "src", "iframe": "src", "link": "href", "source": "src"}
        if tag in key and (address := attributes.get(key[tag])):
            self.addresses.add(address)


def pages_of(site: Path) -> list[Path]:
    return sorted(page for page in site.rglob("*.html") if page.name != "404.html")


def loaded_by(page: Path) -> set[str]:
    """Return the addresses of what a page loads by itself, as they stand in it."""
    loaded = Loaded()
    loaded.feed(page.read_text(encoding="utf-8"))
    return loaded.addresses


def text_of(site: Path, page: str) -> str:
    return re.sub(r"<[^>]+>", "", (site / page).read_text(encoding="utf-8"))


@pytest.mark.slow
def test_pages_and_styles_load_nothing_from_elsewhere(site: Path) -> None:
    for page in pages_of(site):
        addresses = loaded_by(page)
        assert addresses
        for address in addresses:
            assert "//" not in address, f"{page.name} loads {address}"
            assert address.startswith("data:") or (page.parent / address.split("?")[0]).exists()
    for style in site.rglob("*.css"):
        for address in re.findall(r"url\(\s*[\"']?([^)\"']+)|@import", style.read_text("utf-8")):
            assert address.startswith(("data:", "#")) or "//" not in address


@pytest.mark.slow
def test_every_kind_of_page_opens_from_a_disk_without_a_network(
    site: Path, browser: Browser
) -> None:
    context = browser.new_context()
    page = context.new_page()
    elsewhere: list[str] = []
    errors: list[str] = []
    page.on(
        "request",
        lambda request: (
            None
            if request.url.startswith((site.as_uri(), "data:", "blob:"))
            else elsewhere.append(request.url)
        ),
    )
    page.on("pageerror", lambda error: errors.append(str(error)))
    # Pages that load the same scripts and styles, from as deep a folder, are of one kind.
    code = re.compile(r"\.(js|css)$")
    kinds = {frozenset(filter(code.search, loaded_by(path))): path for path in pages_of(site)}
    assert len(kinds) > 1
    for path in kinds.values():
        page.goto(path.as_uri())
        assert (elsewhere, errors) == ([], []), path.name
    context.close()


@pytest.mark.slow
def test_the_search_works_from_a_disk(site: Path, browser: Browser) -> None:
    page: Page = browser.new_page(viewport={"width": 1280, "height": 900})
    page.goto((site / "index.html").as_uri())
    field = page.get_by_role("textbox", name="Search")
    field.click()
    field.press_sequentially("Zenoh")
    expect(page.locator(".md-search-result__link").first).to_have_attribute(
        "href", re.compile("publish-over-dds")
    )
    page.close()


@pytest.mark.slow
def test_the_reference_holds_every_command_call_name_setting_and_event(site: Path) -> None:
    commands = text_of(site, "reference/command-line.html")
    for command in command_line.registered_commands:
        assert command.callback is not None
        assert f"osg-studio {command.callback.__name__}" in commands
    calls = text_of(site, "reference/http.html")
    for path, methods in create_app(Settings()).openapi()["paths"].items():
        for method in methods:
            assert f"{method.upper()} {path.removeprefix('/api/v1')}" in calls
    names = text_of(site, "reference/python.html")
    errors = text_of(site, "reference/errors.html")
    for name in app.recognition.__all__:
        kind = getattr(app.recognition, name)
        is_error = isinstance(kind, type) and issubclass(kind, OsgError)
        assert name in (errors if is_error else names)
    settings = text_of(site, "reference/settings.html")
    for name in Settings.model_fields:
        assert f"OSG_{name.upper()}" in settings
    for name in Limits.model_fields:
        assert name in settings
    schema = json.loads((site / "reference" / "robot-event-1.schema.json").read_text("utf-8"))
    events = text_of(site, "reference/robot-events.html")
    for event in schema["discriminator"]["mapping"]:
        assert event in events
    document = json.loads((site / "reference" / "gesture-language-1.schema.json").read_text())
    keys = text_of(site, "reference/language-file.html")
    for definition in document["$defs"].values():
        assert all(key in keys for key in definition.get("properties", ()))
