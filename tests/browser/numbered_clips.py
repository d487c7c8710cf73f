"""Clips whose every picture carries its own number, to be read off the screen again."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import av
import cv2
import numpy as np
import numpy.typing as npt
from av.video.stream import VideoStream

WIDTH, HEIGHT = 320, 240
CORNER = 40
"""Side in pixels of the marks in the corners and of the blocks between them."""

BITS = 12
COLUMNS = 4
LEFT, TOP = 80, 60
"""Place of the first block in pixels; the others follow line by line."""

CORNERS = ((255, 0, 0), (0, 255, 0), (255, 255, 0), (0, 0, 255))
"""RGB of the marks: top left, top right, bottom right, bottom left."""

TICKS = 90_000
"""Ticks per second of the clip's clock, as in broadcasts: few frames begin at a whole
millisecond."""

FIRST = 126_000
"""Ticks of the first frame. A clip cut out of a longer one often does not begin at 0."""

GAPS = (3003, 1501, 4504, 9009, 2999, 1801)
"""Ticks between frames, as of a camera that lengthens its exposure in the dark."""

FIXED_ORDER: dict[str, object] = {
    "preset": "veryfast",
    "bf": "2",
    "g": "12",
    "x264-params": "b-adapt=0:b-pyramid=none:scenecut=0:threads=1",
}
"""Two frames out of order after each in order, whichever processor encodes.

An MP4 stores differences of decoding times as durations, so by the file some frames last beyond the
beginning of the next."""

Picture = npt.NDArray[np.uint8]

Marks = list[tuple[float, float]]


def numbered_clip(path: Path, frames: int) -> list[float]:
    """Write a clip as phones do, H.264 with frames out of order; return its frames' seconds."""
    stamps = [FIRST + sum(GAPS[i % len(GAPS)] for i in range(frame)) for frame in range(frames)]
    with av.open(str(path), "w", format="mp4") as container:
        stream = container.add_stream("libx264", rate=30)
        assert isinstance(stream, VideoStream)
        stream.width, stream.height, stream.pix_fmt = WIDTH, HEIGHT, "yuv420p"
        stream.time_base = stream.codec_context.time_base = Fraction(1, TICKS)
        stream.options = FIXED_ORDER
        for number, stamp in enumerate(stamps):
            frame = av.VideoFrame.from_ndarray(numbered(number), format="rgb24")
            frame = frame.reformat(format="yuv420p")
            frame.pts, frame.time_base = stamp, Fraction(1, TICKS)
            container.mux(stream.encode(frame))
        container.mux(stream.encode())
    return [(stamp - FIRST) / TICKS for stamp in stamps]


def numbered(number: int) -> Picture:
    """Paint a number as blocks, white for the ones of its binary form, the lowest first."""
    image = np.full((HEIGHT, WIDTH, 3), 110, np.uint8)
    for (x, y), colour in zip(_corners(CORNER // 2), CORNERS, strict=True):
        _square(image, x, y)[:] = colour
    for bit, (x, y) in enumerate(block_places()):
        _square(image, x, y)[:] = 235 if number >> bit & 1 else 20
    return image


def number_on(screen: bytes) -> int | None:
    """Read the number off a screenshot, however the picture lies in space; None without one."""
    shown = _decoded(screen)
    places = _marks(shown)
    if places is None:
        return None
    painted = np.array(_corners(CORNER // 2), np.float32)
    onto = cv2.getPerspectiveTransform(painted, np.array(places, np.float32))
    blocks = cv2.perspectiveTransform(np.array([block_places()], np.float32), onto)[0]
    lit = [shown[round(float(y)), round(float(x))].mean() > 128 for x, y in blocks]
    return sum(1 << bit for bit, on in enumerate(lit) if on)


def corners_on(screen: bytes) -> Marks | None:
    """Return the marks' places as shares of a screenshot, in the order of `CORNERS`."""
    shown = _decoded(screen)
    height, width = shown.shape[:2]
    places = _marks(shown)
    return None if places is None else [(x / width, y / height) for x, y in places]


def painted_corners() -> Marks:
    """Return the marks' places as shares of the picture."""
    return [(x / WIDTH, y / HEIGHT) for x, y in _corners(CORNER // 2)]


def _decoded(screen: bytes) -> Picture:
    decoded = cv2.imdecode(np.frombuffer(screen, np.uint8), cv2.IMREAD_COLOR_RGB)
    return np.asarray(decoded, np.uint8)


def _marks(shown: Picture) -> Marks | None:
    """Return the middles of the marks in pixels; None unless all are seen."""
    found = [_middle(shown, colour) for colour in CORNERS]
    places = [place for place in found if place is not None]
    return places if len(places) == len(CORNERS) else None


def _corners(inside: int) -> list[tuple[int, int]]:
    right, bottom = WIDTH - inside, HEIGHT - inside
    return [(inside, inside), (right, inside), (right, bottom), (inside, bottom)]


def block_places() -> list[tuple[int, int]]:
    """Return the middles of the blocks in pixels, the lowest bit's first."""
    half = CORNER // 2
    lines = [divmod(bit, COLUMNS) for bit in range(BITS)]
    return [(LEFT + CORNER * column + half, TOP + CORNER * line + half) for line, column in lines]


def _square(image: Picture, x: int, y: int) -> Picture:
    half = CORNER // 2
    return image[y - half : y + half, x - half : x + half]


def _middle(shown: Picture, colour: tuple[int, int, int]) -> tuple[float, float] | None:
    """Return x and y of the middle of the largest patch of a colour."""
    near = (np.abs(np.asarray(shown, np.int16) - np.array(colour)) < 60).all(axis=2)
    count, _, statistics, middles = cv2.connectedComponentsWithStats(near.astype(np.uint8))
    if count < 2:
        return None
    largest = 1 + int(np.argmax(statistics[1:, cv2.CC_STAT_AREA]))
    x, y = middles[largest]
    return float(x), float(y)
