"""YOLO-pose: bodies from an Ultralytics export (YOLOv8, YOLO11, YOLO26), COCO's 17 keypoints.

The file is the user's: ``yolo export model=yolo11n-pose.pt format=onnx``. Both forms of the output
are read: candidates of every anchor, of which overlapping ones must be suppressed here, and final
detections (``nms=True``, and YOLO26's own form).
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from app.recognition.errors import ModelError
from app.recognition.estimation.estimator import check_image
from app.recognition.estimation.landmark_models.onnx_session import Letterbox, PlanarModel, Provider
from app.recognition.estimation.landmark_models.region import select_best
from app.recognition.estimation.person_tracker import PersonTracker, measure_prominence
from app.recognition.poses.frame import Body, FrameLandmarks, Image
from app.recognition.poses.landmarks import POSE_LANDMARKS
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.skeletons import COCO_17

DEFAULT_SIDE: Final = 640
"""Side of the input in pixels where a file leaves it open: the one with which Ultralytics trains
and exports."""

LEAST_SCORE: Final = 0.25
"""Least confidence of a person; the default of Ultralytics' own prediction."""

MOST_OVERLAP: Final = 0.7
"""Intersection over union above which two candidates are one person; Ultralytics' default too."""

MOST_OTHERS: Final = 2
"""Most people beside the one who is followed, as `landmark_models.body.MOST_PEOPLE` counts them."""

LEAST_VISIBILITY: Final = 0.5
"""Visibility below which a keypoint is NaN, as in Ultralytics' own results: its position is a guess
that would add strokes."""

VALUES: Final = 3
"""Values of a keypoint: x, y in pixels of the input, and its visibility."""

CANDIDATE: Final = 4 + 1 + VALUES * len(COCO_17)
"""Rows of the raw output: box (centre, extent), score of the one class, keypoints."""

DETECTION: Final = 6 + VALUES * len(COCO_17)
"""Columns of the final output: box (corners), score, class, keypoints."""

_COLUMNS: Final = [POSE_LANDMARKS.index(name) for name in COCO_17]


@dataclass(frozen=True, eq=False)
class People:
    """N people found in one image, in pixels of the model's input.

    Attributes
    ----------
    boxes
        ``(N, 2, 2)`` corners (left, top) and (right, bottom).
    scores
        ``(N,)`` in [0, 1].
    keypoints
        ``(N, 17, 3)`` x, y and visibility, in the order of `COCO_17`.

    """

    boxes: FloatArray
    scores: FloatArray
    keypoints: FloatArray


class YoloPose:
    """Finds people's keypoints in an image, and follows one of them; a `BodyFinder`.

    Parameters
    ----------
    path
        The ONNX file.
    threads, provider
        As in `OnnxPoseEstimator`.

    Raises
    ------
    ModelError
        When the file is missing or damaged, or is no YOLO-pose of 17 keypoints; the message names
        the shape seen and the shapes that can be read.
    EstimatorError
        When the provider is not available here.

    """

    landmarks = COCO_17

    def __init__(self, path: Path, *, threads: int = 1, provider: Provider = "cpu") -> None:
        self._model = PlanarModel(
            path,
            "an Ultralytics YOLO-pose export",
            side=DEFAULT_SIDE,
            threads=threads,
            provider=provider,
        )
        self._subject = PersonTracker()
        decode_people(self._model.blank(), self._model.path)

    def track(self, image: Image, time: float) -> FrameLandmarks:
        """Return the bodies in `image`, taken at `time` seconds; of others the most prominent.

        Landmarks that COCO does not have, or that are not visible, are NaN with visibility 0.

        Raises
        ------
        EstimatorError
            When `image` is not an RGB image of 8 bits.

        """
        return self._look(image, self._subject, time)

    def examine(self, image: Image) -> FrameLandmarks:
        """Return the bodies in `image` alone, the most prominent first; tracking is left as it is.

        Raises
        ------
        EstimatorError
            When `image` is not an RGB image of 8 bits.

        """
        return self._look(image, PersonTracker(), 0.0)

    def reset(self) -> None:
        """Reset the tracking."""
        self._subject.reset()

    def _look(self, image: Image, subject: PersonTracker, time: float) -> FrameLandmarks:
        check_image(image)
        letterbox = Letterbox.fitting((image.shape[1], image.shape[0]), self._model.input_size)
        planes = letterbox.apply(image).transpose(2, 0, 1).astype(np.float32) / 255
        people = decode_people(self._model.run(planes), self._model.path)
        chosen = subject.choose(people.boxes, people.scores, time)
        bodies = [
            _body(keypoints, float(score), letterbox)
            for keypoints, score in zip(people.keypoints, people.scores, strict=True)
        ]
        others = [
            bodies[index]
            for index in np.argsort(-measure_prominence(people.boxes, people.scores))
            if index != chosen
        ]
        followed = None if chosen is None else bodies[chosen]
        return FrameLandmarks(followed, (), tuple(others[:MOST_OTHERS]))


def decode_people(outputs: list[npt.NDArray[np.float32]], path: Path) -> People:
    """Decode the output of a YOLO-pose model for one image.

    Parameters
    ----------
    outputs
        One array, ``(1, 56, N)`` candidates or ``(1, N, 57)`` final detections.
    path
        The model's file, for the message.

    Raises
    ------
    ModelError
        When the output has another shape.

    """
    shapes = [output.shape for output in outputs]
    if len(outputs) == 1 and outputs[0].ndim == 3 and len(outputs[0]) == 1:
        values = outputs[0][0].astype(np.float64)
        if len(values) == CANDIDATE:
            return _drop_overlapping(_candidates(values.T))
        if values.shape[1] == DETECTION:
            return _detections(values)
    raise ModelError(
        f"{path} gives {shapes}, needed: (1, {CANDIDATE}, N) or, with suppression inside, (1, N, "
        f"{DETECTION}), a YOLO-pose of COCO's {len(COCO_17)} keypoints; export one with "
        f"`yolo export model=yolo11n-pose.pt format=onnx`"
    )


def _candidates(rows: FloatArray) -> People:
    rows = rows[rows[:, 4] >= LEAST_SCORE]
    centre, half = rows[:, :2], rows[:, 2:4] / 2
    boxes = np.stack([centre - half, centre + half], axis=1)
    return People(boxes, np.clip(rows[:, 4], 0, 1), rows[:, 5:].reshape(-1, len(COCO_17), VALUES))


def _detections(rows: FloatArray) -> People:
    rows = rows[rows[:, 4] >= LEAST_SCORE]
    keypoints = rows[:, 6:].reshape(-1, len(COCO_17), VALUES)
    return People(rows[:, :4].reshape(-1, 2, 2), np.clip(rows[:, 4], 0, 1), keypoints)


def _drop_overlapping(people: People) -> People:
    """Keep the best of overlapping candidates."""
    kept = select_best(people.boxes, people.scores, MOST_OVERLAP)
    return People(people.boxes[kept], people.scores[kept], people.keypoints[kept])


def _body(keypoints: FloatArray, score: float, letterbox: Letterbox) -> Body:
    seen = keypoints[:, 2] >= LEAST_VISIBILITY
    xy = np.full((len(POSE_LANDMARKS), 2), np.nan)
    visibility = np.zeros(len(POSE_LANDMARKS))
    xy[_COLUMNS] = np.where(seen[:, None], letterbox.to_image(keypoints[:, :2]), np.nan)
    visibility[_COLUMNS] = np.where(seen, np.clip(keypoints[:, 2], 0, 1), 0.0)
    return Body(xy, visibility, score)
