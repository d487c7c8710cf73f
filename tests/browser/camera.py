"""A browser's simulated camera, and reading the page's picture of it."""

from __future__ import annotations

import json
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import av
from playwright.sync_api import Page, WebSocket

from tests.api.running import until

LONGEST_GAP = 0.4
"""Seconds between two looks of the server, of which a salute of the clips contains at least two."""

VIDEO = "document.querySelector('.view:not([hidden]) .camera-picture video')"


def camera_showing(feed: Path) -> tuple[str, ...]:
    """Return Chromium's arguments for a permitted camera that shows a feed in a loop."""
    return (
        "--use-fake-device-for-media-stream",
        "--use-fake-ui-for-media-stream",
        f"--use-file-for-fake-video-capture={feed}",
    )


MIRRORS = 'getComputedStyle(document.querySelector("%s")).transform.startsWith("matrix(-1")'
"""JavaScript: whether an element is shown mirrored, by its selector."""

OTHER_VIEWS = f"({MIRRORS}) !== ({MIRRORS})"
"""JavaScript: whether only one of two elements is mirrored. A diver who follows the arrow of one in
the picture of the other then moves the other way."""


def write_feed(
    clip: Path, feed: Path, rate: int, *, still: int = 0, backward: bool = False
) -> Path:
    """Write every second frame of a 640 x 480 clip as a camera's feed, at `rate` Hz.

    The first picture is shown for `still` seconds before.
    """
    with av.open(str(clip)) as source, feed.open("wb") as camera:
        camera.write(f"YUV4MPEG2 W640 H480 F{rate}:1 Ip A1:1 C420mpeg2\n".encode())
        frames = [frame.to_ndarray(format="yuv420p") for frame in source.decode(video=0)][::2]
        frames = frames[::-1] if backward else frames
        for frame in [frames[0]] * still * rate + frames:
            camera.write(b"FRAME\n" + frame.tobytes())
    return feed


def see_seconds(page: Page, seconds: float) -> None:
    """Wait until the camera has shown some more seconds; a busy machine takes longer."""
    shown = f"{VIDEO}.currentTime"
    begun = float(page.evaluate(shown))
    until(lambda: page.evaluate(shown) > begun + seconds)


def watch_looks(page: Page) -> list[list[float]]:
    """Collect from now on at which of the camera's seconds the server looked, by live view."""
    views = list[list[float]]()

    def watch(socket: WebSocket) -> None:
        if not socket.url.endswith("/live"):
            return
        times = list[float]()
        views.append(times)

        def keep(message: str | bytes) -> None:
            answer = json.loads(message)
            if answer["kind"] == "seen":
                times.append(answer["time"])

        socket.on("framereceived", keep)

    page.on("websocket", watch)
    return views


def looked_often(times: Sequence[float]) -> bool:
    """Whether no salute can have been missed: a loaded machine looks too seldom.

    The first two looks wait for the models, and do not count.
    """
    return all(after - before < LONGEST_GAP for before, after in pairwise(times[2:]))
