"""Charts, and images with direction marks: pure functions, which escape all text of users."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from typing import Final

import cv2
import numpy as np
import numpy.typing as npt

from app.recognition import Gesture, Recognition
from app.recognition.features.contour import BinaryImage
from app.recognition.features.png import to_data_url
from app.recognition.features.trajectory_image import MARGIN, SIZE
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.text.wording import humanize
from app.ui.palette import Rgb, load_palette, parse_colour

RgbImage = npt.NDArray[np.uint8]

ARROW_SHARE = 0.3
"""Share of a path's length at which its arrow is: soon after the start, as on stroke diagrams."""

DOT_RADIUS = 10
ARROW_LENGTH = 26
"""Pixels of the 224 x 224 image, visible on a card of 64 pixels."""

SHORTEST = 12.0
"""Length in pixels of a path that is marked; a shorter one is a resting hand."""

_COLOUR: Final = "picture-accent"
"""Token of the palette; on pictures it is the same in both themes."""


MAX_COLUMNS = 40
"""Gestures shown in the vote table; farther gestures of a larger language explain nothing."""

NONE_OF_THESE = "none of these"
"""Name of an expectation of none of the gestures."""

MAX_CHART_POINTS = 400
"""Points per curve: more than the chart has pixels would only make the page slow."""


def verdict(recognition: Recognition, expected: str | None) -> str:
    """Return a card with the recognised label, the expected label and the support for it."""
    label = recognition.label
    share = recognition.support.get(recognition.nearest, 0.0)
    support = (
        f"confidence {percent(recognition.confidence)}, voters with {percent(share)} of the weight"
    )
    if recognition.pair is not None:
        one, other = (f"<b class='chosen'>{escape(each)}</b>" for each in recognition.pair)
        badge, kind = "?", "chosen"
        text = f"Between two: {one} or {other}?"
    elif label is None:
        badge, kind = "?", "expected"
        told = ", as expected" if expected == "" else ""
        text = f"Not recognised{told}. Nearest is <b>{escape(recognition.nearest)}</b>"
    elif expected is None:
        badge, kind = "\N{BULLET}", "chosen"
        text = f"Recognised as <b class='chosen'>{escape(label)}</b>"
    elif expected == label:
        badge, kind = "\N{CHECK MARK}", "chosen"
        text = f"Recognised as <b class='chosen'>{escape(label)}</b>, as expected"
    else:
        badge, kind = "\N{NOT EQUAL TO}", "expected"
        text = (
            f"Taken for <b class='chosen'>{escape(label)}</b>, "
            f"expected <b class='expected'>{escape(expected or NONE_OF_THESE)}</b>"
        )
    return _block(
        f"<div class='card verdict' role='status'><span class='badge {kind}' aria-hidden='true'>"
        f"{badge}</span><div><p>{text}</p><p class='dim num'>{support}</p></div></div>"
    )


def hint(title: str, text: str) -> str:
    """Return a card that explains an empty panel and the next step."""
    return _block(
        f"<div class='card'><p><b>{escape(title)}</b></p><p class='dim'>{escape(text)}</p></div>"
    )


def vote_table(recognition: Recognition, expected: str | None) -> str:
    """Return a table of every voter's distance to every gesture, with each voter's vote marked.

    One row per voter, by descending weight; rows of weight 0 are faint. One column per gesture,
    the nearest first. Each voter has its own unit, so shades are
    comparable within a row only: the stronger, the nearer. A vote has a dot and a frame, the
    expected and the chosen gesture have a tag, so that no meaning depends on colour alone.
    """
    support = recognition.support
    nearness = _nearness(recognition.distances)
    weights = np.array([recognition.weights[voter] for voter in recognition.voters])
    near = weights @ nearness if len(nearness) else np.zeros(len(recognition.gestures))
    # The order of the decision, so that the table ranks the gestures as the answer does.
    ranked = recognition.scores if recognition.scores.size else -near
    columns = sorted(
        range(len(recognition.gestures)),
        key=lambda column: (
            recognition.gestures[column] != recognition.nearest,
            float(ranked[column]),
            -float(near[column]),
        ),
    )
    hidden = len(columns) - MAX_COLUMNS
    columns = columns[:MAX_COLUMNS]
    heads = "".join(_gesture_head(recognition, column, expected) for column in columns)
    rows = "".join(
        _vote_row(recognition, int(row), columns, nearness[row])
        for row in np.argsort(-weights, kind="stable")
    )
    totals = "".join(
        f"<td class='votes'>{percent(support.get(recognition.gestures[column], 0.0))}</td>"
        for column in columns
    )
    rest = f"<p class='dim'>{hidden} farther gestures are not shown.</p>" if hidden > 0 else ""
    return _block(
        "<h3>Distance to every gesture, as each voter measures it</h3><div class='scroll'>"
        f"<table aria-label='Votes'><thead><tr><th scope='col'>voter</th>"
        f"<th scope='col'>weight</th>{heads}</tr></thead><tbody>{rows}</tbody>"
        f"<tfoot><tr><th scope='row' colspan='2'>weight of its voters</th>{totals}</tr></tfoot>"
        "</table></div>"
        "<p class='dim'>\N{BLACK CIRCLE} a voter\N{RIGHT SINGLE QUOTATION MARK}s choice. "
        "The stronger the shade, the nearer, within a row. Voters of weight 0 do not separate "
        "these gestures.</p>" + rest
    )


