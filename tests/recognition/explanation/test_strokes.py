"""Strokes: a movement in words."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition import Language
from app.recognition.explanation.strokes import Piece, transcribe, transcribe_gesture
from app.recognition.explanation.transcript import (
    describe_strokes,
)
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from tests.recognition.strategies import Shape

TABLE = Language.load("languages/osg-table-2.json")

RATE = 30


def draw(*corners: tuple[float, float], seconds: float = 0.8) -> FloatArray:
    """Draw straight strokes from corner to corner, each as people reach: minimum jerk."""
    share = np.linspace(0, 1, round(seconds * RATE))
    reach = (10 * share**3 - 15 * share**4 + 6 * share**5)[:, None]
    sides = itertools.pairwise(corners)
    return np.concatenate([np.array(a) + reach * (np.array(b) - np.array(a)) for a, b in sides])


def even(start: tuple[float, float], end: tuple[float, float]) -> FloatArray:
    """Draw a straight stroke at the speed of a turn, without stops."""
    return np.linspace(start, end, 30)


def turn(degrees: float, *, turns: float = 1.0, radius: float = 0.5) -> FloatArray:
    """Draw a circle, positive turns clockwise, from a direction of its radius."""
    angle = np.radians(degrees) + np.linspace(0, turns * 2 * np.pi, round(abs(turns) * 60))
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def hand(path: FloatArray, name: str = "right_wrist") -> Trajectory:
    """Return a hand's movement."""
    count = len(path)
    moments = np.arange(count) / RATE
    return Trajectory(landmarks=(name,), xy=path[:, None] + 0.0, time=moments, unit="torso_length")


def stopping(shape: Shape, sides: int) -> Shape:
    """Return a shape of sides whose hand stops at every corner, as people draw."""

    def stopped(share: FloatArray) -> FloatArray:
        side = np.minimum(np.floor(share * sides), sides - 1)
        part = share * sides - side
        return shape((side + part**3 * (10 - 15 * part + 6 * part**2)) / sides)

    return stopped


SQUARE = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0))
TRIANGLE = ((0.0, 0.0), (-0.5, 1.0), (0.5, 1.0), (0.0, 0.0))


def say(path: FloatArray) -> str:
    """Return a path's strokes in words."""
    return describe_strokes(transcribe(hand(path)))


@pytest.mark.parametrize(
    ("path", "words"),
    [
        (draw(*SQUARE), "right, down, left, up"),
        (draw(*TRIANGLE), "down left, right, up left"),
        (draw((0, 0), (0, 1), (0.7, 0.3)), "down, up right"),
        (draw((0, 0), (1, 0), (0, 0), (1, 0)), "right, left, right"),
        (turn(-90), "clockwise loop"),
        (turn(-90, turns=-1), "anticlockwise loop"),
        (turn(180, turns=2), "2 clockwise loops"),
        (turn(180, turns=0.5), "clockwise arc right"),
        (turn(180, turns=-0.5), "anticlockwise arc right"),
        (np.concatenate([draw((-0.5, -1), (-0.5, 0)), turn(180)]), "down, clockwise loop"),
        # Without a corner or a stop: a line that becomes a loop, and a loop that is left on a line.
        (
            np.concatenate([even((-1.5, 0.5), (0, 0.5)), turn(90, turns=-1)]),
            "right, anticlockwise loop",
        ),
        (
            np.concatenate([turn(0, turns=-1), even((0.5, 0), (0.5, -1.5))]),
            "anticlockwise loop, up",
        ),
    ],
)
def test_strokes_are_named_by_direction_sense_and_turns(path: FloatArray, words: str) -> None:
    assert say(path) == words


def test_a_line_whose_ends_are_bent_by_rounded_corners_is_straight() -> None:
    share = np.linspace(0, 1, 60)
    bent = np.interp(share, [0, 0.05, 0.95, 1], [0.05, 0, 0, 0.05])
    assert say(np.stack([share, bent], axis=1)) == "right"


def test_a_curve_tells_where_it_leads_if_it_leads_anywhere() -> None:
    curve = Piece(kind="curve", hand="right_wrist", direction=45.0, turn=90.0, start=0.0, end=1.0)
    assert curve.words == "a curve down right"
    assert replace(curve, direction=None).words == "a curve"


def test_a_pause_between_two_strokes_is_told() -> None:
    rest = np.repeat([[1.0, 0.0]], RATE, axis=0)
    path = np.concatenate([draw((0, 0), (1, 0)), rest, draw((1, 0), (1, 1))])
    assert say(path) == "right, a pause, down"


@pytest.mark.parametrize(
    ("label", "words"),
    [
        ("square", "right, down, left, up"),
        ("triangle", "down left, right, up left"),
        ("wedge", "down, up right"),
        ("circle", "anticlockwise loop"),
        ("line", "left"),
    ],
)
def test_the_sample_gestures_are_what_their_clips_show(label: str, words: str) -> None:
    assert describe_strokes(transcribe_gesture(TABLE.gesture(label))) == words


def test_a_held_hand_shape_has_no_strokes() -> None:
    held = Language.load("languages/signs-of-divers.json").gestures
    assert next(transcribe_gesture(gesture) for gesture in held if gesture.is_held) == ()


corners = st.lists(
    st.tuples(st.integers(-3, 3), st.integers(-3, 3)), min_size=2, max_size=6
).filter(lambda found: all(a != b for a, b in itertools.pairwise(found)))


def paths(points: list[tuple[int, int]]) -> FloatArray:
    """Draw through some points, as large as gestures are."""
    return draw(*[(x / 4, y / 4) for x, y in points])


@given(corners)
def test_a_moving_hand_has_strokes(points: list[tuple[int, int]]) -> None:
    assert transcribe(hand(paths(points)))


@given(corners, st.floats(0.2, 5), st.floats(-3, 3))
def test_scale_and_place_change_nothing(
    points: list[tuple[int, int]], scale: float, shift: float
) -> None:
    path = paths(points)
    if scale * np.linalg.norm(np.ptp(path, axis=0)) > 0.2:
        assert say(path * scale + shift) == say(path)


@given(corners)
def test_mirroring_exchanges_left_and_right(points: list[tuple[int, int]]) -> None:
    path = paths(points)
    shown, mirrored = transcribe(hand(path)), transcribe(hand(path * (-1, 1)))
    assert [each.kind for each in shown] == [each.kind for each in mirrored]
    for one, other in zip(shown, mirrored, strict=True):
        assert one.turn == pytest.approx(-other.turn)
        if one.direction is not None and other.direction is not None:
            apart = (180 - one.direction - other.direction) % 360
            assert min(apart, 360 - apart) < 1e-6


@given(corners)
def test_reversal_reverses(points: list[tuple[int, int]]) -> None:
    path = paths(points)
    forwards, backwards = transcribe(hand(path)), transcribe(hand(path[::-1]))
    assert [each.kind for each in forwards] == [each.kind for each in backwards][::-1]


def test_small_wiggles_are_no_strokes() -> None:
    path = draw(*SQUARE)
    wiggles = 0.015 * np.sin(np.arange(len(path)) * 1.1)[:, None]
    assert say(path + wiggles) == "right, down, left, up"


def test_a_curve_differs_from_nothing_but_a_pause() -> None:
    line, curve, pause = (
        Piece(kind=kind, hand="right_wrist", direction=0.0, turn=0.0, start=0.0, end=1.0)
        for kind in ("line", "curve", "pause")
    )
    assert not curve.differs(line)
    assert curve.differs(pause)
