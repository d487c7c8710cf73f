"""Estimator factory: creates an estimator by the name of its backend."""

from __future__ import annotations

from pathlib import Path
from typing import Final, Literal, Protocol, get_args, runtime_checkable

from app.recognition.errors import EstimatorError
from app.recognition.estimation.composed_estimator import (
    BodyFinder,
    ComposedEstimator,
    HandFinder,
    TrackedHands,
)
from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.landmark_models.diver_hands import DiverHands
from app.recognition.estimation.landmark_models.hand_tracker import HandSearch
from app.recognition.estimation.landmark_models.onnx_session import Provider, check_provider
from app.recognition.estimation.mediapipe_estimator import MediaPipeEstimator
from app.recognition.estimation.onnx_estimator import (
    DEFAULT_THREADS,
    OnnxPoseEstimator,
    body_tracker,
    hand_tracker,
)
from app.recognition.estimation.yolo_pose import YoloPose
from app.recognition.poses.landmarks import POSE_LANDMARKS

Backend = Literal["onnx", "mediapipe"]
"""MediaPipe's models on ONNX Runtime, or the `mediapipe` library."""

YOLO_POSE: Final = "yolo-pose"
"""Backend name before a colon and the user's own model file: an Ultralytics export on ONNX
Runtime."""

MEDIAPIPE_HANDS: Final = "mediapipe"
NO_HANDS: Final = "none"
"""Names of hand models. A third choice is the paper's pair ``DETECTOR.onnx,KEYPOINTS.onnx``."""


def create_estimator(
    backend: str = "onnx",
    *,
    hands: str = MEDIAPIPE_HANDS,
    threads: int = DEFAULT_THREADS,
    provider: Provider = "cpu",
) -> PoseEstimator:
    """Return a new estimator with the installed models, or with the user's own.

    Parameters
    ----------
    backend
        ``"onnx"``; ``"mediapipe"`` where that library is installed; or ``"yolo-pose:FILE.onnx"``,
        an Ultralytics YOLO-pose export of COCO's 17 keypoints.
    hands
        ``"mediapipe"``: the installed hand models; ``"none"``: no hands, hence no salutes; or
        ``"DETECTOR.onnx,KEYPOINTS.onnx"``, the paper's pair (`diver_hands`).
    threads, provider
        Settings of ONNX Runtime; the library `mediapipe` ignores them.

    Raises
    ------
    EstimatorError
        When the backend or the provider is unknown or not available here.
    ModelError
        When a model file is missing or damaged, or is another model than expected.

    """
    if threads < 1:
        raise EstimatorError(f"threads is {threads}; at least one is needed")
    check_provider(provider)
    name, _, file = backend.partition(":")
    if name == YOLO_POSE:
        body = YoloPose(_yolo_file(file), threads=threads, provider=provider)
        finder = _hand_finder(hands, "palm", threads, provider)
        return ComposedEstimator(body, finder, body.landmarks)
    if backend not in get_args(Backend):
        known = ", ".join((*get_args(Backend), f"{YOLO_POSE}:FILE.onnx"))
        raise EstimatorError(f"unknown backend {backend!r}; there are: {known}")
    if hands == MEDIAPIPE_HANDS:
        if backend == "mediapipe":
            return MediaPipeEstimator()
        return OnnxPoseEstimator(threads=threads, provider=provider)
    if backend == "mediapipe":
        raise EstimatorError(
            f"the library mediapipe finds the hands itself, got hands {hands!r}; use the backend "
            f"'onnx' with other hands"
        )
    tracked: BodyFinder = body_tracker(threads=threads, provider=provider)
    return ComposedEstimator(
        tracked, _hand_finder(hands, "pose", threads, provider), POSE_LANDMARKS
    )


@runtime_checkable
class _Limited(Protocol):
    """Interface of estimators that find only some landmarks, or no hands."""

    landmarks: tuple[str, ...]
    finds_hands: bool


def list_landmarks(estimator: PoseEstimator) -> tuple[str, ...]:
    """Return the landmarks that an estimator can find, by default all of `POSE_LANDMARKS`.

    The others are NaN in every `Body` it gives.
    """
    return estimator.landmarks if isinstance(estimator, _Limited) else POSE_LANDMARKS


def finds_hands(estimator: PoseEstimator) -> bool:
    """Return whether an estimator finds hands, which salutes need."""
    return estimator.finds_hands if isinstance(estimator, _Limited) else True


def _yolo_file(file: str) -> Path:
    if not file:
        raise EstimatorError(
            f"{YOLO_POSE} needs its model file, as in {YOLO_POSE}:yolo11n-pose.onnx; export it "
            f"with `yolo export model=yolo11n-pose.pt format=onnx`"
        )
    return Path(file)


def _hand_finder(
    hands: str, search: HandSearch, threads: int, provider: Provider
) -> HandFinder | None:
    if hands == NO_HANDS:
        return None
    if hands == MEDIAPIPE_HANDS:
        return TrackedHands(hand_tracker(search=search, threads=threads, provider=provider))
    detector, comma, keypoints = hands.partition(",")
    if not comma or not detector or not keypoints:
        raise EstimatorError(
            f"unknown hands {hands!r}; there are: {MEDIAPIPE_HANDS}, {NO_HANDS}, and the paper's "
            f"pair as DETECTOR.onnx,KEYPOINTS.onnx"
        )
    return DiverHands(Path(detector), Path(keypoints), threads=threads, provider=provider)
