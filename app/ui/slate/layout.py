"""Layout of a slate: every gesture with its strokes, meaning and name, and the trigger."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from math import ceil
from typing import Final

import cv2
import numpy as np

from app.recognition import Gesture, Language
from app.recognition.explanation.strokes import transcribe_gesture
from app.recognition.explanation.transcript import describe_strokes
from app.recognition.features.trajectory_image import SIZE, PlacedHands, place_hands
from app.recognition.language.file import seal, short_code
from app.recognition.poses.landmarks import FINGERS, HAND_LANDMARKS
from app.recognition.poses.sequence import FloatArray
from app.recognition.text.wording import humanize, join_words
from app.recognition.triggers.trigger import ArmPose, Trigger
from app.ui.charts import find_chord, list_arrow_corners, list_seen_paths, measure_lengths
from app.ui.slate.primitives import Disc, Page, Part, Path, Point, Shape, Words, fit_size, wrap

A4: Final = (210.0, 297.0)
MARGIN = 12.0
"""Margin in millimetres, which every printer leaves white and a slate's frame covers."""

HEAD = 34.0
FOOT = 12.0
ANSWER_ROW = 14.0
GAP = 6.0
"""Millimetres between two gestures, a finger's nail, so that nobody reads the neighbour's name."""

MOST_COLUMNS = 8

NAME_SIZE = 6.2
MEANING_SIZE = 3.6
"""Font sizes of the largest cells: readable through a mask at an arm's length and at half of it."""

SMALLEST_NAME = 2.4
SMALLEST_MEANING = 1.9
"""Font sizes of the smallest cells; a label that is wider than its cell becomes smaller still."""

LARGEST_FIGURE = 62.0
"""Largest side of a figure in millimetres; larger ones are no clearer."""

SMALLEST_MOVE = 0.15
"""Share of the figure's extent below which a landmark is drawn as a dot: it is held still."""

ARROWS = (0.22, 0.55, 0.88)
"""Shares of a path's length with an arrow: soon after the start, midway, and near the end."""

SHIFTS = (0.0, -0.06, 0.06)
"""Shares of the length by which an arrow may move along its path to the straightest place."""

HAND: Final[tuple[tuple[Point, Point], ...]] = (
    ((0.33, 0.60), (0.14, 0.20)),
    ((0.41, 0.56), (0.26, 0.08)),
    ((0.59, 0.56), (0.71, 0.05)),
    ((0.67, 0.60), (0.83, 0.15)),
    ((0.68, 0.84), (0.99, 0.58)),
)
"""Fingers of a Vulcan salute in a unit square: little, ring, middle, index, thumb."""

PALM: Final[tuple[Point, ...]] = (
    (0.29, 0.55), (0.71, 0.55), (0.73, 0.82), (0.64, 1.0), (0.38, 1.0), (0.28, 0.82),
)  # fmt: skip


HAND_SHARE = 0.7
"""Share of a figure that held hands fill."""

FINGER_WIDTH = 0.3
"""Width of a finger in sizes of its hand, so that fingers side by side stay apart."""

PALM_OUTLINE: Final = tuple(
    HAND_LANDMARKS.index(name)
    for name in ("wrist", "thumb_cmc", *(f"{each}_mcp" for each in FINGERS))
)
"""Landmarks around the palm, the wrist first."""


def lay_out(language: Language, answers: Sequence[tuple[int, str]] = ()) -> Page:
    """Return a language as one printable page.

    Parameters
    ----------
    language
        The language.
    answers
        The robot's answers to the diver: number of blinks or nods, and meaning.

    """
    width, height = A4
    room = height - MARGIN - FOOT - (ANSWER_ROW if answers else 0.0)
    parts = [
        *_head(language),
        *_gestures(language, room),
        *_answers(answers, room),
        *_foot(language),
    ]
    return Page(language.name, width, height, tuple(parts))


