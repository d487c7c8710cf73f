"""Takes of movements with a hand shape: a diver who draws with a hand of `parametric_hand`."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.recognition.poses.sequence import FloatArray, PoseSequence
from tests.recognition.held_takes import hold
from tests.recognition.parametric_hand import Fingers

FRAMES = 60


def circle(size: float = 0.4, frames: int = FRAMES) -> FloatArray:
    """Return a circle, ``(frames, 2)`` torso lengths."""
    angle = np.linspace(0, 2 * np.pi, frames)
    return size * np.stack([np.sin(angle), 1 - np.cos(angle)], axis=1)


def corner(size: float = 0.8, frames: int = FRAMES) -> FloatArray:
    """Return two strokes, to the side and down, ``(frames, 2)`` torso lengths."""
    share = np.linspace(0, 2, frames)
    return size * np.stack([np.minimum(share, 1), np.maximum(share - 1, 0)], axis=1)


def draw(
    shape: Fingers,
    path: FloatArray,
    *,
    turning: float = 0.0,
    seen: float = 1.0,
    seed: int = 0,
    roll: float = 0.0,
) -> PoseSequence:
    """Return a take in which the right hand draws a path with a shape.

    Parameters
    ----------
    shape
        The fingers.
    path
        ``(T, 2)`` torso lengths.
    turning
        Degrees by which the hand turns in the image during the take, to either side.
    seen
        Share of the frames in which the hand is seen.
    seed
        Of the landmarks' errors, and of the frames in which it is not seen.
    roll
        Degrees by which the hand is turned in the image throughout.

    """
    take = hold(shape, frames=len(path), seed=seed, moving=path, roll=roll)
    assert take.hands is not None
    hands = take.hands.copy()
    angles = np.radians(turning * np.sin(np.linspace(0, 2 * np.pi, len(path))))
    cosine, sine = np.cos(angles), np.sin(angles)
    turn = np.array([[cosine, sine], [-sine, cosine]]).transpose(2, 0, 1)
    wrists = hands[:, 1, :1].copy()
    hands[:, 1] = (hands[:, 1] - wrists) @ turn + wrists
    hands[np.random.default_rng(seed).permutation(len(path))[round(seen * len(path)) :]] = np.nan
    return replace(take, hands=hands)


def without_hands(take: PoseSequence) -> PoseSequence:
    """Return a take of a source that finds no hands."""
    return replace(take, hands=None)