def _gesture_head(recognition: Recognition, column: int, expected: str | None) -> str:
    gesture = recognition.gestures[column]
    is_chosen = gesture in (recognition.pair or (recognition.label,))
    kind = "chosen" if is_chosen else "expected" if gesture == expected else ""
    tags = ""
    if is_chosen:
        # Two tags side by side would lie over the next column.
        answer = "one of two" if recognition.pair else "chosen"
        word = f"{answer}, expected" if gesture == expected else answer
        tags = f"<span class='tag chosen'>{word}</span>"
    elif gesture == expected:
        tags = "<span class='tag expected'>expected</span>"
    return (
        f"<th scope='col' class='gesture {kind}' title='{escape(gesture)}'>"
        f"<span>{escape(gesture)}{tags}</span></th>"
    )


def _vote_row(
    recognition: Recognition, row: int, columns: Sequence[int], nearness: FloatArray
) -> str:
    voter = recognition.voters[row]
    weight = recognition.weights[voter]
    choice = recognition.votes.get(voter)
    cells = "".join(
        _vote_cell(
            float(recognition.distances[row, column]),
            float(nearness[column]),
            recognition.gestures[column] == choice,
        )
        for column in columns
    )
    mute = "" if weight > 0 else " class='mute'"
    return (
        f"<tr{mute}><th scope='row'>{escape(humanize(voter))}</th>"
        f"<td class='share'>{escape(percent(weight))}</td>{cells}</tr>"
    )


def percent(share: float) -> str:
    """Format a share in [0, 1] as the page does."""
    return "<1 %" if 0 < share < 0.005 else f"{100 * share:.0f} %"


def _vote_cell(distance: float, nearness: float, chosen: bool) -> str:
    share = f"{0.04 + 0.42 * nearness**2:.0%}"
    shade = f"background:color-mix(in srgb,var(--osg-accent) {share},transparent)"
    kind = " class='choice'" if chosen else ""
    return f"<td{kind} style='{shade}'>{short_number(distance)}</td>"


def _nearness(distances: FloatArray) -> FloatArray:
    """Scale ``(V, G)`` distances per voter to 1 (nearest) .. 0 (farthest); not finite is 0."""
    finite = np.where(np.isfinite(distances), distances, np.nan)
    if finite.size == 0:
        return np.zeros_like(distances)
    low = np.nanmin(np.where(np.isnan(finite), np.inf, finite), axis=1, keepdims=True)
    high = np.nanmax(np.where(np.isnan(finite), -np.inf, finite), axis=1, keepdims=True)
    span = np.where(high > low, high - low, 1.0)
    return np.asarray(np.nan_to_num(1.0 - (finite - low) / span, nan=0.0), dtype=np.float64)


def image_row(images: Sequence[tuple[str, npt.NDArray[np.uint8]]]) -> str:
    """Return trajectory images side by side, each ``(H, W)`` grey or ``(H, W, 3)`` RGB."""
    figures = "".join(
        f"<figure><img alt='trajectory image: {escape(caption)}' src='{data_url(image)}'>"
        f"<figcaption>{escape(caption)}</figcaption></figure>"
        for caption, image in images
    )
    return _block(f"<h3>What the voters compared</h3><div class='images'>{figures}</div>")


@dataclass(frozen=True)
class Curve:
    """One line of a chart.

    Attributes
    ----------
    name
        Shown in the legend.
    values
        ``(T,)``; NaN interrupts the line.
    colour
        A CSS colour.
    dashed
        Drawn dashed, so that two curves differ by more than colour.

    """

    name: str
    values: FloatArray
    colour: str
    dashed: bool = False


