"""Faults of accessibility that axe finds in a page."""

from __future__ import annotations

from axe_playwright_python.sync_playwright import Axe  # type: ignore[import-untyped]
from playwright.sync_api import Page

BESIDE_THE_DEFAULT = {"label-content-name-mismatch": {"enabled": True}}
"""Rules that axe has switched off."""


def faults(page: Page) -> list[str]:
    """Return the faults that axe finds, however slight, with their elements."""
    # viser's frame is another project's page.
    found = (
        Axe()
        .run(page, context={"exclude": ["#lab"]}, options={"rules": BESIDE_THE_DEFAULT})
        .response["violations"]
    )
    return [f"{fault['id']}: {[node['html'][:120] for node in fault['nodes']]}" for fault in found]
