"""Body model: landmarks of the person in one region of an image, and the search of a whole image.

`BodySearch` finds rotated or dim persons that the person detector misses. Divers swim on their
sides and head down, and water takes the contrast that the detector was trained on. So its weak
candidates count too, in the image turned four ways, and `BodyModel` decides among them. It runs
twice, the second time on the region that its first result gives, and the product of both scores is
the candidate's score. A region with nobody in it seldom leads to a second one with a high score.
Candidates whose torso leaves the image, or that would not fit into it, are dropped: the detector
sees people that near itself, and the model takes hands for bodies.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import numpy.typing as npt

from app.recognition.estimation.landmark_models.detector import Detector, refine, sigmoid
from app.recognition.estimation.landmark_models.onnx_session import ModelSession, Signature
from app.recognition.estimation.landmark_models.region import REPLICATED_BORDER, Region
from app.recognition.poses.frame import Image
from app.recognition.poses.landmarks import POSE_LANDMARKS
from app.recognition.poses.sequence import FloatArray

INPUT_SIZE: Final = 256
"""Side of the landmark model's input in pixels."""

LANDMARKS: Final = 39
"""The model's points: 33 landmarks, two for the body's region, and four unused."""

USED_LANDMARKS: Final = 35
"""The points that are used: all but the last four."""

HEATMAP_SIZE: Final = 64
"""Cells along a side of the heat maps."""

POSE_SIGNATURE: Final = Signature(
    INPUT_SIZE,
    outputs=(
        (1, LANDMARKS * 5),
        (1, 1),
        (1, HEATMAP_SIZE, HEATMAP_SIZE, LANDMARKS),
        (1, LANDMARKS * 3),
    ),
)
"""Landmarks (x, y, z, visibility, presence), probability of a person, heat maps, world landmarks
(x, y, z in metres, in the region's axes)."""

MID_HIPS, REACH_POINT = 33, 34
"""Auxiliary points: the middle of the hips, and a point on the circle around the whole body."""

MARGIN: Final = 1.25
"""The region's side over the circle's diameter, so that a moving body stays inside."""

LEAST_PRESENCE: Final = 0.5
"""Least probability of a body; MediaPipe's default minimum presence confidence."""


@dataclass(frozen=True, eq=False)
class SeenBody:
    """A body as found in one region, not smoothed.

    Attributes
    ----------
    xy
        ``(33, 2)`` pixels of the image.
    visibility
        ``(33,)`` in [0, 1].
    score
        The model's probability of a person.
    world
        ``(33, 3)`` metres, in the image's axes.
    following
        Its region in the next frame, which need not be usable.

    """

    xy: FloatArray
    visibility: FloatArray
    score: float
    world: FloatArray
    following: Region

    @property
    def believed(self) -> bool:
        """Whether there is a body with a usable region in the next frame."""
        return self.score >= LEAST_PRESENCE and self.following.usable


class BodyModel:
    """The pose landmark model (Bazarevsky et al. 2020, BlazePose).

    Parameters
    ----------
    session
        The model, loaded with `POSE_SIGNATURE`.

    """

    def __init__(self, session: ModelSession) -> None:
        self._session = session

    def look(self, image: Image, region: Region) -> SeenBody:
        """Return the body in a usable `region` of `image`, however low its score."""
        region.crop(image, INPUT_SIZE, REPLICATED_BORDER, out=self._session.pixels)
        raw, presence, heatmap, metric = self._session.run()
        points = raw.reshape(LANDMARKS, 5)[:USED_LANDMARKS]
        unit = points[:, :2].astype(np.float64) / INPUT_SIZE
        refined = refine(unit, heatmap[0, :, :, :USED_LANDMARKS])
        xy = region.to_image(refined * INPUT_SIZE, INPUT_SIZE)
        count = len(POSE_LANDMARKS)
        return SeenBody(
            xy=xy[:count],
            visibility=sigmoid(points[:count, 3]),
            score=min(float(presence[0, 0]), 1.0),
            world=_turn_upright(metric.reshape(LANDMARKS, 3)[:count], region),
            following=Region.aligned(xy[MID_HIPS], xy[REACH_POINT], MARGIN),
        )


def _turn_upright(metric: npt.NDArray[np.float32], region: Region) -> FloatArray:
    """Return world landmarks ``(K, 3)`` in the image's axes instead of the region's."""
    world = metric.astype(np.float64)
    cosine, sine = math.cos(region.rotation), math.sin(region.rotation)
    world[:, :2] = world[:, :2] @ np.array([[cosine, sine], [-sine, cosine]])
    return world


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
