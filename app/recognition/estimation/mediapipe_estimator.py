"""MediaPipe estimator: the `mediapipe` library itself, the reference of the parity test."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any, Final

import numpy as np

from app.recognition.errors import EstimatorError
from app.recognition.estimation.estimator import check_image
from app.recognition.estimation.landmark_models.hand_tracker import MOST_HANDS
from app.recognition.models.storage import task_bundle_path
from app.recognition.poses.frame import Body, FrameLandmarks, Hand, Image, Side
from app.recognition.poses.sequence import FloatArray

MILLISECONDS: Final = 1000
"""MediaPipe counts time in whole milliseconds."""


class MediaPipeEstimator:
    """Body and hands by MediaPipe's Tasks library on the processor; a `PoseEstimator`.

    The library contacts a logging host of its maker while it runs, and works without a reply;
    where nothing may leave the machine, use `OnnxPoseEstimator`. It does not return all scores: a
    body's is always 1, a hand's is the probability of its side.

    Parameters
    ----------
    models
        Folder with ``pose_landmarker_full.task`` and ``hand_landmarker.task``; by default the
        one of the installed models.

    Raises
    ------
    EstimatorError
        When `mediapipe` is not installed or does not start here.
    ModelError
        When a model is missing.

    """

    def __init__(self, models: Path | None = None) -> None:
        self._mediapipe = _library()
        self._pose_bundle = task_bundle_path("pose_landmarker_full", models)
        self._hand_bundle = task_bundle_path("hand_landmarker", models)
        self._alone: tuple[Any, Any] | None = None
        self._start()

    def estimate(self, image: Image, time: float) -> FrameLandmarks:
        """Find the body and the hands in `image`, taken `time` seconds after any fixed moment.

        Parameters
        ----------
        image
            ``(height, width, 3)`` RGB, upright; any strides.
        time
            Seconds. MediaPipe refuses repeated milliseconds: a time not after the previous frame's
            is passed as one millisecond later.

        Raises
        ------
        EstimatorError
            When `image` is not an RGB image of 8 bits.

        """
        picture, size = self._take(image)
        stamp = self._next_stamp(time)
        return FrameLandmarks(
            _body(self._pose.detect_for_video(picture, stamp), size),
            _hands(self._hand.detect_for_video(picture, stamp), size),
        )

    def examine(self, image: Image) -> FrameLandmarks:
        """Find body and hands in `image` alone, without effect on the tracking.

        Landmarkers of their own look at it, which are started at the first call.

        Raises
        ------
        EstimatorError
            When `image` is not an RGB image of 8 bits.

        """
        picture, size = self._take(image)
        if self._alone is None:
            self._alone = self._open(self._mediapipe.tasks.vision.RunningMode.IMAGE)
        pose, hand = self._alone
        return FrameLandmarks(_body(pose.detect(picture), size), _hands(hand.detect(picture), size))

    def reset(self) -> None:
        """Reset tracking and smoothing; call it before another clip."""
        self._pose.close()
        self._hand.close()
        self._start()

    def close(self) -> None:
        """Release the models; the estimator cannot be used afterwards."""
        for each in (self._pose, self._hand, *(self._alone or ())):
            each.close()

    def _take(self, image: Image) -> tuple[Any, FloatArray]:
        """Return the library's own image, and its width and height in pixels."""
        check_image(image)
        picture = self._mediapipe.Image(
            image_format=self._mediapipe.ImageFormat.SRGB,
            data=np.ascontiguousarray(image),  # it reads rows back to back, whatever the strides
        )
        return picture, np.array([image.shape[1], image.shape[0]], dtype=np.float64)

    def _start(self) -> None:
        self._pose, self._hand = self._open(self._mediapipe.tasks.vision.RunningMode.VIDEO)
        self._origin: float | None = None
        self._stamp = 0

    def _open(self, mode: Any) -> tuple[Any, Any]:
        """Start a landmarker for bodies and one for hands."""
        vision = self._mediapipe.tasks.vision
        try:
            pose = vision.PoseLandmarkerOptions(
                base_options=self._base_options(self._pose_bundle), running_mode=mode
            )
            hand = vision.HandLandmarkerOptions(
                base_options=self._base_options(self._hand_bundle),
                running_mode=mode,
                num_hands=MOST_HANDS,
            )
            return (
                vision.PoseLandmarker.create_from_options(pose),
                vision.HandLandmarker.create_from_options(hand),
            )
        except (OSError, RuntimeError, ValueError) as error:
            raise EstimatorError(
                f"mediapipe does not start ({error}); on Debian it needs the packages libegl1 and "
                f"libgles2, or use the backend 'onnx'"
            ) from error

    def _base_options(self, bundle: Path) -> Any:
        return self._mediapipe.tasks.BaseOptions(model_asset_path=str(bundle))

    def _next_stamp(self, time: float) -> int:
        """Return milliseconds since the first frame, from 1: MediaPipe's filters fail at 0."""
        if self._origin is None:
            self._origin = time
        elapsed = round((time - self._origin) * MILLISECONDS) + 1
        self._stamp = max(elapsed, self._stamp + 1)
        return self._stamp


def _library() -> Any:
    try:
        return importlib.import_module("mediapipe")
    except (ImportError, OSError) as error:
        raise EstimatorError(
            f"the backend 'mediapipe' cannot be imported ({error}); "
            f"run `pip install 'osg-studio[mediapipe]'` or use the backend 'onnx'"
        ) from error


def _body(result: Any, size: FloatArray) -> Body | None:
    if not result.pose_landmarks:
        return None
    landmarks = result.pose_landmarks[0]
    visibility = np.array([point.visibility for point in landmarks], dtype=np.float64)
    world = np.array(
        [(point.x, point.y, point.z) for point in result.pose_world_landmarks[0]], dtype=np.float64
    )
    return Body(_pixels(landmarks, size), visibility, score=1.0, world=world)


def _hands(result: Any, size: FloatArray) -> tuple[Hand, ...]:
    hands = []
    for landmarks, handedness in zip(result.hand_landmarks, result.handedness, strict=True):
        side: Side = "right" if handedness[0].category_name == "Right" else "left"
        hands.append(Hand(_pixels(landmarks, size), side, float(handedness[0].score)))
    return tuple(sorted(hands, key=lambda hand: -hand.size))


def _pixels(landmarks: Any, size: FloatArray) -> FloatArray:
    return np.array([(point.x, point.y) for point in landmarks], dtype=np.float64) * size
