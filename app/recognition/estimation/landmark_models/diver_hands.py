"""The paper's hand models: a YOLOv7 hand detector and a classifier with keypoint heat maps.

Shapes and preparation are those of the repository the pair comes from (MeCO-AUV/robo_chat_gest):
detector 416 x 416, RGB, letterboxed; classifier 192 x 192, the square around the box, BGR. The
published ROS port feeds the classifier a stretched box instead, which is empty for a hand at the
image's edge, and publishes cells of the heat map as if they were image coordinates; here a hand
beyond the edge is padded with black, and keypoints are pixels of the image.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from app.recognition.errors import ModelError
from app.recognition.estimation.estimator import check_image
from app.recognition.estimation.landmark_models.hand_tracker import MOST_HANDS
from app.recognition.estimation.landmark_models.onnx_session import Letterbox, PlanarModel, Provider
from app.recognition.estimation.landmark_models.region import ZERO_BORDER, Region
from app.recognition.poses.frame import SIDES, Body, Hand, Image, Side
from app.recognition.poses.landmarks import HAND_LANDMARKS, POSE_LANDMARKS
from app.recognition.poses.sequence import FloatArray

DETECTOR_SIDE: Final = 416
KEYPOINTS_SIDE: Final = 192
"""Pixels of the two inputs, where the files leave them open."""

DETECTION: Final = 7
"""Columns of the detector's output: image in the batch, box (corners), class, score."""

LEAST_SCORE: Final = 0.5
"""Least score of a hand, as in the published port."""

LEAST_PEAK: Final = 0.1
"""Mean height of the heat maps' peaks from which there is a hand. Maps are trained towards peaks of
1; where all stay below a tenth of that, the highest cells mean nothing."""

MEAN: Final = np.array([0.485, 0.456, 0.406])
DEVIATION: Final = np.array([0.229, 0.224, 0.225])
"""Means and standard deviations of ImageNet's channels. The classifier's own repository applies
them to values from 0 to 255 and then divides by 255. This is repeated here, because the weights
were trained for some such scale and not for 0 to 1."""

QUARTER: Final = 0.25
"""Cells by which a peak is moved towards its higher neighbour (Xiao et al. 2018): a cell is four
pixels of the input, a finger fifteen wide."""


class DiverHands:
    """Finds hands in a whole image.

    Parameters
    ----------
    detector, keypoints
        The two ONNX files.
    threads, provider
        As in `OnnxPoseEstimator`.

    Raises
    ------
    ModelError
        When a file is missing, damaged, or gives something else; the message names the shape seen
        and the shape needed.
    EstimatorError
        When the provider is not available here.

    """

    def __init__(
        self, detector: Path, keypoints: Path, *, threads: int = 1, provider: Provider = "cpu"
    ) -> None:
        load = partial(PlanarModel, threads=threads, provider=provider)
        self._detector = load(detector, "a YOLOv7 hand detector", side=DETECTOR_SIDE)
        described = "a hand-keypoint classifier with heat maps"
        self._keypoints = load(keypoints, described, side=KEYPOINTS_SIDE)
        _boxes(self._detector.blank(), detector)
        _heat_maps(self._keypoints.blank(), keypoints)
        width, height = self._keypoints.input_size
        if width != height:
            raise ModelError(
                f"{keypoints} takes images of {width} x {height}, needed: square ones, for a hand "
                f"is cut out as a square"
            )

    def find(self, image: Image, bodies: Sequence[Body]) -> tuple[Hand, ...]:
        """Return up to two hands a person in `image`, larger first.

        Parameters
        ----------
        image
            ``(height, width, 3)`` RGB, upright.
        bodies
            The bodies in the image. The nearest wrist gives a hand's side, which the models do not.
            Without a body every hand counts as a right one, which makes no difference to the
            salute.

        Raises
        ------
        EstimatorError
            When `image` is not an RGB image of 8 bits.

        """
        check_image(image)
        letterbox = Letterbox.fitting((image.shape[1], image.shape[0]), self._detector.input_size)
        planes = letterbox.apply(image).transpose(2, 0, 1).astype(np.float32) / 255
        rows = _boxes(self._detector.run(planes), self._detector.path)
        best = rows[np.argsort(-rows[:, 6], kind="stable")][: MOST_HANDS * max(1, len(bodies))]
        found = (
            self._hand(image, letterbox.to_image(row[1:5].reshape(2, 2)), float(row[6]), bodies)
            for row in best
            if row[6] >= LEAST_SCORE
        )
        return tuple(sorted((hand for hand in found if hand), key=lambda hand: -hand.size))

    def examine(self, image: Image, bodies: Sequence[Body]) -> tuple[Hand, ...]:
        """Return the same as `find`: images are processed independently."""
        return self.find(image, bodies)

    def reset(self) -> None:
        """Do nothing: images are processed independently."""

    def _hand(
        self, image: Image, box: FloatArray, score: float, bodies: Sequence[Body]
    ) -> Hand | None:
        centre, side = box.mean(axis=0), float((box[1] - box[0]).max())
        region = Region(float(centre[0]), float(centre[1]), side)
        if not region.usable:
            return None
        size = self._keypoints.input_size[0]
        pixels = region.crop(image, size, ZERO_BORDER)[:, :, ::-1]
        planes = ((pixels - MEAN) / DEVIATION / 255).transpose(2, 0, 1)
        maps = _heat_maps(self._keypoints.run(planes), self._keypoints.path)
        belief = float(np.clip(maps.max(axis=(1, 2)).mean(), 0, 1))
        if not belief >= LEAST_PEAK:
            return None
        cells = np.array([maps.shape[2], maps.shape[1]])
        xy = region.to_image(find_peaks(maps) / cells * size, size)
        return Hand(xy, _side_of(xy, bodies), min(score, 1.0) * belief)


