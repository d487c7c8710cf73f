"""Hand finder: finds whole hands of divers, in gloves too, where no fingers need to be seen.

The model is MediaPipe's palm detector, taught further on rendered divers (`release/hand_finder`).
Its boxes are of whole hands; of its keypoints the first is the wrist and the third the middle
finger's knuckle.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

import numpy as np

from app.recognition.estimation.landmark_models.arms import measure_body
from app.recognition.estimation.landmark_models.detector import Detector
from app.recognition.estimation.landmark_models.region import (
    KNUCKLES,
    WRIST,
    Region,
    up_of,
    upright,
)
from app.recognition.estimation.landmark_models.suppression import Detection
from app.recognition.poses.frame import Body, Hand, Image
from app.recognition.poses.landmarks import HAND_LANDMARKS, POSE_LANDMARKS

PART: Final = 0.62
"""Side of the four parts of an image that are searched, over its longer side: a hand of a
distant diver is too small in the whole."""

CENTRES: Final = (0.3, 0.7)
"""Centres of these parts, across and down, as shares of the image."""

PALM: Final = 0.35
"""Distance from the wrist to the knuckles, over the side of a place; the finder tells the way from
one to the other, not the distance."""

LARGEST: Final = 2.5
"""Side of the largest hand, in body sizes: in dark water, of near divers, the pose is too small."""

HEAD: Final = 0.4
"""Distance of the nose from the middle of a place that is a head in its hood, over its side."""

_NOSE: Final = POSE_LANDMARKS.index("nose")

AROUND: Final = 3.5
"""Side of the region in which a place is looked for again, over the side of its box."""

SAME_PLACE: Final = 0.5
"""Distance of two places, over the larger one's side, below which they are the same hand."""


@dataclass(frozen=True, eq=False)
class HandPlace:
    """Where a hand is.

    Attributes
    ----------
    hand
        Its wrist and, at the middle finger's, its knuckles; fingers are NaN.
    box
        The square around the hand, turned so that the middle knuckle is straight above the wrist.

    """

    hand: Hand
    box: Region

    def fits(self, body: Body) -> bool:
        """Return whether it is no head, and not too large for a hand of a body in the image."""
        far = float(np.linalg.norm(body.xy[_NOSE] - (self.box.x, self.box.y)))
        is_head = far < HEAD * self.box.side
        return not is_head and not self.box.side > LARGEST * measure_body(body)


class HandFinder:
    """Finds the places of hands in images, each by itself.

    Parameters
    ----------
    detector
        The taught detector.

    """

    def __init__(self, detector: Detector) -> None:
        self._detector = detector

    def search(
        self, image: Image, regions: Iterable[Region], least: float
    ) -> tuple[HandPlace, ...]:
        """Return the places with a score from `least` in regions of `image`, best first."""
        return _distinct(
            _place(found)
            for region in regions
            if region.usable
            for found in self._detector.detect_in(image, region, least=least)
        )

    def look(self, image: Image, box: Region, least: float) -> HandPlace | None:
        """Return the place nearest to where a hand was, None where its score is below `least`."""
        around = Region(box.x, box.y, AROUND * box.side)
        places = [_place(found) for found in self._detector.detect_in(image, around, least=least)]
        near = [place for place in places if _distance(place.box, box) < 1]
        return min(near, key=lambda place: _distance(place.box, box), default=None)


def parts_of(image: Image) -> tuple[Region, ...]:
    """Return the whole of an image, and four overlapping parts of it."""
    height, width = image.shape[:2]
    whole = Region.around(image)
    parts = (
        Region(across * width, down * height, PART * whole.side)
        for across in CENTRES
        for down in CENTRES
    )
    return (whole, *parts)


def _place(found: Detection) -> HandPlace:
    x, y = found.box.mean(axis=0)
    side = float((found.box[1] - found.box[0]).max())
    rotation = upright(found.keypoints[0], found.keypoints[2])
    xy = np.full((len(HAND_LANDMARKS), 2), np.nan)
    xy[WRIST] = found.keypoints[0]
    xy[list(KNUCKLES)] = found.keypoints[0] + PALM * side * up_of(rotation)
    return HandPlace(Hand(xy, "right", found.score), Region(float(x), float(y), side, rotation))


def _distinct(places: Iterable[HandPlace]) -> tuple[HandPlace, ...]:
    """Return the places without those that show the hand of a better one, best first."""
    kept: list[HandPlace] = []
    for place in sorted(places, key=lambda one: -one.hand.score):
        if place.box.usable and all(_distance(place.box, one.box) > SAME_PLACE for one in kept):
            kept.append(place)
    return tuple(kept)


def _distance(one: Region, other: Region) -> float:
    """Return how far two boxes are apart, in the side of the larger one."""
    return float(np.hypot(one.x - other.x, one.y - other.y)) / max(one.side, other.side)
