"""Faults of accessibility that axe finds in a page."""

from __future__ import annotations

from axe_playwright_python.sync_playwright import Axe  # type: ignore[import-untyped]
from playwright.sync_api import Page

SERIOUS = {"serious", "critical"}


def faults(page: Page) -> list[str]:
    """Return the serious faults that axe finds, with their elements."""
    # viser's frame is another project's page.
    found = Axe().run(page, context={"exclude": ["#lab"]}).response["violations"]
    return [
        f"{fault['id']}: {[node['html'][:120] for node in fault['nodes']]}"
        for fault in found
        if fault["impact"] in SERIOUS
    ]