def line_chart(
    title: str,
    time: FloatArray,
    curves: Sequence[Curve],
    *,
    bounds: tuple[float, float] | None = None,
    height: int = 110,
) -> str:
    """Draw curves over time as SVG, with a cursor at the CSS variable ``--osg-now``.

    Parameters
    ----------
    title
        Title of the chart, with the unit.
    time
        ``(T,)`` seconds, increasing.
    curves
        Each with T values.
    bounds
        Least and largest value of the axis; by default those of the curves.
    height
        Height of the plot, in the units of a picture that is 340 wide.

    """
    if len(time) < 2:
        return ""
    step = max(1, len(time) // MAX_CHART_POINTS)
    low, high = bounds or _range([curve.values for curve in curves])
    left, right, width = 34.0, 6.0, 340.0
    x = left + (time - time[0]) / (time[-1] - time[0]) * (width - left - right)
    paths = []
    for curve in curves:
        y = height - (curve.values - low) / (high - low) * height
        dash = " stroke-dasharray='5 3'" if curve.dashed else ""
        paths.append(
            f"<path d='{_path(x[::step], y[::step])}' fill='none' stroke='{curve.colour}' "
            f"stroke-width='1.8' stroke-linejoin='round'{dash}/>"
        )
    grid = "".join(
        f"<line x1='{left}' x2='{width - right}' y1='{at:.1f}' y2='{at:.1f}' "
        "stroke='var(--osg-line)'/>"
        f"<text x='{left - 6}' y='{at + 3.5:.1f}' text-anchor='end' font-size='10' "
        f"fill='var(--osg-dim)'>{value:.2g}</text>"
        for value, at in ((high, 0.0), ((low + high) / 2, height / 2), (low, float(height)))
    )
    ticks = "".join(
        f"<text x='{left + share * (width - left - right):.1f}' y='{height + 14}' "
        f"text-anchor='{anchor}' font-size='10' fill='var(--osg-dim)'>"
        f"{time[0] + share * (time[-1] - time[0]):.1f} s</text>"
        for share, anchor in ((0.0, "start"), (0.5, "middle"), (1.0, "end"))
    )
    return _block(
        f"<h3>{escape(title)}</h3><div class='chart'>"
        f"<svg viewBox='0 0 {width:g} {height + 18}' role='img' aria-label='{escape(title)}'>"
        f"{grid}{ticks}{''.join(paths)}</svg><div class='cursor'><i></i></div></div>"
        f"<ul class='legend'>{''.join(_legend(curve) for curve in curves)}</ul>"
    )


def cursor(share: float) -> str:
    """Return CSS that moves the cursor of every chart to `share` (0 .. 1) of its time axis."""
    return f"<style>:root {{ --osg-now: {100 * min(max(share, 0.0), 1.0):.2f}% }}</style>"


def short_number(value: float) -> str:
    """Format a distance in at most four characters, or more if its size needs them."""
    if not np.isfinite(value):
        return "\N{INFINITY}" if value > 0 else "\N{EN DASH}"
    if value == 0:
        return "0"
    if abs(value) < 0.001:
        return f"{value:.0e}".replace("e-0", "e-")
    decimals = 3 if abs(value) < 0.1 else 2 if abs(value) < 10 else 1 if abs(value) < 100 else 0
    return f"{value:.{decimals}f}".removeprefix("0")


def _legend(curve: Curve) -> str:
    dash = " stroke-dasharray='5 3'" if curve.dashed else ""
    return (
        "<li><svg width='20' height='4' style='display:inline;width:20px'>"
        f"<line x1='0' x2='20' y1='2' y2='2' stroke='{curve.colour}' stroke-width='2'{dash}/>"
        f"</svg>{escape(curve.name)}</li>"
    )


def _path(x: FloatArray, y: FloatArray) -> str:
    """Write an SVG path that lifts the pen where a value is NaN."""
    pieces, drawing = [], False
    for at, value in zip(x, y, strict=True):
        if np.isfinite(value):
            pieces.append(f"{'L' if drawing else 'M'}{at:.1f} {value:.1f}")
        drawing = bool(np.isfinite(value))
    return "".join(pieces)


def _range(values: Sequence[FloatArray]) -> tuple[float, float]:
    """Return the least and the largest finite value, never equal."""
    finite = np.concatenate([curve[np.isfinite(curve)] for curve in values] or [np.zeros(0)])
    if not len(finite):
        return 0.0, 1.0
    low, high = float(finite.min()), float(finite.max())
    return (low, high) if high > low else (low - 0.5, high + 0.5)


def data_url(image: npt.NDArray[np.uint8]) -> str:
    """Return an image as data URI of a PNG."""
    return to_data_url(png(image))


def png(image: npt.NDArray[np.uint8]) -> bytes:
    """Encode an image, ``(H, W)`` grey or ``(H, W, 3)`` RGB, as PNG."""
    pixels = image[..., ::-1] if image.ndim == 3 else image
    encoded = cv2.imencode(".png", np.ascontiguousarray(pixels))[1]
    return encoded.tobytes()


def shrink(image: npt.NDArray[np.uint8], most_width: int) -> npt.NDArray[np.uint8]:
    """Return an image no wider than allowed."""
    height, width = image.shape[:2]
    if width <= most_width:
        return image
    size = (most_width, max(1, round(height * most_width / width)))
    return np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), np.uint8)


