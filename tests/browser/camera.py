"""What a browser's camera shows, and what the page's own picture of it tells."""

from __future__ import annotations

from pathlib import Path

import av
from playwright.sync_api import Page

from tests.api.running import until

VIDEO = "document.querySelector('.view:not([hidden]) .camera-picture video')"


def camera_showing(feed: Path) -> tuple[str, ...]:
    """Return Chromium's arguments for a camera that is allowed and shows a feed again and again."""
    return (
        "--use-fake-device-for-media-stream",
        "--use-fake-ui-for-media-stream",
        f"--use-file-for-fake-video-capture={feed}",
    )


def write_feed(clip: Path, feed: Path, rate: int) -> Path:
    """Write every second frame of a clip of 640 x 480 as what a camera shows, at `rate` Hz."""
    with av.open(str(clip)) as source, feed.open("wb") as camera:
        camera.write(f"YUV4MPEG2 W640 H480 F{rate}:1 Ip A1:1 C420mpeg2\n".encode())
        for index, frame in enumerate(source.decode(video=0)):
            if index % 2 == 0:
                camera.write(b"FRAME\n" + frame.to_ndarray(format="yuv420p").tobytes())
    return feed


def see_seconds(page: Page, seconds: float) -> None:
    """Wait until the camera showed that much more: a busy machine needs longer for its frames."""
    shown = f"{VIDEO}.currentTime"
    begun = float(page.evaluate(shown))
    until(lambda: page.evaluate(shown) > begun + seconds)
