"""Trajectory images: gestures as white strokes or lines on black, 224 x 224.

`draw` shows a gesture's salient paths as strokes, of which `StrokeMoments` are the moments.
`draw_hands` shows held hands as lines in their place; where two shapes are held one after the
other, an arrow leads from the first to the second.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import cv2
import numpy as np
import numpy.typing as npt

from app.recognition.features.contour import BinaryImage, Contour
from app.recognition.poses.frame import HandShape
from app.recognition.poses.landmarks import FINGERS, HAND_LANDMARKS
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory

SIZE = 224
"""Width and height in pixels: the published implementation's, so that its files can be read."""

MARGIN = 16
"""Border in pixels around the paths: room for half a stroke, and a visible frame."""

STROKE_WIDTH = 9
"""Width of a stroke in pixels: a twentieth of the drawing, as much as a free hand wobbles, so that
two drawings of one figure overlap. Wider strokes would close small loops."""

SIMPLIFICATION = 4.0
"""Tolerance of Ramer-Douglas-Peucker in pixels: just below half a stroke, so that visible corners
are kept and jitter within the stroke is removed."""

MIN_EXTENT = 0.1
"""Least extent, in the trajectory's unit, that is drawn.

Drawings are scaled to fill the image: 5 cm of a diver's sway would look like a gesture.
"""

_SUBPIXEL_BITS = 4


@dataclass(frozen=True, eq=False)
class Drawing:
    """The drawing of a gesture: the paths of its salient landmarks, and their image.

    Attributes
    ----------
    image
        The ``(224, 224)`` trajectory image; all zero when nothing moved.
    trajectory
        The salient landmarks' trajectory, or None for a gesture of which only the image is
        known (imported from the published implementation's files).

    """

    image: BinaryImage
    trajectory: Trajectory | None = None

    @cached_property
    def strokes(self) -> BinaryImage:
        """The image cropped to its strokes; ``(0, 0)`` without strokes."""
        left, top, width, height = cv2.boundingRect(self.image)
        return self.image[top : top + height, left : left + width]

    @cached_property
    def contour(self) -> Contour:
        """The outer contours of the strokes, computed once for all voters."""
        return Contour.of(self.strokes)

    @cached_property
    def moments(self) -> StrokeMoments:
        """The image moments of the strokes, computed once for all voters."""
        return StrokeMoments.of(self.strokes)

    @property
    def empty(self) -> bool:
        """Whether the image has no stroke."""
        return self.strokes.size == 0


def is_drawable(trajectory: Trajectory) -> bool:
    """Return whether `draw` draws a stroke: something is seen, and moves by `MIN_EXTENT`."""
    seen = trajectory.xy[np.isfinite(trajectory.xy).all(axis=2)]
    return len(seen) > 0 and float(np.ptp(seen, axis=0).max()) >= MIN_EXTENT


def draw(trajectory: Trajectory, simplification: float = SIMPLIFICATION) -> Drawing:
    """Draw the paths of a trajectory's landmarks into one image.

    References and queries are drawn alike: all landmarks share one scale, which fills the image
    and keeps the aspect; each stretch of a path without gaps is simplified by
    Ramer-Douglas-Peucker (Ramer 1972, Douglas and Peucker 1973) and drawn as one stroke.

    Parameters
    ----------
    trajectory
        Of the salient landmarks only.
    simplification
        Tolerance of Ramer-Douglas-Peucker in pixels.

    Returns
    -------
    The drawing; its image is empty where nothing is seen or the whole extent of the paths is
    below `MIN_EXTENT`.

    """
    image: BinaryImage = np.zeros((SIZE, SIZE), dtype=np.uint8)
    finite = np.isfinite(trajectory.xy)
    whole = bool(finite.all())
    known = np.asarray(finite.all(axis=2))
    seen = trajectory.xy.reshape(-1, 2) if whole else trajectory.xy[known]
    if not len(seen):
        return Drawing(image, trajectory)
    low, high = np.minimum.reduce(seen), np.maximum.reduce(seen)
    extent = float((high - low).max())
    if extent < MIN_EXTENT:
        return Drawing(image, trajectory)
    scale = (SIZE - 1 - 2 * MARGIN) / extent
    pixels = (trajectory.xy - (low + high) / 2) * scale + (SIZE - 1) / 2
    for index in range(len(trajectory.landmarks)):
        path = pixels[:, index]
        for stroke in [path] if whole else _strokes(path, known[:, index]):
            _draw_stroke(image, simplify(stroke, simplification))
    return Drawing(image, trajectory)


def _strokes(path: FloatArray, known: npt.NDArray[np.bool_]) -> list[FloatArray]:
    """Split a path ``(T, 2)`` into stretches without gaps, by where it is known, ``(T,)``."""
    ends = np.flatnonzero(np.diff(known, prepend=False, append=False))
    return [path[start:end] for start, end in ends.reshape(-1, 2)]


