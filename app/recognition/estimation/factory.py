"""Estimator factory: the pose estimators, and the function that creates one by its backend's name.

`OnnxPoseEstimator`, the default, runs MediaPipe's own models on ONNX Runtime. `ComposedEstimator`
takes separate models for body and hands, such as a `BodyFinder` and `TrackedHands`.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Final, Literal, Protocol, get_args, runtime_checkable

from app.recognition.errors import EstimatorError
from app.recognition.estimation.estimator import PoseEstimator, check_image
from app.recognition.estimation.landmark_models.arms import find_stray_wrist
from app.recognition.estimation.landmark_models.body import BodyTracker
from app.recognition.estimation.landmark_models.body_model import POSE_SIGNATURE, BodyModel
from app.recognition.estimation.landmark_models.detector import PALM_LAYOUT, PERSON_LAYOUT, Detector
from app.recognition.estimation.landmark_models.diver_hands import DiverHands
from app.recognition.estimation.landmark_models.hand_model import (
    GLOVED_SIGNATURE,
    HAND_SIGNATURE,
    HandFinder,
    HandModel,
)
from app.recognition.estimation.landmark_models.hand_tracker import HandSearch, HandTracker
from app.recognition.estimation.landmark_models.onnx_session import (
    ModelSession,
    Provider,
    Signature,
    check_provider,
)
from app.recognition.estimation.mediapipe_estimator import MediaPipeEstimator
from app.recognition.estimation.yolo_pose import YoloPose
from app.recognition.models.storage import ModelName, finder_path, gloves_path, model_path
from app.recognition.poses.frame import Body, FrameLandmarks, Hand, Image
from app.recognition.poses.landmarks import POSE_LANDMARKS

DEFAULT_THREADS: Final = 2
"""One thread for the body and one for the hands, which run in parallel. Two threads within each
model save at most a third of the time, threads beyond the machine's cores nothing.
"""


class OnnxPoseEstimator:
    """Bodies and hands from images, tracked from frame to frame; a `PoseEstimator`.

    Parameters
    ----------
    models
        Folder with the ONNX files; by default the verified ones of the user's data folder.
    threads
        Processor threads in all. With one, everything runs in the caller's thread; from two on,
        body and hands run side by side, each with its half of the threads. The result is the
        same.
    provider
        ``"cpu"``, or ``"cuda"``, ``"tensorrt"``, ``"coreml"`` where ONNX Runtime has them.
    hands
        ``"pose"`` searches hands at the ends of the arms, and every few frames in the whole frame;
        ``"palm"`` only in the whole frame, and bodies only where the person detector finds them, as
        MediaPipe's landmarkers do.

    Raises
    ------
    ModelError
        When a model file is missing, damaged or not the expected one.
    EstimatorError
        When the provider is not available here, or `threads` is less than one.

    """

    def __init__(
        self,
        models: Path | None = None,
        *,
        threads: int = DEFAULT_THREADS,
        provider: Provider = "cpu",
        hands: HandSearch = "pose",
    ) -> None:
        if threads < 1:
            raise EstimatorError(f"threads is {threads}; at least one is needed")
        check_provider(provider)

        share = max(1, threads // 2)
        self._body = body_tracker(
            models, threads=share, provider=provider, searches=hands == "pose"
        )
        self._hands = hand_tracker(models, search=hands, threads=share, provider=provider)
        self._helper = ThreadPoolExecutor(1, "hands") if threads > 1 else None

    def estimate(self, image: Image, time: float) -> FrameLandmarks:
        """Find bodies and hands in `image`, taken `time` seconds after any fixed moment.

        Parameters
        ----------
        image
            ``(height, width, 3)`` RGB, upright; any size from 1 x 1 on and any strides.
        time
            Seconds. A time not after the previous frame's restarts the smoothing.

        Raises
        ------
        EstimatorError
            When `image` is not an RGB image of 8 bits.

        """
        check_image(image)
        if self._helper is None:
            found, followed = self._body.track(image, time), self._hands.follow(image, time)
        else:
            following = self._helper.submit(self._hands.follow, image, time)
            found = self._body.track(image, time)
            followed = following.result()
        seen = self._hands.complete(image, followed, found.bodies, time)
        self._body.seek(find_stray_wrist(seen.hands, seen.bodies))
        return seen

    def examine(self, image: Image) -> FrameLandmarks:
        """Find body and hands in `image` alone, without effect on the tracking.

        Raises
        ------
        EstimatorError
            When `image` is not an RGB image of 8 bits.

        """
        check_image(image)
        return self._hands.examine(image, self._body.examine(image).bodies)

    def adopt(self, image: Image) -> FrameLandmarks:
        """Return the last frame with what a search in it finds, and follow that from now on."""
        return self._hands.adopt(image)

    def spare(self, *, spares: bool) -> None:
        """Look at hands that move or hang once a second, on a machine too slow for its camera."""
        self._hands.spare(spares=spares)

    def reset(self) -> None:
        """Reset tracking and smoothing; call it before another clip."""
        self._body.reset()
        self._hands.reset()

    def close(self) -> None:
        """Release the models; the estimator cannot be used afterwards."""
        if self._helper is not None:
            self._helper.shutdown()
        del self._body, self._hands


def body_tracker(
    models: Path | None = None, *, threads: int, provider: Provider, searches: bool = True
) -> BodyTracker:
    """Load MediaPipe's body models; see `OnnxPoseEstimator` and `BodyTracker`."""
    load = partial(_session, models, threads, provider)
    persons = Detector(load("pose_detection", PERSON_LAYOUT.signature), PERSON_LAYOUT)
    return BodyTracker(
        persons, BodyModel(load("pose_landmark_full", POSE_SIGNATURE)), searches=searches
    )


def hand_tracker(
    models: Path | None = None, *, search: HandSearch, threads: int, provider: Provider
) -> HandTracker:
    """Load MediaPipe's hand models; see `OnnxPoseEstimator` for parameters and errors."""
    load = partial(_session, models, threads, provider)
    palms = Detector(load("palm_detection_full", PALM_LAYOUT.signature), PALM_LAYOUT)
    model = load("hand_landmark_full", HAND_SIGNATURE)
    open_taught = partial(ModelSession, threads=threads, provider=provider)
    finder, gloves = (finder_path(), gloves_path()) if search == "pose" else (None, None)
    return HandTracker(
        palms,
        HandModel(model, open_taught(gloves, GLOVED_SIGNATURE) if gloves else None),
        search,
        HandFinder(Detector(open_taught(finder, PALM_LAYOUT.signature), PALM_LAYOUT))
        if finder
        else None,
    )


def _session(
    models: Path | None, threads: int, provider: Provider, name: ModelName, signature: Signature
) -> ModelSession:
    return ModelSession(model_path(name, models), signature, threads=threads, provider=provider)


class BodyFinder(Protocol):
    """Finds bodies in the frames of one clip, in order, and follows one of them."""

    def track(self, image: Image, time: float) -> FrameLandmarks:
        """Return the bodies in `image`, taken at `time` seconds, without hands."""

    def examine(self, image: Image) -> FrameLandmarks:
        """Return the body in `image` alone, without effect on the tracking."""

    def reset(self) -> None:
        """Reset the tracking, before another clip."""


class TrackedHands:
    """MediaPipe's hand models for use with another body model.

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
        self, body: BodyFinder, hands: TrackedHands | DiverHands | None, landmarks: tuple[str, ...]
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
    tracked = body_tracker(threads=threads, provider=provider)
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
) -> TrackedHands | DiverHands | None:
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
