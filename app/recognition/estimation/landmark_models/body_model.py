"""Body model: landmarks of the person in one region of an image."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from app.recognition.estimation.landmark_models.onnx_session import ModelSession, Signature
from app.recognition.estimation.landmark_models.refinement import refine, sigmoid
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
