"""Single-shot detectors that find persons or palms in an image, and the refinement of landmarks.

A `Detector` reads a model's output by its `DetectorLayout`; `refine` corrects landmarks by the pose
model's heat maps.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import numpy.typing as npt

from app.recognition.estimation.landmark_models.onnx_session import ModelSession, Signature
from app.recognition.estimation.landmark_models.region import (
    ZERO_BORDER,
    Detection,
    Region,
    blend_overlapping,
)
from app.recognition.poses.frame import Image
from app.recognition.poses.sequence import FloatArray

REACH: Final = 3
"""Heat-map cells used on each side of a landmark: the 7 x 7 window of MediaPipe Tasks."""

LEAST_PEAK: Final = 0.5
"""Least highest cell of the window; below it the landmark is not changed."""

_OFFSETS: Final = np.arange(-REACH, REACH + 1)


def sigmoid(values: npt.NDArray[np.floating]) -> FloatArray:
    """Return the logistic function of `values`; 80 is where it reaches 0 or 1 in float32."""
    clipped = np.clip(values, -80, 80).astype(np.float64)
    return np.asarray(1 / (1 + np.exp(-clipped)))


def refine(xy: FloatArray, heatmap: npt.NDArray[np.float32]) -> FloatArray:
    """Move each landmark to the centre of gravity of its heat map around it.

    Regressed coordinates are steady but coarse, heat maps exact but local (Bazarevsky et al.
    2020, BlazePose, Sec. 2.3): the coordinates select the window of the heat map.

    Parameters
    ----------
    xy
        ``(N, 2)`` landmarks in [0, 1] of the model's input, x right, y down. Those outside
        are left as they are.
    heatmap
        ``(rows, columns, N)`` logits, one channel per landmark.

    Returns
    -------
    ``(N, 2)`` refined landmarks, a new array.

    """
    rows, columns, count = heatmap.shape
    size = np.array([columns, rows])
    centre = (xy * size).astype(np.intp)
    inside = ((centre >= 0) & (centre < size)).all(axis=1)
    column = centre[:, 0, None] + _OFFSETS
    row = centre[:, 1, None] + _OFFSETS
    in_map = (
        (((row >= 0) & (row < rows))[:, :, None])
        & (((column >= 0) & (column < columns))[:, None, :])
    )
    cells = heatmap[
        row.clip(0, rows - 1)[:, :, None],
        column.clip(0, columns - 1)[:, None, :],
        np.arange(count)[:, None, None],
    ]
    weight = np.where(in_map, sigmoid(cells), 0.0)
    total = weight.sum(axis=(1, 2))
    trusted = inside & (weight.max(axis=(1, 2)) >= LEAST_PEAK)
    by_column = (weight.sum(axis=1) * column).sum(axis=1)
    by_row = (weight.sum(axis=2) * row).sum(axis=1)
    refined = xy.copy()
    moments = np.stack([by_column, by_row], axis=1)[trusted]
    refined[trusted] = moments / total[trusted, None] / size
    return refined


LEAST_SCORE: Final = 0.5
"""Least score of a detection; MediaPipe's default minimum detection confidence."""


@dataclass(frozen=True)
class DetectorLayout:
    """Layout of a single-shot detector's output (Liu et al. 2016).

    Attributes
    ----------
    input_size
        Side of the model's square input in pixels.
    strides
        Input pixels per cell, one for each grid.
    anchors_per_cell
        Candidates per cell, one number for each grid.
    keypoints
        Keypoints per candidate.
    lowest
        Scaled value of a black pixel; white is 1.
    overlap
        Intersection over union above which two candidates are the same object.

    """

    input_size: int
    strides: tuple[int, ...]
    anchors_per_cell: tuple[int, ...]
    keypoints: int
    lowest: float
    overlap: float

    @property
    def signature(self) -> Signature:
        """The shapes of the model: box and keypoints per anchor, and a score per anchor."""
        count = len(self.anchors())
        return Signature(self.input_size, ((1, count, 4 + 2 * self.keypoints), (1, count, 1)))

    def anchors(self) -> npt.NDArray[np.float32]:
        """Return ``(N, 2)`` centres of the candidates in [0, 1] of the input, x then y."""
        grids = []
        for stride, repeats in zip(self.strides, self.anchors_per_cell, strict=True):
            cells = -(-self.input_size // stride)
            row, column = np.divmod(np.arange(cells * cells), cells)
            centres = (np.stack([column, row], axis=1) + 0.5) / cells
            grids.append(np.repeat(centres, repeats, axis=0))
        return np.concatenate(grids).astype(np.float32)


PERSON_LAYOUT: Final = DetectorLayout(
    input_size=224,
    strides=(8, 16, 32),
    anchors_per_cell=(2, 2, 6),
    keypoints=4,
    lowest=-1.0,
    overlap=0.3,
)
"""MediaPipe's pose_detection: keypoints 0 and 1 are mid-hips and a point on the circle around."""

PALM_LAYOUT: Final = DetectorLayout(
    input_size=192,
    strides=(8, 16),
    anchors_per_cell=(2, 6),
    keypoints=7,
    lowest=0.0,
    overlap=0.3,
)
"""MediaPipe's palm_detection_full: keypoint 0 is the wrist, 2 the middle finger's knuckle."""


class Detector:
    """Finds objects of one kind in a whole image.

    Parameters
    ----------
    session
        The model, loaded with the layout's own signature.
    layout
        Layout of its output.

    """

    def __init__(self, session: ModelSession, layout: DetectorLayout) -> None:
        self._session = session
        self._layout = layout
        self._anchors = layout.anchors()

    def detect(
        self, image: Image, *, turn: float = 0.0, least: float = LEAST_SCORE
    ) -> tuple[Detection, ...]:
        """Return the detections in `image`, best first, in pixels of the image.

        Parameters
        ----------
        image
            ``(height, width, 3)`` RGB.
        turn
            Radians, clockwise, by which the objects that are sought are turned.
        least
            Least score of a detection.

        """
        return self.detect_in(image, replace(Region.around(image), rotation=turn), least=least)

    def detect_in(
        self, image: Image, region: Region, *, least: float = LEAST_SCORE
    ) -> tuple[Detection, ...]:
        """Return the detections in a usable `region` of `image`; see `detect`."""
        size, layout = self._layout.input_size, self._layout
        region.crop(image, size, ZERO_BORDER, out=self._session.pixels)
        raw, logits = self._session.run(layout.lowest)
        scores = sigmoid(logits[0, :, 0])
        chosen = np.flatnonzero(scores >= least)
        if not len(chosen):
            return ()
        points = self._decode(raw[0, chosen], self._anchors[chosen])
        found = blend_overlapping(points, scores[chosen], layout.overlap)
        return tuple(
            Detection(
                region.to_image(detection.box, size),
                region.to_image(detection.keypoints, size),
                detection.score,
            )
            for detection in found
        )

    def _decode(
        self, raw: npt.NDArray[np.float32], anchors: npt.NDArray[np.float32]
    ) -> npt.NDArray[np.float64]:
        """``(N, 2 + K, 2)`` box corners and keypoints in input pixels, from offsets to anchors."""
        pairs = raw.astype(np.float64).reshape(len(raw), -1, 2)
        origin = anchors[:, None] * self._layout.input_size
        centre, extent = pairs[:, :1] + origin, pairs[:, 1:2]
        keypoints = pairs[:, 2:] + origin
        return np.concatenate([centre - extent / 2, centre + extent / 2, keypoints], axis=1)
