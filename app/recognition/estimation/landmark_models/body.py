"""Body tracker: finds a body with the person detector, then tracks it from frame to frame."""

from __future__ import annotations

from typing import Final

from app.recognition.estimation.landmark_models.body_model import MARGIN, BodyModel, SeenBody
from app.recognition.estimation.landmark_models.body_search import BodySearch
from app.recognition.estimation.landmark_models.detector import Detector
from app.recognition.estimation.landmark_models.region import Region
from app.recognition.estimation.landmark_models.smoothing import ExponentialFilter, OneEuroFilter
from app.recognition.poses.frame import Body, Image

SEARCH_PAUSE: Final = 10
"""Consecutive frames without a person before another search; the first frame is searched at once.
The detector finds most people within these frames, and they are tracked from then on. A search
costs as much as five detections, so frames without a person cost half as much again, and others no
more."""

VISIBILITY_WEIGHT: Final = 0.1
"""Weight of a new visibility in MediaPipe's smoothing, which lags by about ten frames."""


class BodyTracker:
    """Tracks the most certain person through the frames of a clip.

    Detection runs only on frames where no body is tracked; where it finds nobody in the first
    frame, or in `SEARCH_PAUSE` frames in a row, a `BodySearch` follows. The landmarks of a frame
    give the region of the next (Bazarevsky et al. 2020, BlazePose). Their cutoffs are MediaPipe's:
    0.05 Hz at rest (weight about 0.01 at 30 frames a second), opening to a weight of about 0.94
    when a landmark moves fast against the size of the body.

    Parameters
    ----------
    detector
        Finds persons.
    model
        The pose landmark model.
    searches
        Whether a search follows; MediaPipe's own library has none.

    """

    def __init__(self, detector: Detector, model: BodyModel, *, searches: bool = True) -> None:
        self._detector = detector
        self._model = model
        self._search = BodySearch(detector, model) if searches else None
        self._position = OneEuroFilter(minimum_cutoff=0.05, beta=80.0)
        self._visibility = ExponentialFilter(VISIBILITY_WEIGHT)
        self._region: Region | None = None
        self._until_search = 1

    def reset(self) -> None:
        """Reset the tracking; the next frame is the first."""
        self._lose()
        self._until_search = 1

    def examine(self, image: Image) -> Body | None:
        """Return the body in `image` alone, searched at once; tracking is left as it is."""
        seen = self._detect(image)
        if seen is None and self._search:
            seen = self._search.find(image)
        return Body(seen.xy, seen.visibility, seen.score, seen.world) if seen else None

    def track(self, image: Image, time: float) -> Body | None:
        """Return the body in `image`, taken at `time` seconds, or None where none is seen."""
        seen = self._look(image, self._region) if self._region else self._find(image)
        if seen is None:
            self._lose()
            return None
        self._until_search = SEARCH_PAUSE
        self._region = seen.following
        return Body(
            xy=self._position.apply(seen.xy, time, scale=1 / seen.following.side),
            visibility=self._visibility.apply(seen.visibility),
            score=seen.score,
            world=seen.world,
        )

    def _lose(self) -> None:
        self._region = None
        self._position.reset()
        self._visibility.reset()

    def _look(self, image: Image, region: Region) -> SeenBody | None:
        seen = self._model.look(image, region)
        return seen if seen.believed else None

    def _find(self, image: Image) -> SeenBody | None:
        seen = self._detect(image)
        if seen is not None or self._search is None:
            return seen
        self._until_search -= 1
        if self._until_search > 0:
            return None
        self._until_search = SEARCH_PAUSE
        return self._search.find(image)

    def _detect(self, image: Image) -> SeenBody | None:
        for person in self._detector.detect(image)[:1]:
            region = Region.aligned(person.keypoints[0], person.keypoints[1], MARGIN)
            return self._look(image, region) if region.usable else None
        return None
