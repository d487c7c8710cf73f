"""Takes of held hand shapes: a still body that holds a hand of `parametric_hand`."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from app.recognition.poses.frame import Hand
from app.recognition.poses.landmarks import POSE_LANDMARKS
from app.recognition.poses.sequence import FloatArray, PoseSequence
from app.recognition.recording.recording import Recording
from tests.recognition.parametric_hand import Finger, Fingers, View, hand_xy

CURLED = (75.0, 85.0, 50.0)
TORSO = 260.0
"""Pixels."""
PALM = 50.0
BODY = {
    "nose": (320, 90),
    "left_shoulder": (390, 150),
    "right_shoulder": (250, 150),
    "left_elbow": (420, 260),
    "right_elbow": (180, 240),
    "left_wrist": (430, 390),
    "right_wrist": (190, 150),
    "left_hip": (365, 410),
    "right_hip": (275, 410),
}


def fingers(*stretched: int) -> Fingers:
    """Return a hand with some fingers stretched, 0 the index finger."""
    spreads = (10.0, 2.0, -6.0, -14.0)
    made = [
        Finger(spread) if number in stretched else Finger(0.0, CURLED)
        for number, spread in enumerate(spreads)
    ]
    return made[0], made[1], made[2], made[3]


FLAT, FIST, TWO = fingers(0, 1, 2, 3), fingers(), fingers(0, 1)


def hold(
    shape: Fingers,
    *,
    roll: float = 0.0,
    yaw: float = 0.0,
    frames: int = 40,
    seed: int = 0,
    left: bool = False,
    thumb: float = 40.0,
    moving: FloatArray | None = None,
) -> PoseSequence:
    """Return a take in which one hand beside the face holds a shape.

    Parameters
    ----------
    shape
        The fingers.
    roll, yaw
        Degrees by which the hand is turned in the image, and about its own axis.
    frames
        At 25 a second.
    seed
        Seed of the landmarks' errors.
    left
        The left hand instead: the mirror image of everything.
    thumb
        Degrees between the thumb and the hand's axis.
    moving
        ``(frames, 2)`` torso lengths by which the hand moves.

    """
    random = np.random.default_rng(seed)
    xy = np.full((frames, len(POSE_LANDMARKS), 2), np.nan)
    for name, place in BODY.items():
        xy[:, POSE_LANDMARKS.index(name)] = place
    xy += random.normal(0, 0.5, xy.shape)
    wrist = POSE_LANDMARKS.index("right_wrist")
    if moving is not None:
        xy[:, wrist] += TORSO * moving
    hands = np.full((frames, 2, 21, 2), np.nan)
    points = PALM * hand_xy(shape, View(roll, yaw), thumb_spread=thumb)
    hands[:, 1] = (points - points[0])[None] + xy[:, wrist, None]
    hands += random.normal(0, 1.0, hands.shape)
    if left:
        swapped = [POSE_LANDMARKS.index(_other(name)) for name in POSE_LANDMARKS]
        xy, hands = xy[:, swapped] * (-1, 1) + (640, 0), hands[:, ::-1] * (-1, 1) + (640, 0)
    return PoseSequence(
        landmarks=POSE_LANDMARKS,
        xy=xy,
        time=np.arange(frames) / 25,
        frame_size=(640, 480),
        hands=hands,
    )


def _other(name: str) -> str:
    swaps = {"left": "right", "right": "left"}
    return "_".join(swaps.get(word, word) for word in name.split("_"))


def follow(*takes: PoseSequence, transition: float = 0.4, unseen: bool = False) -> PoseSequence:
    """Return a take in which the hands of some takes are shown one after the other.

    Parameters
    ----------
    takes
        At 25 frames a second, of the same hands.
    transition
        Seconds between two takes, in which body and hands move straight to their new places.
    unseen
        Whether no hand is seen in the meantime.

    """
    shares = np.arange(1, round(25 * transition) + 1) / (round(25 * transition) + 1)
    xy, hands = [takes[0].xy], [_hands_of(takes[0])]
    for before, after in pairwise(takes):
        own, others = _hands_of(before)[-1], _hands_of(after)[0]
        between = own + shares[:, None, None, None] * (others - own)
        hands += [np.full_like(between, np.nan) if unseen else between, _hands_of(after)]
        way = shares[:, None, None] * (after.xy[0] - before.xy[-1])
        xy += [before.xy[-1] + way, after.xy]
    seen = np.concatenate(xy)
    return replace(
        takes[0],
        xy=seen,
        hands=np.concatenate(hands),
        time=np.arange(len(seen)) / 25,
        confidence=None,
        world=None,
    )


def between_salutes(*takes: PoseSequence) -> Recording:
    """Return a recording of takes of the right hand, each between two salutes of 0.6 s."""
    parts, salute = [], []
    for take in takes:
        first, last = (_repeat(take, frame) for frame in (0, -1))
        parts += [first, take, last, _repeat(take, -1)]
        salute += [np.ones(len(first)), np.zeros(len(take)), np.ones(len(last))]
        salute += [np.zeros(len(last))]
    poses = follow(*parts, transition=0)
    hands = tuple((Hand(frame[1], "right", 1.0),) for frame in _hands_of(poses))
    return Recording(replace(poses, hands=None), hands, np.concatenate(salute))


def _repeat(take: PoseSequence, frame: int) -> PoseSequence:
    """Return 0.6 s of one frame of a take."""
    return replace(
        take,
        xy=np.repeat(take.xy[[frame]], 15, axis=0),
        time=np.arange(15) / 25,
        hands=np.repeat(_hands_of(take)[[frame]], 15, axis=0),
        confidence=None,
        world=None,
    )


def _hands_of(take: PoseSequence) -> FloatArray:
    assert take.hands is not None
    return take.hands
