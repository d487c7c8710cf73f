"""What the page's own picture of a camera tells."""

from __future__ import annotations

from playwright.sync_api import Page

from tests.api.running import until


def see_seconds(page: Page, seconds: float) -> None:
    """Wait until the camera showed that much more: a busy machine needs longer for its frames."""
    shown = "document.getElementById('live-video').currentTime"
    begun = float(page.evaluate(shown))
    until(lambda: page.evaluate(shown) > begun + seconds)