def _draw_stroke(image: BinaryImage, corners: FloatArray) -> None:
    grid = np.rint(corners * 2**_SUBPIXEL_BITS).astype(np.int32)[:, None]
    cv2.polylines(
        image, [grid], isClosed=False, color=255, thickness=STROKE_WIDTH, shift=_SUBPIXEL_BITS
    )


def simplify(path: FloatArray, tolerance: float) -> FloatArray:
    """Simplify a path to its corners (Ramer 1972, Douglas and Peucker 1973).

    OpenCV's `approxPolyDP` is not used: it loses the last side of an open path that ends near its
    start.

    Parameters
    ----------
    path
        ``(T, 2)`` without NaN.
    tolerance
        Largest distance of a removed point from the line that replaces it, in the path's unit.

    Returns
    -------
    ``(C, 2)``: the first point, the corners in order, the last point.

    """
    kept = [0, len(path) - 1]
    open_stretches = [(0, len(path) - 1)]
    # Most stretches have a dozen points: plain numbers are faster than arrays.
    points = path.tolist()
    while open_stretches:
        first, last = open_stretches.pop()
        corner, away = _farthest_from_line(points, first, last)
        if away > tolerance:
            kept.append(corner)
            open_stretches += [(first, corner), (corner, last)]
    return path[sorted({*kept})]


def _farthest_from_line(points: list[list[float]], first: int, last: int) -> tuple[int, float]:
    """Return the point between two that is farthest from the segment joining them, and how far.

    Of equally far points the first; without points between, `first` and 0.
    """
    (start_x, start_y), (end_x, end_y) = points[first], points[last]
    along_x, along_y = end_x - start_x, end_y - start_y
    # Most time goes into this loop, so constants are moved out of it: the products are not taken
    # from the segment's start, and all squares keep the common factor.
    length = along_x * along_x + along_y * along_y or 1.0
    passed_start = start_x * along_x + start_y * along_y
    passed_end = end_x * along_x + end_y * along_y
    beside_start = start_x * along_y - start_y * along_x
    farthest, largest, index = first, 0.0, first
    for x, y in points[first + 1 : last]:
        index += 1
        passed = x * along_x + y * along_y
        if passed_start < passed < passed_end:
            area = x * along_y - y * along_x - beside_start
            square = area * area
        else:
            # Before its start or beyond its end, the segment's nearest point is that end.
            if passed <= passed_start:
                x -= start_x
                y -= start_y
            else:
                x -= end_x
                y -= end_y
            square = (x * x + y * y) * length
        if square > largest:
            farthest, largest = index, square
    return farthest, math.sqrt(largest / length)


HIGHEST_POWER = 8
"""Highest power of x and of y, the highest degree that a voter needs."""


@dataclass(frozen=True, eq=False)
class StrokeMoments:
    """Moments of the pixels of strokes about their centroid.

    Attributes
    ----------
    count
        Number of pixels.
    radius
        Distance in pixels of the farthest of them from the centroid, at least 1.
    means
        ``(HIGHEST_POWER + 1, HIGHEST_POWER + 1)``: the mean of ``x^p y^q``, x to the right and y
        down from the centroid, in units of `radius`.

    """

    count: int
    radius: float
    means: FloatArray

    @classmethod
    def of(cls, image: npt.NDArray[np.uint8]) -> StrokeMoments:
        """Measure an image ``(height, width)``, whose strokes are not 0.

        The cost grows with the area of the image, so crop it to the strokes first.
        """
        height, width = image.shape
        # A column of background on the right ends every run within its row.
        pixels = np.zeros(1 + height * (width + 1), dtype=np.uint8)
        pixels[1:].reshape(height, width + 1)[:, :width] = image
        changes = (pixels[1:] != pixels[:-1]).nonzero()[0]
        begins, ends = changes[::2], changes[1::2]
        row = begins // (width + 1)
        first_of_row = row * (width + 1)
        start, stop = begins - first_of_row, ends - first_of_row
        lengths = stop - start
        count = int(lengths.sum())
        centre_x = float(lengths @ (start + stop - 1)) / (2 * count)
        centre_y = float(lengths @ row) / count
        across, down = np.maximum(centre_x - start, stop - 1 - centre_x), row - centre_y
        radius = max(1.0, float((across * across + down * down).max()) ** 0.5)
        x, y = (np.arange(width) - centre_x) / radius, (np.arange(height) - centre_y) / radius
        powers = _powers(np.concatenate([x, y]))
        sums = np.zeros((HIGHEST_POWER + 1, width + 1))
        np.cumsum(powers[:, :width], axis=1, out=sums[:, 1:])
        of_runs = sums.take(stop, axis=1) - sums.take(start, axis=1)
        return cls(count, radius, of_runs @ powers.take(width + row, axis=1).T / count)

    def central(self, p: int, q: int) -> float:
        """Return Hu's normalised central moment, ``mu_pq / mu_00^(1 + (p + q) / 2)``."""
        return float(self.means[p, q] * (self.radius / self.count**0.5) ** (p + q))


