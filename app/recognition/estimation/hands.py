"""Hands: proposed by the palm detector, then each tracked from frame to frame."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Final

import numpy as np

from app.recognition.estimation.base import Hand, Image, Side
from app.recognition.estimation.detector import Detector
from app.recognition.estimation.region import REPLICATED_BORDER, Region, upright
from app.recognition.estimation.session import ModelSession, Signature
from app.recognition.estimation.suppression import Detection, overlaps
from app.recognition.landmarks import HAND_LANDMARKS
from app.recognition.poses import FloatArray

INPUT_SIZE: Final = 224
"""Side of the landmark model's input in pixels."""

HAND_SIGNATURE: Final = Signature(
    INPUT_SIZE, outputs=((1, 3 * len(HAND_LANDMARKS)), (1, 1), (1, 1))
)
"""Landmarks (x, y, z), belief that there is a hand, belief that it is a right one."""

MOST_HANDS: Final = 2
"""A diver has two, and each costs a run of the landmark model per frame."""

LEAST_PRESENCE: Final = 0.5
"""Below it there is no hand; MediaPipe's default minimum presence confidence."""

SAME_REGION: Final = 0.5
"""Overlap above which a proposal shows a hand that is tracked already (MediaPipe's default)."""

PALM_SCALE: Final = 2.6
PALM_SHIFT: Final = 0.5
"""The whole hand's region from the palm's box: its side, and the shift towards the fingers.

These two and the next two are what MediaPipe's landmark model was trained with.
"""

PALM_TURN: Final = 90 - 14 * 2 * math.pi - math.pi / 2
"""Radians, about 0.46: how far MediaPipe turns a palm's region beyond upright.

Its graph gives the angle to turn the hand to as 90 where radians are expected, and so turns it
to 90 radians. The next frame's region, made from landmarks, is upright again. Kept, for which
hands are found at all depends on it, and parity with the library is what users can check.
"""

HAND_SCALE: Final = 2.0
HAND_SHIFT: Final = 0.1
"""The next frame's region from the box of a hand's landmarks: its side, and the shift."""

WRIST, INDEX_KNUCKLE, MIDDLE_KNUCKLE, RING_KNUCKLE, PINKY_KNUCKLE = 0, 5, 9, 13, 17

STEADY: Final = (0, 1, 2, 3, 5, 6, 9, 10, 13, 14, 17, 18)
"""Landmarks that bound the region: the palm and the fingers' first joints, which tips outrun."""

DUPLICATE_DISTANCE: Final = 0.2
DUPLICATE_LANDMARKS: Final = 10
DUPLICATE_OVERLAP: Final = 0.2
"""Two hands are one if that many landmarks lie within that part of the palm's size of each
other and their boxes overlap by that much; MediaPipe found the three values by experiment."""

Proposer = Callable[[Image], Iterable[Region]]
"""Gives regions of an image in which a hand may be, most likely first."""


class PalmProposer:
    """Proposes hand regions where the palm detector sees palms in the whole image."""

    def __init__(self, detector: Detector) -> None:
        self._detector = detector

    def __call__(self, image: Image) -> tuple[Region, ...]:
        """Return at most `MOST_HANDS` regions, the most certain palm first."""
        palms = self._detector.detect(image)
        return tuple(region_of_palm(palm) for palm in palms[:MOST_HANDS])


@dataclass(frozen=True, eq=False)
class _Tracked:
    """A hand of this frame and the region to look for it in the next."""

    hand: Hand
    following: Region


