"""Model catalogue: each installed file, its source and the SHA-256 it must have."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

ModelName = Literal[
    "pose_detection", "pose_landmark_full", "palm_detection_full", "hand_landmark_full"
]
"""The ONNX models, by MediaPipe's own names."""

TaskBundleName = Literal["pose_landmarker_full", "hand_landmarker"]
"""The bundles for MediaPipe's Tasks interface, by the names MediaPipe publishes them under."""


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


@dataclass(frozen=True)
class InstalledFile:
    """A file of the models folder.

    Attributes
    ----------
    name
        Identifier of the model or bundle.
    filename
        Its name in the models folder.
    sha256
        Expected hash of its content.

    """

    name: str
    filename: str
    sha256: str


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

MODELS: Final[dict[ModelName, InstalledFile]] = {
    "pose_detection": InstalledFile(
        "pose_detection",
        "pose_detection.onnx",
        "20d7377dfe4e13cf618c97520f89781acffc07ec9fb16fed8f5f4458a647e966",
    ),
    "pose_landmark_full": InstalledFile(
        "pose_landmark_full",
        "pose_landmark_full.onnx",
        "6a7a75360ccb2e719dfdfbedd8dd112bea39fff4b95a8d4e1f4fc94fecf74c08",
    ),
    "palm_detection_full": InstalledFile(
        "palm_detection_full",
        "palm_detection_full.onnx",
        "ed7bffc1721aa5dbcb67b11b735437c3972258031000f798ba8060e264c70fbd",
    ),
    "hand_landmark_full": InstalledFile(
        "hand_landmark_full",
        "hand_landmark_full.onnx",
        "de8028c2509e24b5767e210b3ca30f883051621ee5e68587d228bca3462782b5",
    ),
}
"""The ONNX models; conversion is deterministic, so its results are pinned like its sources."""

TASK_BUNDLES: Final[dict[TaskBundleName, InstalledFile]] = {
    "pose_landmarker_full": InstalledFile(
        "pose_landmarker_full",
        "pose_landmarker_full.task",
        "3c82c60bbe5fd58bdfb060737d7efed3cc64a2e5efd2292f6cdf08a7ccd51d7c",
    ),
    "hand_landmarker": InstalledFile(
        "hand_landmarker",
        "hand_landmarker.task",
        "6bbbde8c9ceef075c7daa9ccca97dcc45396ba44eaa19eea243e9ea0d2904ccc",
    ),
}
"""The bundles, as reproducible as the models."""

LICENSE: Final = InstalledFile(
    "license",
    "LICENSE.mediapipe.txt",
    "8707eef0533987efc5b155d64761eeb6e20793f50b9bd1a68dad1cf4719d0ed8",
)
"""MediaPipe's licence, distributed with the models (Apache-2.0, section 4a)."""

INSTALLED_FILES: Final[tuple[InstalledFile, ...]] = (
    *MODELS.values(),
    *TASK_BUNDLES.values(),
    LICENSE,
)
"""All files of a complete installation."""


def credit(name: ModelName) -> str:
    """Return the origin, licence and change of a model (Apache-2.0, section 4b), for its file."""
    return (
        f"{SOURCES[name].rpartition('/')[2]} of {WHEEL.requirement}, Copyright Google LLC, "
        f"Apache-2.0; converted from TensorFlow Lite to ONNX by OSG Studio."
    )
