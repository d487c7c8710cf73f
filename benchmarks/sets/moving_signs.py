"""Moving signs: recorded movements, each with a recorded hand that keeps a shape on its wrist.

The movement and the hand are other people's recordings; the composition turns the hand with the
forearm and removes it from fast frames.
"""

from __future__ import annotations

import numpy as np

from app.recognition import PoseSequence
from app.recognition.poses.frame import normalize_hands
from app.recognition.poses.sequence import HANDS_SHAPE, FloatArray

ELBOW_DISTANCE = (1.0, 1.6)
"""Distance from the movement's middle to the elbow, relative to the movement's size: a figure is
about as large as a forearm, and takes differ."""

ELBOW_SPREAD = 20.0
"""Spread in degrees of the elbow's direction from the movement, which is mostly downwards."""

ERROR = 0.03
"""Error added to each landmark in each frame, in hand sizes: rendered moving hands differ by 0.02
to 0.1 from their median, recorded held ones by 0.05 to 0.1."""

MOST_LOST = 0.7
"""Share of the frames at the highest speed in which no hand is seen."""

HAND_SIZE = 0.03
"""Size of the hand relative to the movement: without a torso only its travel in hand sizes shows
that it moves, so that a larger hand would look held in narrow figures."""


def compose(movement: PoseSequence, hands: FloatArray, random: np.random.Generator) -> PoseSequence:
    """Put a hand on the moving wrist of a recording.

    Parameters
    ----------
    movement
        Its first landmark is the wrist.
    hands
        ``(T, 21, 2)`` a hand that holds a shape, as if the forearm pointed up; NaN where not seen.
    random
        The elbow's place, the landmarks' errors, and the frames that are lost.

    Returns
    -------
    The recording with the landmark ``right_wrist`` and the right hand.

    """
    wrist = movement.xy[:, 0]
    shown = normalize_hands(hands[np.isfinite(hands).all(axis=(1, 2))])
    # Play the frames of the hand forwards and backwards, for as long as the movement takes.
    there = np.arange(len(wrist)) % max(2 * len(shown) - 2, 1)
    frames = shown[np.where(there < len(shown), there, 2 * len(shown) - 2 - there)]
    turns = _turn_forearm(wrist, random)
    cosine, sine = np.cos(turns), np.sin(turns)
    turn = np.array([[cosine, sine], [-sine, cosine]]).transpose(2, 0, 1)
    size = HAND_SIZE * float(np.ptp(wrist, axis=0).max())
    moved = size * (frames @ turn + ERROR * random.standard_normal(frames.shape))
    speed = np.linalg.norm(np.gradient(wrist, axis=0), axis=1)
    lost = random.random(len(wrist)) < MOST_LOST * speed / max(float(speed.max()), 1e-9)
    moved[lost] = np.nan
    both = np.full((len(wrist), *HANDS_SHAPE), np.nan)
    both[:, 1] = moved - moved[:, :1] + wrist[:, None]
    return PoseSequence(
        landmarks=("right_wrist",),
        xy=movement.xy[:, :1],
        time=movement.time,
        frame_size=movement.frame_size,
        hands=both,
    )


def _turn_forearm(wrist: FloatArray, random: np.random.Generator) -> FloatArray:
    """Return ``(T,)`` radians by which the forearm is turned from pointing up, clockwise."""
    middle, size = wrist.mean(axis=0), float(np.ptp(wrist, axis=0).max())
    below = np.radians(random.normal(90.0, ELBOW_SPREAD))
    reach = random.uniform(*ELBOW_DISTANCE) * size
    forearm = wrist - (middle + reach * np.array([np.cos(below), np.sin(below)]))
    angles = np.arctan2(forearm[:, 1], forearm[:, 0]) + np.pi / 2
    return np.asarray((angles + np.pi) % (2 * np.pi) - np.pi)
