"""ONNX estimator, the default: MediaPipe's own models on ONNX Runtime."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import Final

from app.recognition.errors import EstimatorError
from app.recognition.estimation.estimator import check_image
from app.recognition.estimation.landmark_models.arms import find_stray_wrist
from app.recognition.estimation.landmark_models.body import BodyTracker
from app.recognition.estimation.landmark_models.body_model import POSE_SIGNATURE, BodyModel
from app.recognition.estimation.landmark_models.detector import PALM_LAYOUT, PERSON_LAYOUT, Detector
from app.recognition.estimation.landmark_models.hand_finder import HandFinder
from app.recognition.estimation.landmark_models.hand_model import HAND_SIGNATURE, HandModel
from app.recognition.estimation.landmark_models.hand_tracker import (
    HandSearch,
    HandTracker,
)
from app.recognition.estimation.landmark_models.onnx_session import (
    ModelSession,
    Provider,
    Signature,
    check_provider,
)
from app.recognition.models.storage import ModelName, finder_path, gloves_path, model_path
from app.recognition.poses.frame import FrameLandmarks, Image

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
        HandModel(model, open_taught(gloves, HAND_SIGNATURE) if gloves else None),
        search,
        HandFinder(Detector(open_taught(finder, PALM_LAYOUT.signature), PALM_LAYOUT))
        if finder
        else None,
    )


def _session(
    models: Path | None, threads: int, provider: Provider, name: ModelName, signature: Signature
) -> ModelSession:
    return ModelSession(model_path(name, models), signature, threads=threads, provider=provider)
