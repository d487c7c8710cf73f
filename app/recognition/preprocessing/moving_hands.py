"""Moving hands: the shapes that hands keep while they move."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Final

import numpy as np

from app.recognition.features.motion import parse_body_part
from app.recognition.poses.frame import SIDES, HandShape, Side, choose_frames, normalize_hands
from app.recognition.poses.sequence import FloatArray, PoseSequence
from app.recognition.preprocessing.holds import MOST_CHANGE, measure_distances

LEAST_SEEN: Final = 0.25
"""Least share of the frames in which a moving hand is seen: the hand model loses quick hands, and
the median of a quarter of the frames is as good (`benchmarks/studies/hand-shapes.md`)."""

LEAST_FRAMES: Final = 5
"""Least frames in which it is seen: a hand model's single errors outvote fewer."""

ROUNDS: Final = 3
"""Rounds in which frames are turned to their median shape; a further one changes no digit."""


def list_moving_sides(salient: Sequence[str]) -> tuple[Side, ...]:
    """Return the sides of the arms that carry a movement, by its salient landmarks."""
    parts = [parse_body_part(name) for name in salient]
    return tuple(side for side in SIDES if any(part.startswith(f"{side}_") for part in parts))


def find_moving_hands(
    poses: PoseSequence, sides: Collection[Side] = SIDES
) -> tuple[HandShape, ...]:
    """Find the shapes that hands keep during a movement.

    The hand turns with the arm: every frame is turned in the image to the median shape of all,
    which has the mean direction of the take. A hand counts if it is seen in `LEAST_SEEN` of the
    frames and keeps its shape, up to `MOST_CHANGE`.

    Parameters
    ----------
    poses
        Repaired poses of a take.
    sides
        The sides of the hands to search.

    Returns
    -------
    At most two, left then right.

    """
    if poses.hands is None or not len(poses):
        return ()
    shapes = []
    for index, side in enumerate(SIDES):
        hands = poses.hands[:, index]
        seen = np.isfinite(hands).all(axis=(1, 2))
        if side not in sides or seen.sum() < max(LEAST_FRAMES, LEAST_SEEN * len(poses)):
            continue
        shown = hands[seen]
        aligned, middle = _align(normalize_hands(shown[choose_frames(len(shown))]))
        if np.median(measure_distances(aligned, middle)) <= MOST_CHANGE:
            shapes.append(HandShape.of_frames(side, aligned))
    return tuple(shapes)


def _align(hands: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Turn hands ``(T, 21, 2)`` in the image to their median shape; return both.

    Generalised Procrustes analysis (Gower 1975) with the median for the mean.
    """
    aligned, middle = hands, np.median(hands, axis=0)
    own = hands[..., 0] + 1j * hands[..., 1]
    for _ in range(ROUNDS):
        product = own.conj() @ (middle[:, 0] + 1j * middle[:, 1])
        turned = own * np.exp(1j * np.angle(product))[:, None]
        aligned = np.stack([turned.real, turned.imag], axis=2)
        middle = normalize_hands(np.median(aligned, axis=0)[None])[0]
    return aligned, middle