class HandTracker:
    """Follows up to two hands through the frames of a clip.

    Proposals are asked for only while fewer hands than `MOST_HANDS` are tracked; the landmarks
    of a frame give the regions of the next (Zhang et al. 2020, MediaPipe Hands). Hands are not
    smoothed: the model's own output is steady, and fingers are fast.

    Parameters
    ----------
    propose
        Where to look for hands that are not tracked yet.
    landmarks
        The hand landmark model, loaded with `HAND_SIGNATURE`.

    """

    def __init__(self, propose: Proposer, landmarks: ModelSession) -> None:
        self._propose = propose
        self._landmarks = landmarks
        self._regions: tuple[Region, ...] = ()

    def reset(self) -> None:
        """Forget the hands."""
        self._regions = ()

    def track(self, image: Image) -> tuple[Hand, ...]:
        """Return the hands in `image`, larger first."""
        kept: list[_Tracked] = []
        for region in self._candidates(image):
            tracked = self._landmarked(image, region)
            if tracked is None or any(duplicates(tracked.hand, one.hand) for one in kept):
                continue
            kept.append(tracked)
        self._regions = tuple(one.following for one in kept if one.following.usable)
        return tuple(sorted((one.hand for one in kept), key=lambda hand: -hand.size))

    def _candidates(self, image: Image) -> list[Region]:
        regions = list(self._regions)
        if len(regions) < MOST_HANDS:
            for proposal in self._propose(image):
                known = any(proposal.overlap(region) > SAME_REGION for region in regions)
                if proposal.usable and not known:
                    regions.append(proposal)
        return regions[:MOST_HANDS]

    def _landmarked(self, image: Image, region: Region) -> _Tracked | None:
        region.crop(image, INPUT_SIZE, REPLICATED_BORDER, out=self._landmarks.pixels)
        raw, presence, right = self._landmarks.run()
        score = float(presence[0, 0])
        if not score >= LEAST_PRESENCE:
            return None
        points = raw.reshape(len(HAND_LANDMARKS), 3)[:, :2].astype(np.float64)
        xy = region.to_image(points, INPUT_SIZE)
        # The model was trained on mirrored selfies and renamed since: in an unmirrored image
        # this output is the belief in the person's own right hand.
        side: Side = "right" if right[0, 0] > 0.5 else "left"
        return _Tracked(Hand(xy, side, min(score, 1.0)), region_of_hand(xy))


def region_of_palm(palm: Detection) -> Region:
    """Return the region of the whole hand, from wrist to middle knuckle `PALM_TURN` off upright."""
    rotation = upright(palm.keypoints[0], palm.keypoints[2]) + PALM_TURN
    width, height = palm.box[1] - palm.box[0]
    centre = palm.box.mean(axis=0) + PALM_SHIFT * height * _up(rotation)
    side = PALM_SCALE * max(width, height)
    return Region(float(centre[0]), float(centre[1]), float(side), rotation)


def region_of_hand(xy: FloatArray) -> Region:
    """Return the region to look for a hand in next, from its landmarks ``(21, 2)``."""
    knuckles = ((xy[INDEX_KNUCKLE] + xy[RING_KNUCKLE]) / 2 + xy[MIDDLE_KNUCKLE]) / 2
    rotation = upright(xy[WRIST], knuckles)
    right, up = _right(rotation), _up(rotation)
    axes = np.stack([right, -up])
    steady = xy[list(STEADY)] @ axes.T
    low, high = steady.min(axis=0), steady.max(axis=0)
    width, height = high - low
    centre = (low + high) / 2 @ axes + HAND_SHIFT * height * up
    side = HAND_SCALE * max(width, height)
    return Region(float(centre[0]), float(centre[1]), float(side), rotation)


def duplicates(one: Hand, other: Hand) -> bool:
    """Tell whether two results show the same hand."""
    near = DUPLICATE_DISTANCE * max(_palm_size(one.xy), _palm_size(other.xy))
    distances = np.linalg.norm(one.xy - other.xy, axis=1)
    if np.count_nonzero(distances < near) < DUPLICATE_LANDMARKS:
        return False
    return bool(overlaps(_box(one.xy), _box(other.xy)[None])[0] > DUPLICATE_OVERLAP)


def _palm_size(xy: FloatArray) -> float:
    """Longest side of the triangle of wrist, index knuckle and little finger's knuckle."""
    sides = xy[[INDEX_KNUCKLE, PINKY_KNUCKLE, WRIST]] - xy[[WRIST, INDEX_KNUCKLE, PINKY_KNUCKLE]]
    return float(np.hypot(sides[:, 0], sides[:, 1]).max())


def _box(xy: FloatArray) -> FloatArray:
    return np.stack([xy.min(axis=0), xy.max(axis=0)])


def _right(rotation: float) -> FloatArray:
    """Return the unit vector, in image axes, that points right in a region so turned."""
    return np.array([math.cos(rotation), math.sin(rotation)])


def _up(rotation: float) -> FloatArray:
    """Return the unit vector, in image axes, that points up in a region so turned."""
    return np.array([math.sin(rotation), -math.cos(rotation)])
