"""An estimator by the name of its backend."""

from __future__ import annotations

from typing import Literal, get_args

from app.recognition.errors import EstimatorError
from app.recognition.estimation.base import PoseEstimator
from app.recognition.estimation.mediapipe_estimator import MediaPipeEstimator
from app.recognition.estimation.onnx_estimator import DEFAULT_THREADS, OnnxPoseEstimator
from app.recognition.estimation.session import Provider

Backend = Literal["onnx", "mediapipe"]
"""MediaPipe's models on ONNX Runtime, or the `mediapipe` library."""


def create_estimator(
    backend: Backend = "onnx", *, threads: int = DEFAULT_THREADS, provider: Provider = "cpu"
) -> PoseEstimator:
    """Return a new estimator with the installed models.

    Parameters
    ----------
    backend
        ``"onnx"``, or ``"mediapipe"`` where that library is installed.
    threads, provider
        How ONNX Runtime runs the models; the library `mediapipe` chooses for itself.

    Raises
    ------
    EstimatorError
        When the backend or the provider is unknown or not available here.
    ModelError
        When a model file is missing or damaged.

    """
    if backend == "onnx":
        return OnnxPoseEstimator(threads=threads, provider=provider)
    if backend == "mediapipe":
        return MediaPipeEstimator()
    known = ", ".join(get_args(Backend))
    raise EstimatorError(f"unknown backend {backend!r}; there are: {known}")
