"""Vulcan salute: a score of one hand's landmarks, and the trigger that requires it to be held.

Fingers straight, index with middle and ring with little finger together, a V between the pairs. The
published rule compares three gaps between finger tips and therefore also accepts a victory sign,
two fingers held together and loosely curled hands; the score here tests the whole shape.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import pairwise
from operator import itemgetter

import numpy as np

from app.recognition.errors import PoseError
from app.recognition.poses.frame import KNUCKLES_PER_PALM, Hand
from app.recognition.poses.landmarks import FINGERS, HAND_LANDMARKS
from app.recognition.poses.sequence import FloatArray

_JOINTS = [
    [HAND_LANDMARKS.index(f"{finger}_{joint}") for joint in ("mcp", "pip", "dip", "tip")]
    for finger in FINGERS
]
"""Indices in `HAND_LANDMARKS` of each finger's knuckle, middle joint, last joint and tip."""

_JOINTS_OF_FINGERS = [itemgetter(*joints) for joints in _JOINTS]
"""Getters of each finger's four joints from a hand's points."""

_INDEX_KNUCKLE, _MIDDLE_KNUCKLE, _, _LITTLE_KNUCKLE = (joints[0] for joints in _JOINTS)


@dataclass(frozen=True)
class Condition:
    """A soft threshold: 0.5 at `middle`, 0.98 half a `width` above, 0.02 half a `width` below.

    The logistic slope is ``8 / width``, so that `width` is the uncertain range.
    """

    middle: float
    width: float

    def excess(self, value: float) -> float:
        """Return how far `value` is above the threshold, the input of `score_condition`."""
        return 8 * (value - self.middle) / self.width


def score_condition(excess: float) -> float:
    """Return the logistic share in [0, 1] of a `Condition.excess`."""
    # In this order NaN, from coordinates too large to compute with, becomes the lower bound.
    return 1 / (1 + math.exp(-min(max(-50.0, excess), 50.0)))


# All thresholds: chosen on rendered hands with known pose, checked on photographs and drawings
# (`benchmarks/accuracy/pictures.py`). Lengths are in palms, wrist to middle knuckle.
STRAIGHT = Condition(0.87, 0.2)
"""Distance knuckle to tip over the finger's length along its joints; 1 is straight."""

LONG = Condition(0.42, 0.32)
"""Distance knuckle to tip of index, middle and ring finger; curled fingers are short."""

LONG_LITTLE_FINGER = Condition(0.30, 0.28)
"""The same of the little finger, which is a quarter shorter."""

STRETCHED_OUT = Condition(0.18, 0.32)
"""How much farther than its middle joint the tip is from the wrist."""

SPREAD = Condition(10.0, 12.0)
"""Degrees between middle and ring finger: the V."""

SPREAD_EXCESS = Condition(0.0, 12.0)
"""Degrees by which the V is wider than `PAIR_MARGIN` times the wider gap inside the pairs."""

PAIR_MARGIN = 1.1
"""How many times the V must exceed the angle inside a pair; the fingers of a pair need not touch,
but a fan of evenly spread fingers is an open hand."""

TIP_GAP_RATIO = Condition(1.1, 0.6)
"""Gap between the tips of middle and ring finger over the wider gap inside the pairs."""

PALM_WIDTH = Condition(0.38, 0.4)
"""Index to little finger knuckle: seen edge-on, angles are unreliable."""

# The same for hands whose fingertips the hand model bends; stricter, since fewer are tested.
NEARLY_STRAIGHT = Condition(0.75, 0.2)
"""Index and middle finger, as in `STRAIGHT`."""

NOT_CURLED = Condition(-0.03, 0.2)
"""Tips of index and middle finger against their middle joints, as in `STRETCHED_OUT`."""

WIDE_SPREAD = Condition(20.0, 4.0)
"""Degrees of the V: far beyond an open hand's 12."""

WIDEST_SPREAD = 40.0
"""Largest degrees of the V: people's is narrower; a folded ring finger can exceed it."""

WIDE_TIP_GAP_RATIO = Condition(1.4, 0.2)
"""Tip gaps as in `TIP_GAP_RATIO`."""

CLOSE_INDEX_PAIR, CLOSE_LITTLE_PAIR = 9.0, 22.0
"""Largest degrees inside the pairs; a bent finger's direction is less certain."""

VISIBLE_RING, VISIBLE_LITTLE = Condition(0.27, 0.06), Condition(0.17, 0.06)
"""Distance knuckle to tip, of which a folded finger shows almost nothing."""

NOT_FOLDED = Condition(-0.25, 0.08)
"""Tips of ring and little finger against their middle joints; a folded finger's tip is 0.3 and
more nearer to the wrist."""

SMALL_ENOUGH = Condition(0.0, 4.0)
"""Degrees by which an angle stays below its limit."""

ENTER_SCORE = 0.5
"""Score from which a salute begins, the threshold of the test itself."""

