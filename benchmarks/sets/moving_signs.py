"""Moving signs: recorded movements, each with a recorded hand that keeps a shape on its wrist.

The movement and the hand are other people's recordings; what is composed is that the hand turns
with a forearm and that quick frames are lost.
"""

from __future__ import annotations

import numpy as np

from app.recognition import PoseSequence
from app.recognition.poses.hand_shape import normalize_hands
from app.recognition.poses.sequence import HANDS_SHAPE, FloatArray

ELBOW_DISTANCE = (1.0, 1.6)
"""From the middle of the movement to the elbow, in its size: a figure is about as large as a
forearm is long, and takes differ."""

ELBOW_SPREAD = 20.0
"""Degrees by which the elbow's direction from the movement, mostly below it, differs."""

ERROR = 0.03
"""Of each landmark in each frame beside the recorded hand's own, in sizes of the hand: rendered
moving hands are 0.02 to 0.1 from their median, recorded held ones 0.05 to 0.1."""

MOST_LOST = 0.7
"""Share of the frames at the highest speed in which no hand is seen."""

HAND_SIZE = 0.03
"""Size of the hand over that of the movement: without a torso only the hand's own travel tells that
it moves, and a larger one would look held in narrow figures."""


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
    # There and back again through the frames of the hand, as long as the movement takes.
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
