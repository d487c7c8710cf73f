"""Hand differences: how a hand differs from the expected shape, finger by finger.

Each is tested by undoing it, as in `undoing`: the finger is replaced by that of the
demonstration, or the hand turned back, and the voters compare again.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from app.recognition.decision.hand_references import OTHER_SHAPE, HeldShapes, measure_shapes
from app.recognition.poses.frame import HandShape
from app.recognition.poses.landmarks import HAND_LANDMARKS
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.hand_voters import FingerDirections, HandLandmarks

FINGERS = ("thumb", "index finger", "middle finger", "ring finger", "little finger")

MOST_BENT = 200.0
"""Degrees of a finger's three joints together in a fist, where its tip is farthest back."""

CLEARLY_BENT = 30.0
"""Least difference of a finger's bend in degrees: the landmarks' errors make up to 20."""

CLEARLY_TURNED = 35.0
"""Least turn of the hand in degrees that is reported; the voters tolerate 30."""

ROUNDED = 10
"""Degrees to which a bend or a turn is rounded: as precisely as the image shows it."""

LEAST_SHARE = 0.1
"""Least share of the distance that undoing a difference removes."""

FINGER_LENGTHS = (0.94, 1.04, 0.98, 0.77)
"""Stretched fingers in palms, index to little finger (Buryanov and Kotiuk 2010)."""

BONE_SHARES = np.array([0.48, 0.29, 0.23])
"""Shares of a finger's length, from the knuckle on (Buryanov and Kotiuk 2010)."""

_LOCAL = (HandLandmarks(), FingerDirections())
"""Hand voters to which each finger adds its own share: distances of tips depend on two fingers."""

_WRIST, _MIDDLE = HAND_LANDMARKS.index("wrist"), HAND_LANDMARKS.index("middle_finger_mcp")


ORDINALS = ("first", "second")


class HandDifference(NamedTuple):
    """One way in which a hand differs from the expected shape.

    Attributes
    ----------
    share
        In [0, 1]: part of the distance between the shapes that undoing it removes; 0 where no hand
        can be compared.
    words
        The difference as a clause.

    """

    share: float
    words: str


def find_held_difference(
    label: str, shapes: HeldShapes, shown: HeldShapes
) -> HandDifference | None:
    """Find in what a query's held hands differ most from a gesture's.

    Parameters
    ----------
    label
        The gesture's.
    shapes
        The query's shapes: one, or two in sequence; if there is none, that is the difference.
    shown
        The gesture's, one or two.

    Returns
    -------
    For two sequences, the order of the shapes, where the opposite order fits; otherwise a finger of
    one of the shapes, or the turn of the hand. The farther shape decides, so that the shares of the
    other one are reduced in proportion to its distance. None where nothing differs.

    """
    if not shapes:
        words = f"no hand holds a shape in this take, and {label!r} is one"
        if len(shown) > 1:
            words = f"no hand holds two shapes in this take, and {label!r} is two in sequence"
        return HandDifference(1.0, words)
    if len(shapes) != len(shown):
        return HandDifference(1.0, _describe_number(label, shapes, shown))
    pairs, whole = _pair_parts(shapes, shown)
    swapped = _pair_parts(shapes[::-1], shown)[1]
    if len(pairs) > 1 and swapped <= OTHER_SHAPE < whole:
        words = f"the shapes come in the other order than in {label!r}"
        return HandDifference(_share(whole, swapped), words)
    found = []
    for ordinal, (query, example) in zip(ORDINALS, pairs, strict=False):
        where = f"in the {ordinal} shape " if len(pairs) > 1 else ""
        if apart := measure_distance(query, example):
            found += [
                HandDifference(share * apart / whole, where + words)
                for differences in (_fingers(query, example, label), _turn(query, example))
                for share, words in differences
            ]
    return _find_largest(found)


def _describe_number(label: str, shapes: HeldShapes, shown: HeldShapes) -> str:
    """Return in words that a take holds one shape where a gesture has two, or the reverse."""
    if len(shapes) > len(shown):
        return f"two hand shapes are held one after the other in this take, and {label!r} is one"
    apart = [_pair_parts(shapes, [hands])[1] for hands in shown]
    if min(apart) > OTHER_SHAPE:
        return f"one hand shape is held in this take, and {label!r} is two in sequence"
    missing = ORDINALS[1 - int(np.argmin(apart))]
    return f"the {missing} shape is missing: {label!r} is two in sequence"


def _pair_parts(
    shapes: HeldShapes, shown: HeldShapes
) -> tuple[list[tuple[HandShape, HandShape]], float]:
    """Pair a hand of a query, as seen or mirrored, with one of a gesture, the same in all parts.

    Returns the pairs ``(query, example)`` that are nearest, and the distance of the farther one.
    """
    choices = [
        [
            (hands[hand].mirror() if mirrored else hands[hand], examples[example])
            for hands, examples in zip(shapes, shown, strict=True)
        ]
        for example in range(len(shown[0]))
        for hand in range(len(shapes[0]))
        for mirrored in (False, True)
    ]
    distances = [max(measure_distance(*pair) for pair in pairs) for pairs in choices]
    nearest = int(np.argmin(distances))
    return choices[nearest], distances[nearest]


