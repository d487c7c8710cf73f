"""First take: the film of the start page, in which a diver defines a gesture in three seconds.

The sample's diver shows salute, stroke, salute, twice as fast. The stroke is drawn along the wrist
and on a card beside the diver; the gesture's name comes last. After a change of the sample clip run
``python -m languages.first_take`` from the repository's root.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import av
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from app.recognition import record
from app.recognition.poses.sequence import FloatArray
from languages.build import FOLDER
from languages.render.encode import Frame, encode_within_limit

FILM = FOLDER.parent / "static" / "first-take.mp4"

LABEL = "circle"

SIZE = (640, 360)
"""Width and height of the film, pixels."""

CROP = (64, 24, 640, 348)
"""The part of the clip's picture that is shown: left, top, right, bottom, pixels."""

CARD = (424, 64, 608, 248)
"""The card on which the drawing appears: left, top, right, bottom, pixels."""

CAPTION = (16, 316, 168, 346)
"""Where the film says what the diver does: left, top, right, bottom, pixels."""

CAPTIONS = {"salute": "Vulcan salute", "stroke": "the gesture"}

SPEED = 2
LEAD = 0.2
"""Seconds of the clip before the first salute is held."""
HOLD = 0.8
"""Seconds for which the last picture stands."""

GROUND = (11, 17, 24)
INK = (226, 236, 246)
STROKE = (255, 255, 255)
DOT = (58, 134, 255)
"""Colours of the page's pictures (`static/styles/tokens.css`)."""

CARD_SHARE = 0.62
"""How much of the card's width the drawing takes."""

FINER = 3
"""Lines are drawn so many times larger, then made smaller: Pillow does not smooth them."""


def draw_film(clip: Path, phases: Sequence[tuple[str, float, float]]) -> tuple[list[Frame], int]:
    """Draw the film's pictures; return them and their rate in pictures per second.

    `phases` says what the diver of the clip does: name, start and end in seconds.
    """
    poses = record(clip).poses
    with av.open(str(clip)) as container:
        decoded = container.decode(video=0)
        pictures = [Image.fromarray(frame.to_ndarray(format="rgb24")) for frame in decoded]
        rate = round(float(container.streams.video[0].average_rate or 0))
    time, wrist = poses.time, poses.xy[:, poses.landmarks.index("right_wrist")]
    points = (wrist - CROP[:2]) * SIZE[0] / (CROP[2] - CROP[0])
    opens, closes = [(start, end) for name, start, end in phases if name == "salute"]
    ((begin, end),) = [(start, end) for name, start, end in phases if name == "stroke"]
    stroke = (time >= begin) & (time <= end)
    frames = []
    for index in np.flatnonzero((time >= opens[0] - LEAD) & (time <= closes[1]))[::SPEED]:
        shown = int(np.count_nonzero(stroke & (time <= time[index])))
        saluting = time[index] < opens[1] or time[index] > closes[0]
        caption = CAPTIONS["salute" if saluting else "stroke"]
        named = bool(time[index] > closes[0])
        frames.append(_draw_picture(pictures[index], points[stroke], shown, caption, named=named))
    return frames + [frames[-1]] * round(HOLD * rate), rate


def _draw_picture(
    picture: Image.Image, stroke: FloatArray, shown: int, caption: str, *, named: bool
) -> Frame:
    """Draw one picture with the first `shown` points of the stroke."""
    width, height = SIZE
    size = (FINER * width, FINER * height)
    film = picture.resize(size, Image.Resampling.BICUBIC, box=CROP)
    brush = ImageDraw.Draw(film)
    for box in (CARD, CAPTION):
        brush.rounded_rectangle([FINER * place for place in box], 10 * FINER, GROUND)
    _draw_stroke(brush, stroke[:shown])
    # On the card the stroke is in the middle from the beginning.
    middle = np.array([CARD[0] + CARD[2], CARD[1] + CARD[3]]) / 2
    centre = (np.nanmin(stroke, axis=0) + np.nanmax(stroke, axis=0)) / 2
    scale = CARD_SHARE * (CARD[2] - CARD[0]) / np.ptp(stroke, axis=0).max()
    _draw_stroke(brush, middle + scale * (stroke[:shown] - centre))
    _write(brush, caption, ((CAPTION[0] + CAPTION[2]) / 2, (CAPTION[1] + CAPTION[3]) / 2), 18)
    if named:
        _write(brush, LABEL, (float(middle[0]), CARD[3] + 32), 34)
    return np.asarray(film.resize(SIZE, Image.Resampling.LANCZOS))


def _draw_stroke(brush: ImageDraw.ImageDraw, points: FloatArray) -> None:
    places = [(float(x), float(y)) for x, y in FINER * points]
    if len(places) > 1:
        brush.line(places, STROKE, 5 * FINER, joint="curve")
    for place in places[:1]:
        brush.circle(place, 7 * FINER, DOT)


def _write(
    brush: ImageDraw.ImageDraw, words: str, middle: tuple[float, float], height: int
) -> None:
    place = (FINER * middle[0], FINER * middle[1])
    brush.text(place, words, INK, ImageFont.load_default(height * FINER), anchor="mm")


def main() -> None:
    """Write the film into the page's folder."""
    name = f"{LABEL}-demonstration"
    phases = json.loads((FOLDER / "clips" / "phases.json").read_text())[name]
    frames, rate = draw_film(FOLDER / "clips" / f"{name}.mp4", phases)
    FILM.write_bytes(encode_within_limit(frames, rate))


if __name__ == "__main__":
    main()