LEAVE_SCORE = 0.3
"""Score down to which a salute continues: a trembling hand still salutes, a closed or open hand
scores below 0.1."""

FEW_HANDS = 0.25
"""Share of frames with a hand below which fingers cannot be told: a salute is held for half a
second, and a hand found in every fourth frame is not seen to hold anything."""

HOLD_SECONDS = 0.3
"""Seconds that a salute must be held: longer than a hand has the shape in passing. In seconds,
since the published code's 30 frames on the desk and 5 on the robot are different times."""

DROPOUT_SECONDS = 0.5
"""Seconds without salute after which it is over. Under water the hand detector loses a still hand
for up to half a second, which is too short for a gesture."""

SHORTEST_TAKE = 0.8
"""Least seconds between two salutes. A reach, a stroke and a reach back take 0.5 s each (Flash and
Hogan 1985); a shorter pause is one salute that was lost for a while."""

REACHES = 1.5
"""Seconds of a reach, a stroke and a reach back: what a take between two salutes lasts at least."""

LONGEST_TAKE = 60.0
"""Most seconds of a take. A gesture takes a few; after a minute the stop salute was forgotten, and
the next salute begins a new take."""


def salute_score(hand_xy: FloatArray) -> float:
    """Return how much one hand looks like a Vulcan salute.

    The least fulfilled of eight conditions: four straight, long, stretched-out fingers, the V
    between middle and ring finger, wide in degrees and against the pairs, and a palm not seen
    edge-on. The hand model often bends the tips of short fingers, ring and little finger most;
    such hands salute if the V is wide, the pairs are close and no finger is folded.
    Translating, turning, mirroring (left or right hand) and uniformly scaling the hand leave the
    score as it is.

    Parameters
    ----------
    hand_xy
        ``(21, 2)`` pixels, in the order of `HAND_LANDMARKS`. NaN: not seen.

    Returns
    -------
    In [0, 1]; above 0.5 is a salute. 0 where a landmark is not seen.

    Raises
    ------
    PoseError
        When `hand_xy` has another shape.

    """
    points = [complex(x, y) for x, y in _check_shape(hand_xy).tolist()]
    if not all(map(cmath.isfinite, points)):
        return 0.0
    try:
        shape = _HandShape.of(points)
    except OverflowError:  # distances too large for a float
        return 0.0
    # The score grows with the excess, so the least excess is of the least fulfilled condition.
    return score_condition(max(_clear_salute(shape), _wide_salute(shape)))


@dataclass(frozen=True, eq=False)
class _HandShape:
    """Measures of a hand, of index, middle, ring and little finger in this order.

    ``straight`` (4) shares; ``length`` (4) and ``stretch`` (4) palms; ``index_pair``, ``spread``
    and ``little_pair`` degrees from a finger to the next, away from the thumb; ``gap_ratio`` the
    gap between the tips of the pairs over the wider one inside them; ``width`` palms across the
    knuckles.
    """

    straight: list[float]
    length: list[float]
    stretch: list[float]
    index_pair: float
    spread: float
    little_pair: float
    gap_ratio: float
    width: float

    @classmethod
    def of(cls, points: list[complex]) -> _HandShape:
        """Measure a hand of 21 points ``x + iy`` in pixels."""
        # Plain numbers: numpy takes several times as long for so few.
        wrist = points[0]
        axis = points[_MIDDLE_KNUCKLE] - wrist
        across = points[_INDEX_KNUCKLE] - points[_LITTLE_KNUCKLE]
        palm = max(abs(axis), KNUCKLES_PER_PALM * abs(across), 1e-9)
        upright = axis.conjugate() / palm
        # Angles count away from the thumb, on a left hand as on a right one.
        sense = 1 if (across * upright).imag > 0 else -1
        straight, length, stretch, angle, tips = [], [], [], [], []
        for joints_of in _JOINTS_OF_FINGERS:
            knuckle, middle, last, tip = joints_of(points)
            finger = tip - knuckle
            bones = abs(middle - knuckle) + abs(last - middle) + abs(tip - last)
            straight.append(abs(finger) / max(bones, 1e-9))
            length.append(abs(finger) / palm)
            stretch.append((abs(tip - wrist) - abs(middle - wrist)) / palm)
            angle.append(sense * math.degrees(cmath.phase(finger * upright)))
            tips.append(tip)
        index_gap, gap, little_gap = (abs(there - here) for here, there in pairwise(tips))
        return cls(
            straight=straight,
            length=length,
            stretch=stretch,
            index_pair=angle[0] - angle[1],
            spread=angle[1] - angle[2],
            little_pair=angle[2] - angle[3],
            gap_ratio=gap / max(index_gap, little_gap, 1e-6 * palm),
            width=abs(across) / palm,
        )


