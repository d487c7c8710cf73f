"""Hand sides: tells a person's left hand from the right one by the wrists of the body."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.recognition.poses.frame import SIDES, Hand
from app.recognition.poses.sequence import HANDS_SHAPE, FloatArray


def place_hands(hands: Sequence[Sequence[Hand]], wrists: FloatArray) -> FloatArray | None:
    """Return the hands of all frames by the person's side.

    A hand belongs to the wrist that it is nearest to: the hand model guesses the side from the
    shape alone and takes the back of a left hand for the palm of a right one. Two hands at one
    wrist are assigned to both wrists by the least sum of distances. Where a wrist is not seen, the
    model's own side counts; of two hands of one side, the hand with the higher score.

    Parameters
    ----------
    hands
        T frames of at most a few hands.
    wrists
        ``(T, 2, 2)`` pixels of the body's left and right wrist; NaN: not seen.

    Returns
    -------
    ``(T, 2, 21, 2)`` pixels, left and right, NaN where not seen; None where no frame shows a hand.

    """
    if not any(hands):
        return None
    placed = np.full((len(hands), *HANDS_SHAPE), np.nan)
    for frame, found in enumerate(hands):
        for side, hand in _pair(found, wrists[frame]):
            placed[frame, side] = np.where(np.isfinite(hand.xy), hand.xy, np.nan)
    return placed


def _pair(found: Sequence[Hand], wrists: FloatArray) -> list[tuple[int, Hand]]:
    """Return the hands of a frame with the index of their side."""
    if not found:
        return []
    believed = sorted(found, key=lambda hand: -hand.score)[:2]
    far = np.array([np.linalg.norm(wrists - hand.xy[0], axis=1) for hand in believed])
    if not np.isfinite(far).all():
        return [(SIDES.index(hand.side), hand) for hand in reversed(believed)]
    if len(believed) == 1:
        return [(int(far[0].argmin()), believed[0])]
    crossed = far[0, 1] + far[1, 0] < far[0, 0] + far[1, 1]
    return [*enumerate(reversed(believed) if crossed else believed)]
