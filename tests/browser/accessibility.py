"""Faults of accessibility that axe finds in a page."""

from __future__ import annotations

from typing import Literal

from axe_playwright_python.base import AXE_SCRIPT  # type: ignore[import-untyped]
from playwright.sync_api import Page

SCHEMES: tuple[Literal["dark", "light"], ...] = ("dark", "light")

RUN = """async () => {
  const context = { exclude: ["#lab"] }; // viser's frame is another project's page
  const rules = { "label-content-name-mismatch": { enabled: true } }; // axe has it switched off
  const { violations } = await axe.run(context, { rules, resultTypes: ["violations"] });
  return violations.map(({ id, nodes }) =>
    `${id}: ${nodes.map(({ html }) => html.slice(0, 120)).join("; ")}`);
}"""
"""Only the faults leave the page: what axe tells of everything else takes more time than its
search."""


def faults(page: Page) -> list[str]:
    """Return the faults that axe finds, however slight, with their elements."""
    page.evaluate(AXE_SCRIPT)
    return [str(fault) for fault in page.evaluate(RUN)]
