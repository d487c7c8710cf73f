"""Estimator factory: creates an estimator by the name of its backend.

Composed estimator: a pose estimator of separate models for body and hands.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final, Literal, Protocol, get_args, runtime_checkable

from app.recognition.errors import EstimatorError
from app.recognition.estimation.estimator import PoseEstimator, check_image
from app.recognition.estimation.landmark_models.diver_hands import DiverHands
from app.recognition.estimation.landmark_models.hand_tracker import HandSearch, HandTracker
from app.recognition.estimation.landmark_models.onnx_session import Provider, check_provider
from app.recognition.estimation.mediapipe_estimator import MediaPipeEstimator
from app.recognition.estimation.onnx_estimator import (
    DEFAULT_THREADS,
    OnnxPoseEstimator,
    body_tracker,
    hand_tracker,
)
from app.recognition.estimation.yolo_pose import YoloPose
from app.recognition.poses.frame import Body, FrameLandmarks, Hand, Image
from app.recognition.poses.landmarks import POSE_LANDMARKS


class BodyFinder(Protocol):
    """Finds bodies in the frames of one clip, in order, and follows one of them."""

    def track(self, image: Image, time: float) -> FrameLandmarks:
        """Return the bodies in `image`, taken at `time` seconds, without hands."""

    def examine(self, image: Image) -> FrameLandmarks:
        """Return the body in `image` alone, without effect on the tracking."""

    def reset(self) -> None:
        """Reset the tracking, before another clip."""


class HandFinder(Protocol):
    """Finds the hands in the same frames."""

    def find(self, image: Image, bodies: Sequence[Body]) -> tuple[Hand, ...]:
        """Return up to two hands a person in `image`, larger first, given the bodies in it."""

    def examine(self, image: Image, bodies: Sequence[Body]) -> tuple[Hand, ...]:
        """Return those in `image` alone, without effect on the tracking."""

    def reset(self) -> None:
        """Reset the tracking, before another clip."""


class TrackedHands:
    """MediaPipe's hand models for use with another body model; a `HandFinder`.

    Parameters
    ----------
    tracker
        Its ``search`` should be ``"palm"`` where the body has no finger landmarks, which
        ``"pose"`` needs.

    """

    def __init__(self, tracker: HandTracker) -> None:
        self._tracker = tracker

    def find(self, image: Image, bodies: Sequence[Body]) -> tuple[Hand, ...]:
        """Return up to two hands a person in `image`, larger first."""
        return self._tracker.complete(image, self._tracker.follow(image), bodies).hands

    def examine(self, image: Image, bodies: Sequence[Body]) -> tuple[Hand, ...]:
        """Return up to two hands a person in `image` alone; tracking is left as it is."""
        return TrackedHands(self._tracker.renew()).find(image, bodies)

    def reset(self) -> None:
        """Reset the tracking."""
        self._tracker.reset()


class ComposedEstimator:
    """Pose estimator of one model for the body and another for the hands.

    Parameters
    ----------
    body
        Finds the bodies.
    hands
        Finds the hands; None: no hands, hence no salutes.
    landmarks
        Names of the landmarks that the body can have.

    """

    def __init__(
        self, body: BodyFinder, hands: HandFinder | None, landmarks: tuple[str, ...]
    ) -> None:
        self._body, self._hands = body, hands
        self.landmarks = landmarks
        self.finds_hands = hands is not None

    def estimate(self, image: Image, time: float) -> FrameLandmarks:
        """Find bodies and hands in `image`, taken `time` seconds after any fixed moment.

        Raises
        ------
        EstimatorError
            When `image` is not an RGB image of 8 bits.

        """
        found = self._body.track(image, time)
        hands = self._hands.find(image, found.bodies) if self._hands else ()
        return replace(found, hands=hands)

    def examine(self, image: Image) -> FrameLandmarks:
        """Find body and hands in `image` alone, without effect on the tracking.

        Raises
        ------
        EstimatorError
            When `image` is not an RGB image of 8 bits.

        """
        check_image(image)
        found = self._body.examine(image)
        hands = self._hands.examine(image, found.bodies) if self._hands else ()
        return replace(found, hands=hands)

    def reset(self) -> None:
        """Reset the tracking; call it before another clip."""
        self._body.reset()
        if self._hands:
            self._hands.reset()

    def close(self) -> None:
        """Release the models; the estimator cannot be used afterwards."""
        del self._body, self._hands


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
