"""Image regions: rotated squares that are cropped for a model, and the boxes that they come from.

A `Region` maps its results back to the image. `region_of_palm` and `region_of_hand` give that of a
whole hand, from its palm or from its previous landmarks. Non-maximum suppression merges overlapping
boxes of one object (`blend_overlapping`), or keeps the best of them (`select_best`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import cv2
import numpy as np
import numpy.typing as npt
from typing_extensions import Self

from app.recognition.estimation.estimator import LARGEST_SIDE
from app.recognition.poses.frame import Image
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


TINIEST_SIDE: Final = 1.0
"""Smallest side of a usable region, pixels."""

ZERO_BORDER: Final = cv2.BORDER_CONSTANT
"""Black beyond the image, as in the detectors' training."""

REPLICATED_BORDER: Final = cv2.BORDER_REPLICATE
"""The image's edge repeated beyond the image, as in the landmark models' training."""


@dataclass(frozen=True)
class Region:
    """A rotated square region of interest.

    Attributes
    ----------
    x, y
        Its centre in pixels of the image, x right, y down.
    side
        Length of its sides in pixels.
    rotation
        Radians by which the square is turned; positive is clockwise as seen on the screen.

    """

    x: float
    y: float
    side: float
    rotation: float = 0.0

    @classmethod
    def around(cls, image: Image) -> Self:
        """Return the smallest upright square that holds the whole image, centred on it."""
        height, width = image.shape[:2]
        return cls(width / 2, height / 2, float(max(width, height)))

    @classmethod
    def aligned(cls, centre: FloatArray, top: FloatArray, scale: float) -> Self:
        """Return the region centred on one point and turned so that another lies straight above.

        Parameters
        ----------
        centre, top
            ``(2,)`` pixels.
        scale
            Side of the region over twice the distance of the two points.

        """
        reach = math.hypot(top[0] - centre[0], top[1] - centre[1])
        return cls(float(centre[0]), float(centre[1]), 2 * reach * scale, upright(centre, top))

    @property
    def usable(self) -> bool:
        """Whether the region is finite and of a possible size."""
        return (
            math.isfinite(self.x + self.y + self.rotation)
            and abs(self.x) < LARGEST_SIDE
            and abs(self.y) < LARGEST_SIDE
            and TINIEST_SIDE <= self.side <= LARGEST_SIDE
        )

    def matrix(self, size: int) -> FloatArray:
        """Return the ``(2, 3)`` map from pixels of the `size` x `size` crop to image pixels.

        Crop pixel (0, 0) maps onto the region's corner itself, without half a pixel's shift, as
        in MediaPipe's own converter: its models' outputs are calibrated to that.
        """
        cosine, sine = math.cos(self.rotation), math.sin(self.rotation)
        scale, half = self.side / size, self.side / 2
        return np.array(
            [
                [cosine * scale, -sine * scale, self.x - cosine * half + sine * half],
                [sine * scale, cosine * scale, self.y - sine * half - cosine * half],
            ]
        )

    def crop(
        self, image: Image, size: int, border: int, out: npt.NDArray[np.uint8] | None = None
    ) -> npt.NDArray[np.uint8]:
        """Cut the region, a `usable` one, out of `image`, upright and scaled, bilinearly.

        Parameters
        ----------
        image
            ``(height, width, 3)``, any strides.
        size
            Side of the result in pixels.
        border
            `ZERO_BORDER` or `REPLICATED_BORDER`, used beyond the image.
        out
            ``(size, size, 3)`` array to write into, so that no memory is taken per frame.

        """
        positions, fractions = self._positions(size)
        cropped = cv2.remap(
            image, positions, fractions, cv2.INTER_LINEAR, dst=out, borderMode=border
        )
        return np.asarray(cropped, dtype=np.uint8)

    def _positions(self, size: int) -> tuple[npt.NDArray[np.int16], npt.NDArray[np.uint16]]:
        """Return the position in the image of each pixel of the crop, in OpenCV's fixed point.

        In 1/32 of a pixel, as OpenCV up to 4.x and MediaPipe sample crops. From version 5 on
        OpenCV's `warpAffine` samples exactly, which moves landmarks by up to 0.04 of the frame in
        hard images; rounded positions give the same result in every version.
        """
        steps = np.arange(size)
        x, y = (
            np.add.outer(
                (row * steps + origin).astype(np.float32), (column * steps).astype(np.float32)
            )
            for column, row, origin in self.matrix(size)
        )
        positions, fractions = cv2.convertMaps(x, y, cv2.CV_16SC2)
        return np.asarray(positions, dtype=np.int16), np.asarray(fractions, dtype=np.uint16)

    def to_image(self, points: npt.NDArray[np.floating], size: int) -> FloatArray:
        """Map ``(N, 2)`` pixels of the `size` x `size` crop to pixels of the image."""
        matrix = self.matrix(size)
        return np.asarray(points @ matrix[:, :2].T + matrix[:, 2], dtype=np.float64)

    def overlap(self, other: Region) -> float:
        """Return intersection over union of the two squares, both taken as if upright.

        As in MediaPipe's association of regions, which ignores rotation because regions of one
        object are rotated alike.
        """
        across = _measure_overlap(self.x, self.side, other.x, other.side)
        down = _measure_overlap(self.y, self.side, other.y, other.side)
        union = self.side**2 + other.side**2 - across * down
        return across * down / union if union > 0 else 0.0