def _clear_salute(shape: _HandShape) -> float:
    """Return the least excess of the conditions of a salute with straight fingers."""
    wider_pair = max(abs(shape.index_pair), abs(shape.little_pair))
    return min(
        STRAIGHT.excess(min(shape.straight)),
        LONG.excess(min(shape.length[:3])),
        LONG_LITTLE_FINGER.excess(shape.length[3]),
        STRETCHED_OUT.excess(min(shape.stretch)),
        SPREAD.excess(shape.spread),
        SPREAD_EXCESS.excess(shape.spread - PAIR_MARGIN * wider_pair),
        TIP_GAP_RATIO.excess(shape.gap_ratio),
        PALM_WIDTH.excess(shape.width),
    )


def _wide_salute(shape: _HandShape) -> float:
    """Return the least excess of the conditions of a wide salute with bent fingertips."""
    return min(
        NEARLY_STRAIGHT.excess(min(shape.straight[:2])),
        LONG.excess(min(shape.length[:2])),
        NOT_CURLED.excess(min(shape.stretch[:2])),
        VISIBLE_RING.excess(shape.length[2]),
        VISIBLE_LITTLE.excess(shape.length[3]),
        NOT_FOLDED.excess(min(shape.stretch[2:])),
        WIDE_SPREAD.excess(shape.spread),
        SMALL_ENOUGH.excess(WIDEST_SPREAD - shape.spread),
        SMALL_ENOUGH.excess(CLOSE_INDEX_PAIR - abs(shape.index_pair)),
        SMALL_ENOUGH.excess(CLOSE_LITTLE_PAIR - abs(shape.little_pair)),
        WIDE_TIP_GAP_RATIO.excess(shape.gap_ratio),
        PALM_WIDTH.excess(shape.width),
    )


def best_salute(hands: Iterable[Hand]) -> float:
    """Return the score of the hand that salutes most, left or right; 0 without a hand."""
    return max(map(_score_hand, hands), default=0.0)


@lru_cache(maxsize=32)
def _score_hand(hand: Hand) -> float:
    # Kept for the hands of the last frames: the choice of the person and the trigger ask for it.
    return salute_score(hand.xy)


@dataclass
class HeldTrigger:
    """Detects from the scores of a stream whether the trigger, a salute by default, is held.

    The time between neighbouring frames that both show the salute is summed, so a detection in a
    single frame adds nothing at any frame rate. One such step adds at most half of `hold`: a
    salute needs at least three frames, also where a camera stalls. A step of `REACHES` may hide
    a take: a salute before it and one after it are two.

    Attributes
    ----------
    hold
        Seconds of salute until it counts; `DROPOUT_SECONDS` without end it.
    leave
        Score down to which it continues, begun at `ENTER_SCORE`.
    held
        Whether a salute counts now.
    since, until
        Seconds: first and last moment of the salute that builds up, is held or was just released;
        None before any.

    """

    hold: float = HOLD_SECONDS
    leave: float = LEAVE_SCORE
    held: bool = field(default=False, init=False)
    since: float | None = field(default=None, init=False)
    until: float | None = field(default=None, init=False)
    _collected: float = field(default=0.0, init=False)
    _previous: tuple[float, float] | None = field(default=None, init=False)

    def update(self, time: float, score: float) -> bool:
        """Process the next frame's score.

        Parameters
        ----------
        time
            Seconds, later than in every call before.
        score
            See `salute_score`.

        Returns
        -------
        Whether a salute is held now.

        """
        active = self._collected > 0
        previous, self._previous = self._previous, (time, score)
        if previous is not None:
            before, score_before = previous
            seen = time - before < REACHES
            if seen and min(score_before, score) >= (self.leave if active else ENTER_SCORE):
                if not active:
                    self.since = before
                self._collected += min(time - before, self.hold / 2)
                self.until = time
        if self.until is not None and time - self.until > DROPOUT_SECONDS:
            self.held, self._collected = False, 0.0
        # The tolerance is for a sum of floats that misses `hold` by the last bit.
        elif self._collected >= self.hold - 1e-9:
            self.held = True
        return self.held


def _check_shape(hand_xy: FloatArray) -> FloatArray:
    points = np.asarray(hand_xy, dtype=np.float64)
    if points.shape != (len(HAND_LANDMARKS), 2):
        raise PoseError(f"a hand has shape {points.shape}, expected (21, 2): x and y of 21 points")
    return points


def find_held(
    time: FloatArray, scores: FloatArray, seconds: float = HOLD_SECONDS
) -> tuple[tuple[float, float], ...]:
    """Return start and end, in seconds, of every trigger that is held for long enough.

    Parameters
    ----------
    time, scores
        ``(T,)`` seconds and scores of the frames.
    seconds
        How long a trigger is held at least.

    """
    steps = np.flatnonzero(np.diff(np.concatenate([[False], scores >= ENTER_SCORE, [False]])))
    ranges = [(float(time[a]), float(time[b - 1])) for a, b in steps.reshape(-1, 2)]
    return tuple((start, end) for start, end in ranges if end - start >= seconds)