def _answers(answers: Sequence[tuple[int, str]], top: float) -> Iterator[Part]:
    """Yield a row with the robot's answers, each a number of dots above its meaning."""
    if not answers:
        return
    width = A4[0] - 2 * MARGIN
    lead = "The robot blinks or nods:"
    yield Words(lead, (MARGIN, top + 4), fit_size(lead, 3.2, width), bold=True)
    column = width / len(answers)
    size = min(fit_size(words, 3.2, column - 2) for _, words in answers)
    for place, (pulses, words) in enumerate(answers):
        left = MARGIN + place * column
        for dot in range(pulses):
            yield Disc((left + 1.2 + 3.2 * dot, top + 7.5), 1.1)
        yield Words(words, (left, top + 12), size)


def _head(language: Language) -> Iterator[Part]:
    width = A4[0] - 2 * MARGIN
    code = short_code(seal(json.loads(language.to_json())))
    stamp = f"revision {language.revision}, {code}"
    room = width - 55
    yield Words(
        language.name,
        (MARGIN, MARGIN + 8),
        fit_size(language.name, 9.0, room, bold=True),
        bold=True,
    )
    yield Words(stamp, (MARGIN + width, MARGIN + 8), 3.6, grey=True, align="end")
    top = MARGIN + 12.5
    yield from _trigger(language.trigger, MARGIN, top, width)
    left = MARGIN + 19
    if (roles := _roles(language)) is not None:
        yield Words(roles, (left, top + 15), fit_size(roles, 3.6, width - 19), grey=True)
    line = top + 17.5
    yield Path(((MARGIN, line), (MARGIN + width, line)), 0.5)


def _trigger(trigger: Trigger, left: float, top: float, width: float) -> Iterator[Part]:
    """Draw the trigger that a diver holds before and after a gesture, with its name."""
    name = "Vulcan salute"
    rule = "Hold it half a second before and after every gesture: two for each one."
    if trigger.kind == "none":
        name, rule = "Without a trigger", "Rest for a second before and after every gesture."
    if trigger.kind == "gesture":
        name, rule = trigger.words, "Show them before and after every gesture, with a rest between."
    if trigger.start is None:
        if trigger.kind == "salute":
            yield from _salute(left, top, 14.0)
    else:
        yield from _arms(trigger.start, left, top, 14.0)
        name, rule = trigger.start.words, "Hold it for a second before and after every gesture."
        if trigger.stop is not None:
            yield from _arms(trigger.stop, left + width - 14, top, 14.0)
            name = f"{name}; {trigger.stop.words}"
            rule = "Hold the first for a second before a gesture, and the second after it."
    room = width - 38
    yield Words(name, (left + 19, top + 5), fit_size(name, 4.6, room, bold=True), bold=True)
    yield Words(rule, (left + 19, top + 10.5), fit_size(rule, 4.0, room))


def _arms(pose: ArmPose, left: float, top: float, size: float) -> Iterator[Part]:
    """Draw a head, a trunk and both arms as the robot sees them."""

    def at(place: Point) -> Point:
        # Two and a half torso lengths high, the shoulders a little above the middle.
        return left + size * (0.5 + place[0] / 2.6), top + size * (0.42 + place[1] / 2.6)

    yield Disc(at((0.0, -0.38)), 0.085 * size)
    shoulders = {"left": (0.33, 0.0), "right": (-0.33, 0.0)}
    trunk = (shoulders["left"], shoulders["right"], (-0.2, 1.0), (0.2, 1.0), shoulders["left"])
    yield Path(tuple(map(at, trunk)), 0.03 * size)
    for side, shoulder in shoulders.items():
        arm = (shoulder, pose.joints[f"{side}_elbow"], pose.joints[f"{side}_wrist"])
        yield Path(tuple(map(at, arm)), 0.06 * size)
        yield Disc(at(arm[-1]), 0.05 * size)


def _roles(language: Language) -> str | None:
    """Return, in words, the gestures that begin, end and cancel a message of several gestures."""
    grammar = language.grammar
    if grammar is None:
        return None
    named = {"begins": grammar.start, "ends": grammar.end, "cancels": grammar.cancel}
    words = [f"{label} {verb}" for verb, label in named.items() if label]
    return f"A message: {join_words(words)}." if words else None