def upright(base: FloatArray, top: FloatArray) -> float:
    """Return the rotation in [-pi, pi) of a region in which `top` lies straight above `base`."""
    angle = math.pi / 2 - math.atan2(base[1] - top[1], top[0] - base[0])
    return (angle + math.pi) % (2 * math.pi) - math.pi


def _measure_overlap(one: float, one_side: float, other: float, other_side: float) -> float:
    """Return the overlap of two intervals, each given by its middle and its length."""
    end = min(one + one_side / 2, other + other_side / 2)
    start = max(one - one_side / 2, other - other_side / 2)
    return max(0.0, end - start)


PALM_SCALE: Final = 2.6
PALM_SHIFT: Final = 0.5
"""Side of the whole hand's region over that of the palm's box, and its shift to the fingers.

These two values and the next two are those that MediaPipe's landmark model was trained with.
"""

PALM_TURN: Final = 90 - 14 * 2 * math.pi - math.pi / 2
"""Radians, about 0.46: how far MediaPipe turns a palm's region beyond upright.

Its graph gives the target angle as 90 where radians are expected, and so turns the hand to 90
radians. The next frame's region is upright again. Kept for parity with the library: it affects
which hands are found.
"""

HAND_SCALE: Final = 2.0
HAND_SHIFT: Final = 0.1
"""Side of the next frame's region over that of the box of a hand's landmarks, and its shift."""

WRIST, INDEX_KNUCKLE, MIDDLE_KNUCKLE, RING_KNUCKLE, PINKY_KNUCKLE = 0, 5, 9, 13, 17
KNUCKLES: Final = (INDEX_KNUCKLE, MIDDLE_KNUCKLE, RING_KNUCKLE, PINKY_KNUCKLE)

STEADY: Final = (0, 1, 2, 3, 5, 6, 9, 10, 13, 14, 17, 18)
"""Landmarks that bound the region: the palm and the fingers' first joints, slower than the tips."""


def region_of_palm(palm: Detection) -> Region:
    """Return the region of the whole hand, from wrist to middle knuckle `PALM_TURN` off upright."""
    rotation = upright(palm.keypoints[0], palm.keypoints[2]) + PALM_TURN
    width, height = palm.box[1] - palm.box[0]
    centre = palm.box.mean(axis=0) + PALM_SHIFT * height * up_of(rotation)
    side = PALM_SCALE * max(width, height)
    return Region(float(centre[0]), float(centre[1]), float(side), rotation)


def region_of_hand(xy: FloatArray) -> Region:
    """Return the region of a hand in the next frame, from its landmarks ``(21, 2)``."""
    knuckles = ((xy[INDEX_KNUCKLE] + xy[RING_KNUCKLE]) / 2 + xy[MIDDLE_KNUCKLE]) / 2
    rotation = upright(xy[WRIST], knuckles)
    right, up = right_of(rotation), up_of(rotation)
    axes = np.stack([right, -up])
    steady = xy[list(STEADY)] @ axes.T
    low, high = steady.min(axis=0), steady.max(axis=0)
    width, height = high - low
    centre = (low + high) / 2 @ axes + HAND_SHIFT * height * up
    side = HAND_SCALE * max(width, height)
    return Region(float(centre[0]), float(centre[1]), float(side), rotation)


def palm_size(xy: FloatArray) -> float:
    """Return the longest side of the triangle of wrist, index and little finger's knuckles."""
    sides = xy[[INDEX_KNUCKLE, PINKY_KNUCKLE, WRIST]] - xy[[WRIST, INDEX_KNUCKLE, PINKY_KNUCKLE]]
    return float(np.hypot(sides[:, 0], sides[:, 1]).max())


def box_of(xy: FloatArray) -> FloatArray:
    """Return the corners ``(2, 2)`` of the upright box around landmarks, low then high."""
    return np.stack([xy.min(axis=0), xy.max(axis=0)])


def right_of(rotation: float) -> FloatArray:
    """Return the unit vector, in image axes, that points right in a region so turned."""
    return np.array([math.cos(rotation), math.sin(rotation)])


def up_of(rotation: float) -> FloatArray:
    """Return the unit vector, in image axes, that points up in a region so turned."""
    return np.array([math.sin(rotation), -math.cos(rotation)])