def find_peaks(maps: npt.NDArray[np.float32]) -> FloatArray:
    """Return ``(K, 2)`` the highest cells of heat maps ``(K, rows, columns)``, column then row.

    A peak inside the map is moved by a `QUARTER` towards its higher neighbour, across and down.
    """
    count, rows, columns = maps.shape
    row, column = np.divmod(maps.reshape(count, -1).argmax(axis=1), columns)
    every = np.arange(count)
    beside = (
        maps[every, row, np.minimum(column + 1, columns - 1)]
        - maps[every, row, np.maximum(column - 1, 0)]
    )
    below = (
        maps[every, np.minimum(row + 1, rows - 1), column]
        - maps[every, np.maximum(row - 1, 0), column]
    )
    inside = (column > 0) & (column < columns - 1), (row > 0) & (row < rows - 1)
    shift = np.stack([np.sign(beside) * inside[0], np.sign(below) * inside[1]], axis=1)
    return np.stack([column, row], axis=1) + QUARTER * shift


def _boxes(outputs: list[npt.NDArray[np.float32]], path: Path) -> FloatArray:
    """Return the detector's rows ``(N, 7)``."""
    first = outputs[0]
    if first.ndim != 2 or first.shape[1] != DETECTION:
        raise ModelError(
            f"{path} gives {[output.shape for output in outputs]}, needed: (hands, {DETECTION}), a "
            f"YOLOv7 hand detector exported with suppression inside (--end2end)"
        )
    return np.asarray(first, dtype=np.float64)


def _heat_maps(outputs: list[npt.NDArray[np.float32]], path: Path) -> npt.NDArray[np.float32]:
    """Return the heat maps ``(21, rows, columns)``, from whichever output they are."""
    for output in outputs:
        if output.ndim == 4 and output.shape[:2] == (1, len(HAND_LANDMARKS)):
            return np.asarray(output[0])
    raise ModelError(
        f"{path} gives {[output.shape for output in outputs]}, needed: (1, {len(HAND_LANDMARKS)}, "
        f"rows, columns), the heat maps of a hand-keypoint classifier"
    )


def _side_of(xy: FloatArray, bodies: Sequence[Body]) -> Side:
    """Return the side of the nearest wrist."""
    wrists = [
        (body.xy[POSE_LANDMARKS.index(f"{side}_wrist")], side) for body in bodies for side in SIDES
    ]
    distances = [float(np.linalg.norm(wrist - xy[0])) for wrist, _ in wrists]
    if not np.isfinite(distances).any():
        return "right"
    return wrists[int(np.nanargmin(distances))][1]