def _powers(values: FloatArray) -> FloatArray:
    """Return the powers 0 to `HIGHEST_POWER` of ``(N,)`` values, one a row."""
    powers = np.ones((HIGHEST_POWER + 1, len(values)))
    for exponent in range(1, HIGHEST_POWER + 1):
        np.multiply(powers[exponent - 1], values, out=powers[exponent])
    return powers


BONE_WIDTH = STROKE_WIDTH // 2 + 1
"""Width of a bone in pixels: half of a path's, so that fingers side by side stay apart."""

APART = 3.0
"""Distance between the middles of two hands drawn side by side, in sizes of a hand."""

ARROW_SPACE = 1.8
"""Space between two shapes in sequence, in sizes of a hand: enough for an arrow that is visible on
a card of 64 pixels."""

ARROW_SHARES = (0.15, 0.85)
"""Places of the arrow's tail and tip in that space."""

FINGER_BONES = tuple(
    bone for finger in range(5) for bone in pairwise((0, *range(1 + 4 * finger, 5 + 4 * finger)))
)
"""Pairs of indices in `HAND_LANDMARKS`: from the wrist along each finger."""

KNUCKLE_BONES = tuple(
    (HAND_LANDMARKS.index(f"{one}_mcp"), HAND_LANDMARKS.index(f"{other}_mcp"))
    for one, other in pairwise(FINGERS)
)
"""The line across the palm."""


@dataclass(frozen=True, eq=False)
class PlacedHands:
    """The held hands of a gesture as they are drawn.

    Attributes
    ----------
    hands
        ``(hand, xy)`` of each hand and its ``(21, 2)`` places, in sizes of a hand, y down.
    arrow
        ``(2, 2)``: tail and tip of the arrow from the first shape to the second; None for one.

    """

    hands: tuple[tuple[HandShape, FloatArray], ...]
    arrow: FloatArray | None


def place_hands(hands: Sequence[HandShape], then_hands: Sequence[HandShape] = ()) -> PlacedHands:
    """Place the hands of one shape, or of two in sequence, for a drawing.

    Of two hands the person's right one is on the left. The second shape is beside the first, of
    two hands below it.
    """
    first, second = (
        [
            (hand, hand.xy + (APART * index, 0.0))
            for index, hand in enumerate(sorted(shape, key=lambda hand: hand.side == "left"))
        ]
        for shape in (hands, then_hands)
    )
    if not second:
        return PlacedHands(tuple(first), None)
    one, other = (np.concatenate([place for _, place in part]) for part in (first, second))
    along = np.array((1.0, 0.0) if len(hands) == 1 else (0.0, 1.0))
    end = float((one @ along).max())
    step = (end + ARROW_SPACE - float((other @ along).min())) * along
    across = (1 - along) * (one.min(axis=0) + one.max(axis=0)) / 2
    arrow = np.array([across + (end + ARROW_SPACE * share) * along for share in ARROW_SHARES])
    return PlacedHands((*first, *((hand, place + step) for hand, place in second)), arrow)


def draw_hands(hands: Sequence[HandShape], then_hands: Sequence[HandShape] = ()) -> BinaryImage:
    """Draw the fingers' bones of the hands that hold one shape, or two in sequence.

    Parameters as for `place_hands`; an arrow leads from the first shape to the second.

    Returns
    -------
    ``(224, 224)``: 255 on black, as large as the margin allows; black without hands.

    """
    image: BinaryImage = np.zeros((SIZE, SIZE), dtype=np.uint8)
    if not hands:
        return image
    placed = place_hands(hands, then_hands)
    places = np.concatenate([place for _, place in placed.hands])
    low, high = places.min(axis=0), places.max(axis=0)
    scale = (SIZE - 1 - 2 * MARGIN) / float((high - low).max())

    def locate(points: FloatArray) -> list[list[int]]:
        pixels = (points - (low + high) / 2) * scale + (SIZE - 1) / 2
        found: list[list[int]] = np.rint(pixels).astype(int).tolist()
        return found

    for _, place in placed.hands:
        own = locate(place)
        for start, end in (*FINGER_BONES, *KNUCKLE_BONES):
            cv2.line(image, own[start], own[end], color=255, thickness=BONE_WIDTH)
    if placed.arrow is not None:
        tail, tip = locate(placed.arrow)
        cv2.arrowedLine(image, tail, tip, color=255, thickness=BONE_WIDTH, tipLength=0.5)
    return image
