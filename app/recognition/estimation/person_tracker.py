"""Person tracker: follows one person where several are seen."""

from __future__ import annotations

from typing import Final

import numpy as np

from app.recognition.estimation.landmark_models.suppression import measure_overlaps
from app.recognition.poses.gaps import MAX_GAP_SECONDS
from app.recognition.poses.sequence import FloatArray

SAME_PERSON: Final = 0.3
"""Least intersection over union of a person's boxes in two frames. Stretching an arm halves it; two
people beside each other overlap less."""

PATIENCE_SECONDS: Final = MAX_GAP_SECONDS
"""Seconds after which an unseen person is given up: longer gaps are not bridged in trajectories
either, so the gesture is lost anyway."""


class PersonTracker:
    """Selects the same person in every frame.

    First it is the most prominent person: the largest box, weighted by the detector's confidence.
    Then it is the person whose box overlaps the previous one, however large other boxes become.
    Frames must be in order of time.
    """

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Reset the tracking."""
        self._box: FloatArray | None = None
        self._since = -np.inf

    def choose(self, boxes: FloatArray, scores: FloatArray, time: float) -> int | None:
        """Return the index of the tracked person among N, or None where they are not seen.

        Parameters
        ----------
        boxes
            ``(N, 2, 2)`` corners (left, top) and (right, bottom), pixels.
        scores
            ``(N,)`` confidence of each, in [0, 1].
        time
            Seconds.

        """
        if not len(boxes):
            return None
        chosen = self._again(boxes)
        if chosen is None:
            if self._box is not None and 0 <= time - self._since <= PATIENCE_SECONDS:
                return None
            chosen = int(np.argmax(measure_prominence(boxes, scores)))
        self._box, self._since = boxes[chosen], time
        return chosen

    def _again(self, boxes: FloatArray) -> int | None:
        if self._box is None:
            return None
        shared = measure_overlaps(self._box, boxes)
        nearest = int(np.argmax(shared))
        return nearest if shared[nearest] >= SAME_PERSON else None


def measure_prominence(boxes: FloatArray, scores: FloatArray) -> FloatArray:
    """Return ``(N,)`` the prominence of each person: area of the box times confidence."""
    sides = np.clip(boxes[:, 1] - boxes[:, 0], 0, None)
    return np.asarray(sides.prod(axis=1) * scores, dtype=np.float64)


def find_boxes(xy: FloatArray) -> FloatArray:
    """Return ``(N, 2, 2)`` boxes around the seen points of N people ``(N, K, 2)``.

    Every person has at least one point that is not NaN.
    """
    return np.stack([np.nanmin(xy, axis=1), np.nanmax(xy, axis=1)], axis=1)