def find_moving_hand_difference(
    label: str, hands: Sequence[HandShape], shown: Sequence[HandShape]
) -> HandDifference | None:
    """Find how a moving hand of a query differs most from a gesture's whose shape counts.

    Parameters
    ----------
    label
        The gesture's.
    hands
        The query's moving hands.
    shown
        The gesture's, at least one.

    Returns
    -------
    A finger of the hand that differs more; None where the shapes are not clearly different. Of
    share 0 where no hand can be compared.

    """
    seen = {hand.side: hand for hand in hands}
    known = {hand.side: hand for hand in shown}
    apart = {side: measure_shapes(seen, {side: hand}) for side, hand in known.items()}
    worst = max((side for side in apart if side in seen), key=apart.__getitem__, default=None)
    if worst is None:
        words = "no hand is seen for long enough that keeps a shape: no shape is compared"
        return HandDifference(0.0, words)
    if apart[worst] <= OTHER_SHAPE:
        return None
    example = known[worst]
    either = [_turn_to(hand, example) for hand in (seen[worst], seen[worst].mirror())]
    query = min(either, key=lambda hand: measure_distance(hand, example))
    return _find_largest([*_fingers(query, example, label)])


def _turn_to(hand: HandShape, example: HandShape) -> HandShape:
    """Return a hand turned in the image to where it fits another one best."""
    one, other = (each.xy[:, 0] + 1j * each.xy[:, 1] for each in (hand, example))
    return hand.turn(float(np.degrees(np.angle(one.conj() @ other))))


def _find_largest(found: Sequence[HandDifference]) -> HandDifference | None:
    """Return the difference of the largest share, if any is large enough."""
    first = max(found, key=lambda each: each.share, default=None)
    return None if first is None or first.share < LEAST_SHARE else first


def measure_distance(one: HandShape, other: HandShape) -> float:
    """Return the mean distance of the voters in `_LOCAL`, each over its between-class distance."""
    apart = [
        voter.distances(voter.describe(one), voter.describe(other)[None])[0] / voter.between
        for voter in _LOCAL
    ]
    return float(np.mean(apart))


def measure_bends(hand: HandShape) -> FloatArray:
    """Estimate the bend of index to little finger in degrees, the three joints together.

    The bend follows from how far each tip is beyond its knuckle along the palm, in palms, which is
    the same for fingers bent towards the camera and in the image. Returns ``(4,)``, 0 for a
    stretched finger.
    """
    axis = hand.xy[_MIDDLE] - hand.xy[_WRIST]
    bends = np.linspace(0.0, MOST_BENT, 41)
    # A third of the bend at each joint.
    reach = np.cos(np.radians(bends)[:, None] * np.array([1, 2, 3]) / 3) @ BONE_SHARES
    fingers = 4 * np.arange(1, 5)
    shares = (
        (hand.xy[4 + fingers] - hand.xy[1 + fingers])
        @ axis
        / np.maximum(np.array(FINGER_LENGTHS) * (axis @ axis), 1e-9)
    )
    return np.asarray(np.interp(-shares, -reach, bends), dtype=np.float64)


def _fingers(query: HandShape, example: HandShape, label: str) -> Iterator[HandDifference]:
    """Yield how every finger differs."""
    whole = measure_distance(query, example)
    more = measure_bends(query) - measure_bends(example)
    for finger, name in enumerate(FINGERS):
        inner, joints = 1 + 4 * finger, slice(2 + 4 * finger, 5 + 4 * finger)
        undone = query.xy.copy()
        undone[joints] = undone[inner] + example.xy[joints] - example.xy[inner]
        share = _share(whole, measure_distance(HandShape(query.side, undone), example))
        words = f"the {name} points otherwise than in {label!r}"
        if finger and abs(more[finger - 1]) >= CLEARLY_BENT:
            word = "more" if more[finger - 1] > 0 else "less"
            words = (
                f"the {name} is bent {_round(more[finger - 1])} degrees {word} than in {label!r}"
            )
        yield HandDifference(share, words)


def _turn(query: HandShape, example: HandShape) -> Iterator[HandDifference]:
    """Yield the turn in the image, if it is clear."""
    one, other = (hand.xy[_MIDDLE] - hand.xy[_WRIST] for hand in (query, example))
    turned = np.degrees(np.arctan2(other[0] * one[1] - other[1] * one[0], one @ other))
    if abs(turned) >= CLEARLY_TURNED:
        way = "clockwise" if turned > 0 else "anticlockwise"
        left = measure_distance(query.turn(-turned), example)
        words = f"the hand is turned by {_round(turned)} degrees {way}"
        yield HandDifference(_share(measure_distance(query, example), left), words)


def _share(whole: float, left: float) -> float:
    return float(np.clip(1 - left / whole, 0, 1)) if whole > 0 else 0.0


def _round(degrees: float) -> int:
    return ROUNDED * round(abs(degrees) / ROUNDED)
