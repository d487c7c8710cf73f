"""Non-maximum suppression: merges overlapping boxes of one object, or keeps the best of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.recognition.poses.sequence import FloatArray


@dataclass(frozen=True, eq=False)
class Detection:
    """One object that a detector found.

    Attributes
    ----------
    box
        ``(2, 2)``: its corners, (left, top) and (right, bottom).
    keypoints
        ``(K, 2)`` keypoints of the object, in the unit of the box.
    score
        The detector's confidence in [0, 1].

    """

    box: FloatArray
    keypoints: FloatArray
    score: float


def blend_overlapping(
    points: FloatArray, scores: FloatArray, threshold: float
) -> tuple[Detection, ...]:
    """Blend detections that overlap the best one, weighted by score; repeat with the rest.

    This is the "weighted" suppression of MediaPipe's detectors (Bazarevsky et al. 2019,
    BlazeFace, Sec. 3.3): blending instead of discarding takes out most of the jitter.

    Parameters
    ----------
    points
        ``(N, 2 + K, 2)``: per detection two corners of the box, then K keypoints.
    scores
        ``(N,)`` in (0, 1].
    threshold
        Intersection over union above which two boxes are the same object.

    Returns
    -------
    Detections, best first; each has the score of the best box it was blended from.

    """
    order = np.argsort(-scores, kind="stable")
    points, scores = points[order], scores[order]
    detections = []
    while len(scores):
        same = measure_overlaps(points[0, :2], points[:, :2]) > threshold
        same[0] = True
        weights = scores[same] / scores[same].sum()
        blended = np.tensordot(weights, points[same], axes=1)
        detections.append(Detection(blended[:2], blended[2:], float(scores[0])))
        points, scores = points[~same], scores[~same]
    return tuple(detections)


def select_best(boxes: FloatArray, scores: FloatArray, threshold: float) -> npt.NDArray[np.intp]:
    """Return the indices of boxes that overlap no better one, best first: greedy suppression.

    Parameters
    ----------
    boxes
        ``(N, 2, 2)``: corners (left, top) and (right, bottom).
    scores
        ``(N,)``; of equal ones the first is the better.
    threshold
        Intersection over union above which two boxes are the same object.

    """
    left = np.argsort(-scores, kind="stable")
    kept = []
    while len(left):
        best, left = left[0], left[1:]
        kept.append(best)
        left = left[measure_overlaps(boxes[best], boxes[left]) <= threshold]
    return np.array(kept, dtype=np.intp)


def measure_overlaps(box: FloatArray, boxes: FloatArray) -> FloatArray:
    """Return ``(N,)`` intersection over union of one box ``(2, 2)`` with ``(N, 2, 2)`` others.

    Boxes are given by their corners (left, top) and (right, bottom). Boxes without area give 0.
    """
    start = np.maximum(box[0], boxes[:, 0])
    end = np.minimum(box[1], boxes[:, 1])
    shared = np.clip(end - start, 0, None).prod(axis=-1)
    union = (box[1] - box[0]).prod() + (boxes[:, 1] - boxes[:, 0]).prod(axis=-1) - shared
    ratio: FloatArray = np.zeros(len(boxes))
    np.divide(shared, union, out=ratio, where=union > 0)
    return ratio