def _salute(left: float, top: float, size: float) -> Iterator[Part]:
    def at(point: Point) -> Point:
        return left + size * point[0], top + size * point[1]

    yield Shape(tuple(at(point) for point in PALM))
    for finger in HAND:
        yield Path(tuple(at(point) for point in finger), 0.115 * size)


def _foot(language: Language) -> Iterator[Part]:
    width, height = A4
    text = (
        "Drawn as the robot sees the diver: show to your right what goes to the left. Begin "
        "at the dot, follow the arrows."
    )
    room = width - 2 * MARGIN
    yield Words(text, (MARGIN, height - MARGIN + 1), fit_size(text, 3.2, room), grey=True)
    hands = "R right hand   L left hand"
    held = any(gesture.is_held for gesture in language.gestures)
    if held:
        hands += "   A hand with its fingers is held still for a second."
    if any(len(gesture.held_shapes) > 1 for gesture in language.gestures):
        hands += " An arrow leads to its next shape."
    if held or any(_initial(name) in "RL" for each in language.gestures for name in each.salient):
        yield Words(hands, (MARGIN, height - MARGIN - 4), 3.2, grey=True)


def _gestures(language: Language, bottom: float) -> Iterator[Part]:
    gestures = language.gestures
    if not gestures:
        return
    width = A4[0] - 2 * MARGIN
    top = MARGIN + HEAD
    height = bottom - top
    columns = max(range(1, MOST_COLUMNS + 1), key=lambda n: _side(n, len(gestures), width, height))
    rows = ceil(len(gestures) / columns)
    cell = (width - GAP * (columns - 1)) / columns
    side = _side(columns, len(gestures), width, height)
    step = min(height / rows, side + _text_height(side) + 2 * GAP)
    for index, gesture in enumerate(gestures):
        row, column = divmod(index, columns)
        yield from _cell(gesture, MARGIN + column * (cell + GAP), top + row * step, cell, side)


def _side(columns: int, count: int, width: float, height: float) -> float:
    """Return the side of a figure on a page with that many columns."""
    cell = (width - GAP * (columns - 1)) / columns
    row = height / ceil(count / columns) - GAP
    # The text below a figure grows with it.
    return max(0.0, min(cell, row / (1 + _text_height(1.0)), LARGEST_FIGURE))


def _text_height(side: float) -> float:
    """Return the height of a name, two lines of strokes and two of meaning below a figure."""
    return 0.5 * side


def _cell(gesture: Gesture, left: float, top: float, cell: float, side: float) -> Iterator[Part]:
    scale = side / LARGEST_FIGURE
    yield from _figure(gesture, left, top, side)
    name = max(SMALLEST_NAME, NAME_SIZE * (0.35 + 0.65 * scale))
    base = top + side + 1.25 * name
    yield Words(
        gesture.label, (left, base), fit_size(gesture.label, name, cell, bold=True), bold=True
    )
    small = max(SMALLEST_MEANING, MEANING_SIZE * (0.4 + 0.6 * scale))
    for line in wrap(describe_strokes(transcribe_gesture(gesture)), small, cell, 2):
        base += 1.35 * small
        yield Words(line, (left, base), small, grey=True)
    for line in wrap(_meaning(gesture), small, cell, 2):
        base += 1.35 * small
        yield Words(line, (left, base), small)


def _meaning(gesture: Gesture) -> str:
    """Return the robot's action, or else a description of the gesture."""
    if isinstance(gesture.command, str) and gesture.command:
        return gesture.command
    if isinstance(gesture.command, dict):
        return ", ".join(f"{humanize(str(key))} {value}" for key, value in gesture.command.items())
    return gesture.description


