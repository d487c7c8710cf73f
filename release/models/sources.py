"""Sources of the models: the pinned wheel of MediaPipe, and what is made of its files."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from app.recognition.models.storage import ModelName, TaskBundleName


@dataclass(frozen=True)
class Wheel:
    """A pinned Python wheel.

    Attributes
    ----------
    requirement
        Name and version.
    sha256
        Of the wheel file.
    platform, python, abi, implementation
        Tags of this one file, the same on every machine: the wheel is only read, never
        installed, so that one file and one hash serve all systems.

    """

    requirement: str
    sha256: str
    platform: str
    python: str
    abi: str
    implementation: str


WHEEL: Final = Wheel(
    requirement="mediapipe==0.10.21",
    sha256="956eb1ebc275c629e61b085b2cab89c3a5b9e93bad1bb107348d98dafb5a4bb5",
    platform="manylinux_2_28_x86_64",
    python="3.12",
    abi="cp312",
    implementation="cp",
)
"""A release of MediaPipe whose wheel contains the models; that of 1.2.2 contains none."""

SOURCES: Final[dict[ModelName, str]] = {
    "pose_detection": "mediapipe/modules/pose_detection/pose_detection.tflite",
    "pose_landmark_full": "mediapipe/modules/pose_landmark/pose_landmark_full.tflite",
    "palm_detection_full": "mediapipe/modules/palm_detection/palm_detection_full.tflite",
    "hand_landmark_full": "mediapipe/modules/hand_landmark/hand_landmark_full.tflite",
}
"""TensorFlow Lite files in the wheel that the ONNX models are made from."""

UNUSED_OUTPUTS: Final[dict[ModelName, tuple[str, ...]]] = {"pose_landmark_full": ("Identity_2",)}
"""Outputs left out of the ONNX models: the pose model's segmentation mask is not used here and
takes half of its time."""

MODEL_SCHEMA_SOURCE: Final = "mediapipe/tasks/metadata/schema_py_generated.py"
"""Python module in the wheel that reads and writes TensorFlow Lite models."""

METADATA_SCHEMA_SOURCE: Final = "mediapipe/tasks/metadata/metadata_schema_py_generated.py"
"""Python module in the wheel that writes the description of a model's input."""

LICENSE_SOURCE: Final = "mediapipe-0.10.21.dist-info/LICENSE"
"""In the wheel: MediaPipe's licence."""

BUNDLE_PARTS: Final[dict[TaskBundleName, dict[str, ModelName]]] = {
    "pose_landmarker_full": {
        "pose_detector.tflite": "pose_detection",
        "pose_landmarks_detector.tflite": "pose_landmark_full",
    },
    "hand_landmarker": {
        "hand_detector.tflite": "palm_detection_full",
        "hand_landmarks_detector.tflite": "hand_landmark_full",
    },
}
"""The models in each bundle, by the file names that the Tasks interface looks for."""


def credit(name: ModelName) -> str:
    """Return the origin, licence and change of a model (Apache-2.0, section 4b), for its file."""
    return (
        f"{SOURCES[name].rpartition('/')[2]} of {WHEEL.requirement}, Copyright Google LLC, "
        f"Apache-2.0; converted from TensorFlow Lite to ONNX by OSG Studio."
    )
