"""Body tracker: finds a body with the person detector, then tracks it from frame to frame."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt

from app.recognition.estimation.landmark_models.detector import Detector
from app.recognition.estimation.landmark_models.onnx_session import ModelSession, Signature
from app.recognition.estimation.landmark_models.refinement import refine, sigmoid
from app.recognition.estimation.landmark_models.region import REPLICATED_BORDER, Region
from app.recognition.estimation.landmark_models.smoothing import ExponentialFilter, OneEuroFilter
from app.recognition.poses.frame import Body, Image
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
"""Below it there is no body; MediaPipe's default minimum presence confidence."""

VISIBILITY_WEIGHT: Final = 0.1
"""Weight of a new visibility in MediaPipe's smoothing, which lags by about ten frames."""


class BodyTracker:
    """Tracks the most certain person through the frames of a clip.

    Detection runs only on frames where no body is tracked. The landmarks of a frame give the
    region of the next (Bazarevsky et al. 2020, BlazePose). Their cutoffs are MediaPipe's: 0.05 Hz
    at rest (weight about 0.01 at 30 frames a second), opening to a weight of about 0.94 when a
    landmark moves fast against the size of the body.

    Parameters
    ----------
    detector
        Finds persons.
    landmarks
        The pose landmark model, loaded with `POSE_SIGNATURE`.

    """

    def __init__(self, detector: Detector, landmarks: ModelSession) -> None:
        self._detector = detector
        self._landmarks = landmarks
        self._position = OneEuroFilter(minimum_cutoff=0.05, beta=80.0)
        self._visibility = ExponentialFilter(VISIBILITY_WEIGHT)
        self._region: Region | None = None

    def reset(self) -> None:
        """Reset the tracking."""
        self._region = None
        self._position.reset()
        self._visibility.reset()

    def track(self, image: Image, time: float) -> Body | None:
        """Return the body in `image`, taken at `time` seconds, or None where none is seen."""
        region = self._region or self._found(image)
        if region is None:
            return None
        region.crop(image, INPUT_SIZE, REPLICATED_BORDER, out=self._landmarks.pixels)
        raw, presence, heatmap, metric = self._landmarks.run()
        score = float(presence[0, 0])
        if not score >= LEAST_PRESENCE:
            self.reset()
            return None
        points = raw.reshape(LANDMARKS, 5)[:USED_LANDMARKS]
        unit = points[:, :2].astype(np.float64) / INPUT_SIZE
        refined = refine(unit, heatmap[0, :, :, :USED_LANDMARKS])
        xy = region.to_image(refined * INPUT_SIZE, INPUT_SIZE)
        following = Region.aligned(xy[MID_HIPS], xy[REACH_POINT], MARGIN)
        if not following.usable:
            self.reset()
            return None
        self._region = following
        count = len(POSE_LANDMARKS)
        return Body(
            xy=self._position.apply(xy[:count], time, scale=1 / following.side),
            visibility=self._visibility.apply(sigmoid(points[:count, 3])),
            score=min(score, 1.0),
            world=_turn_upright(metric.reshape(LANDMARKS, 3)[:count], region),
        )

    def _found(self, image: Image) -> Region | None:
        persons = self._detector.detect(image)
        if not persons:
            return None
        centre, reach = persons[0].keypoints[:2]
        region = Region.aligned(centre, reach, MARGIN)
        return region if region.usable else None


def _turn_upright(metric: npt.NDArray[np.float32], region: Region) -> FloatArray:
    """Return world landmarks ``(K, 3)`` in the image's axes instead of the region's."""
    world = metric.astype(np.float64)
    cosine, sine = math.cos(region.rotation), math.sin(region.rotation)
    world[:, :2] = world[:, :2] @ np.array([[cosine, sine], [-sine, cosine]])
    return world