def _figure(gesture: Gesture, left: float, top: float, side: float) -> Iterator[Part]:
    """Yield the strokes of a gesture in a square, with start dots and arrows."""
    corners = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0))
    yield Path(tuple((left + side * x, top + side * y) for x, y in corners), 0.2)
    if gesture.is_held:
        yield from _hands(place_hands(*gesture.held_shapes), left, top, side)
        return
    shown = gesture.trajectory
    paths = [] if shown is None else list_seen_paths(shown.select(gesture.salient))
    if not paths:
        yield from _outline(gesture, left, top, side)
        return
    points = np.concatenate([path for _, path in paths])
    extent = float(np.ptp(points, axis=0).max()) or 1.0
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    centre = np.array([left + side / 2, top + side / 2])
    drawn = [(name, (path - middle) * (0.72 * side / extent) + centre) for name, path in paths]
    width = 0.028 * side
    for name, path in drawn:
        still = float(np.ptp(path, axis=0).max()) < SMALLEST_MOVE * side
        if not still:
            yield Path(tuple((float(x), float(y)) for x, y in path), width)
            yield from _arrows(path, side)
        yield from _start(name, path[0], side)


def _hands(placed: PlacedHands, left: float, top: float, side: float) -> Iterator[Part]:
    """Yield held hands (palm, fingers and initial) and the arrow from one shape to the next."""
    every = np.concatenate([place for _, place in placed.hands])
    low, high = every.min(axis=0), every.max(axis=0)
    scale = HAND_SHARE * side / float((high - low).max())
    middle, centre = (low + high) / 2, np.array([left + side / 2, top + side / 2])
    if placed.arrow is not None:
        arrow = (placed.arrow - middle) * scale + centre
        shaft = (arrow[0], arrow.mean(axis=0))  # the head covers its end
        yield Path(tuple((float(x), float(y)) for x, y in shaft), 0.028 * side)
        yield _arrow_head(arrow[1], arrow[1] - arrow[0], 0.095 * side)
    for hand, place in placed.hands:
        drawn = [(float(x), float(y)) for x, y in (place - middle) * scale + centre]
        yield Shape(tuple(drawn[index] for index in PALM_OUTLINE))
        for finger in range(5):
            joints = [drawn[index] for index in range(1 + 4 * finger, 5 + 4 * finger)]
            yield Path(tuple(joints), FINGER_WIDTH * scale)
        yield from _start(hand.side, np.array(drawn[PALM_OUTLINE[0]]), side)


def _outline(gesture: Gesture, left: float, top: float, side: float) -> Iterator[Part]:
    """Yield the outline of the trajectory image, for a gesture whose movement is not known."""
    found, _ = cv2.findContours(gesture.image, cv2.RETR_LIST, cv2.CHAIN_APPROX_SIMPLE)
    for contour in found:
        points = [(left + side * x / SIZE, top + side * y / SIZE) for x, y in contour[:, 0]]
        yield Path((*points, points[0]), 0.012 * side)


def _arrows(path: FloatArray, side: float) -> Iterator[Part]:
    """Yield arrow heads along a path."""
    lengths = measure_lengths(path)
    size = 0.095 * side
    for share in ARROWS:
        tail, tip = max(
            (_chord(path, lengths, share + shift, size) for shift in SHIFTS),
            key=lambda chord: float(np.hypot(*(chord[1] - chord[0]))),
        )
        if (tip != tail).any():
            yield _arrow_head(tip, tip - tail, size)


def _arrow_head(tip: FloatArray, along: FloatArray, size: float) -> Shape:
    """Return the head of an arrow that points along a vector."""
    corners = list_arrow_corners(tip, along, size, 0.55 * size, 0.15 * size)
    return Shape(tuple((float(x), float(y)) for x, y in corners))


def _chord(
    path: FloatArray, lengths: FloatArray, share: float, size: float
) -> tuple[FloatArray, FloatArray]:
    """Return both ends of a piece of a path around a share of its length."""
    reach = 0.5 * size
    at = min(max(share * lengths[-1], reach), lengths[-1] - reach)
    return find_chord(path, lengths, at, reach)


def _start(name: str, at: FloatArray, side: float) -> Iterator[Part]:
    """Yield the start dot of a path, with the hand's initial."""
    x, y = float(at[0]), float(at[1])
    radius = 0.058 * side
    yield Disc((x, y), radius)
    yield Words(
        _initial(name),
        (x, y + 0.36 * 1.35 * radius),
        1.35 * radius,
        bold=True,
        white=True,
        align="middle",
    )


def _initial(landmark: str) -> str:
    """Return R or L for a hand, and for other landmarks their first letter."""
    return landmark[:1].upper()