def encode_jpeg(image: npt.NDArray[np.uint8], quality: int) -> bytes:
    """Return an image ``(H, W, 3)`` RGB as JPEG."""
    bgr = cv2.cvtColor(image, cv2.COLOR_RGB2BGR)
    return cv2.imencode(".jpg", bgr, [cv2.IMWRITE_JPEG_QUALITY, quality])[1].tobytes()


def _block(content: str) -> str:
    return f"<div class='osg'>{content}</div>"


def mark_direction(image: BinaryImage, trajectory: Trajectory | None) -> RgbImage:
    """Return a trajectory image in RGB, with a start dot and an arrow on each path.

    Parameters
    ----------
    image
        As the recogniser draws it, ``(224, 224)``.
    trajectory
        The salient landmarks' trajectory that it shows; None: no direction is known.

    """
    marked = np.repeat(np.asarray(image, np.uint8)[..., None], 3, axis=2)
    if trajectory is None:
        return marked
    colour = parse_colour(load_palette().dark[_COLOUR])
    for path in _pixel_paths(trajectory):
        lengths = measure_lengths(path)
        if lengths[-1] >= SHORTEST:
            _draw_arrow(marked, path, lengths, colour)
            start = (round(float(path[0, 0])), round(float(path[0, 1])))
            cv2.circle(marked, start, DOT_RADIUS, colour, cv2.FILLED, cv2.LINE_AA)
    return marked


def mark_gesture(gesture: Gesture) -> RgbImage:
    """Return a gesture's trajectory image with the marks of its demonstration."""
    trajectory = gesture.trajectory
    salient = None if trajectory is None else trajectory.select(gesture.salient)
    return mark_direction(gesture.image, salient)


def _pixel_paths(trajectory: Trajectory) -> list[FloatArray]:
    """Return each landmark's path in pixels of the image, without gaps; see `draw`."""
    seen = trajectory.xy[np.isfinite(trajectory.xy).all(axis=2)]
    extent = float(np.ptp(seen, axis=0).max()) if len(seen) else 0.0
    if extent == 0:
        return []
    middle = (seen.min(axis=0) + seen.max(axis=0)) / 2
    scale = (SIZE - 1 - 2 * MARGIN) / extent
    return [(path - middle) * scale + (SIZE - 1) / 2 for _, path in list_seen_paths(trajectory)]


def _draw_arrow(marked: RgbImage, path: FloatArray, lengths: FloatArray, colour: Rgb) -> None:
    """Draw an arrow head that points along the path."""
    at = ARROW_SHARE * lengths[-1]
    tail, tip = find_chord(path, lengths, at, min(ARROW_LENGTH / 2, at, lengths[-1] - at))
    if (tip != tail).any():
        corners = list_arrow_corners(tip, tip - tail, ARROW_LENGTH, ARROW_LENGTH / 2, 4)
        cv2.fillPoly(marked, [np.rint(corners).astype(np.int32)], colour, cv2.LINE_AA)


def list_seen_paths(trajectory: Trajectory) -> list[tuple[str, FloatArray]]:
    """Return the name and the path without gaps of each landmark that is seen more than once."""
    known = np.asarray(np.isfinite(trajectory.xy).all(axis=2))
    return [
        (name, trajectory.xy[known[:, row], row])
        for row, name in enumerate(trajectory.landmarks)
        if known[:, row].sum() > 1
    ]


def measure_lengths(path: FloatArray) -> FloatArray:
    """Return the length of a path ``(N, 2)`` up to each of its points."""
    return np.concatenate([[0.0], np.hypot(*np.diff(path, axis=0).T).cumsum()])


def find_chord(
    path: FloatArray, lengths: FloatArray, at: float, reach: float
) -> tuple[FloatArray, FloatArray]:
    """Return the points of a path that lie `reach` before and after the length `at`."""
    before, after = (
        np.array([np.interp(place, lengths, path[:, axis]) for axis in (0, 1)])
        for place in (at - reach, at + reach)
    )
    return before, after


def list_arrow_corners(
    tip: FloatArray, along: FloatArray, length: float, half_width: float, beyond: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the corners of an arrow head that points along a vector, the first `beyond` `tip`."""
    along = along / float(np.hypot(*along))
    across = np.array([-along[1], along[0]]) * half_width
    base = tip - along * length
    return tip + along * beyond, base + across, base - across
