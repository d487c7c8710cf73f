"""Body search: finds rotated or dim persons that the person detector misses.

Divers swim on their sides and head down, and water takes the contrast that the person detector was
trained on. So its weak candidates count too, in the image turned four ways, and the landmark model
decides among them. It runs twice, the second time on the region that its first result gives, and
the product of both scores is the candidate's score. A region with nobody in it seldom leads to a
second one with a high score. Candidates whose torso leaves the image, or that would not fit into
it, are dropped: the detector sees people that near itself, and the model takes hands for bodies.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

from app.recognition.estimation.landmark_models.body_model import MARGIN, BodyModel, SeenBody
from app.recognition.estimation.landmark_models.detector import Detector
from app.recognition.estimation.landmark_models.region import Region
from app.recognition.poses.frame import Image
from app.recognition.poses.landmarks import POSE_LANDMARKS

TURNS: Final = (0.0, math.pi / 2, math.pi, -math.pi / 2)
"""Radians by which the image is turned: upright, on either side, head down."""

WEAK_SCORE: Final = 0.3
"""Least score of a candidate. With it, 89 % of divers' bodies and 88 % of their heads in five
waters are found; with 0.2, 88 and 85 %, because the weakest candidates win against better ones
(`benchmarks/studies/hands-and-water.md`)."""

SURE: Final = 0.9
"""Score from which no further turn is tried; trying all of them finds no more."""

MOST_CANDIDATES: Final = 3
"""Most candidates of each turn; each costs two runs of the landmark model."""

TORSO: Final = [
    POSE_LANDMARKS.index(f"{side}_{joint}")
    for side in ("left", "right")
    for joint in ("shoulder", "hip")
]
"""The landmarks that must be in the image."""


class BodySearch:
    """Searches a whole image for the person with the highest score.

    Parameters
    ----------
    detector
        Finds candidates.
    model
        The landmark model, which decides among them.

    """

    def __init__(self, detector: Detector, model: BodyModel) -> None:
        self._detector = detector
        self._model = model

    def find(self, image: Image) -> SeenBody | None:
        """Return the person with the highest product of both scores; None where nobody is found."""
        best: SeenBody | None = None
        for turn in TURNS:
            persons = self._detector.detect(image, turn=turn, least=WEAK_SCORE)
            for person in persons[:MOST_CANDIDATES]:
                hips, reach = person.keypoints[:2]
                seen = self._look_twice(image, Region.aligned(hips, reach, MARGIN))
                if seen is not None and (best is None or seen.score > best.score):
                    best = seen
            if best is not None and best.score >= SURE:
                break
        return best

    def _look_twice(self, image: Image, region: Region) -> SeenBody | None:
        if not region.usable:
            return None
        first = self._model.look(image, region)
        if not first.following.usable:
            return None
        second = self._model.look(image, first.following)
        if not second.believed or not _fits(second, image):
            return None
        return replace(second, score=first.score * second.score)


def _fits(seen: SeenBody, image: Image) -> bool:
    """Return whether shoulders and hips are in the image, and the body is no larger than it."""
    height, width = image.shape[:2]
    torso = seen.xy[TORSO]
    inside = bool(((torso >= 0) & (torso < (width, height))).all())
    return inside and seen.following.side <= MARGIN * max(width, height)
