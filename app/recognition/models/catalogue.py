"""Model catalogue: the model files and the SHA-256 that each must have."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal, TypeVar

ModelName = Literal[
    "pose_detection", "pose_landmark_full", "palm_detection_full", "hand_landmark_full"
]
"""The ONNX models, by MediaPipe's own names."""

TaskBundleName = Literal["pose_landmarker_full", "hand_landmarker"]
"""The bundles for MediaPipe's Tasks interface, by the names MediaPipe publishes them under."""


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


Name = TypeVar("Name", bound=str)


def _name_files(ending: str, hashes: dict[Name, str]) -> dict[Name, InstalledFile]:
    return {name: InstalledFile(name, name + ending, sha256) for name, sha256 in hashes.items()}


MODELS: Final[dict[ModelName, InstalledFile]] = _name_files(
    ".onnx",
    {
        "pose_detection": "20d7377dfe4e13cf618c97520f89781acffc07ec9fb16fed8f5f4458a647e966",
        "pose_landmark_full": "6a7a75360ccb2e719dfdfbedd8dd112bea39fff4b95a8d4e1f4fc94fecf74c08",
        "palm_detection_full": "ed7bffc1721aa5dbcb67b11b735437c3972258031000f798ba8060e264c70fbd",
        "hand_landmark_full": "de8028c2509e24b5767e210b3ca30f883051621ee5e68587d228bca3462782b5",
    },
)
"""The ONNX models, part of every release; their conversion is deterministic (`release.models`)."""

HAND_FINDER: Final = InstalledFile(
    "hand_finder",
    "hand_finder.onnx",
    "126da0610476325158fd61b48d980d7a5fad6d6e59db75a3557540b14df0d09d",
)
"""The finder of divers' hands, part of the package itself; its card lies beside it."""

GLOVED_HANDS: Final = InstalledFile(
    "hand_landmark_gloved",
    "hand_landmark_gloved.onnx",
    "5c8a7e31c422f48d5ab0d476bf657d7fb18708feeeb8eb60d723f9800bfebd59",
)
"""The landmark model of gloved hands, in the same way."""

TAUGHT_FILES: Final = (HAND_FINDER, GLOVED_HANDS)
"""What the project has taught itself."""

TASK_BUNDLES: Final[dict[TaskBundleName, InstalledFile]] = _name_files(
    ".task",
    {
        "pose_landmarker_full": "3c82c60bbe5fd58bdfb060737d7efed3cc64a2e5efd2292f6cdf08a7ccd51d7c",
        "hand_landmarker": "6bbbde8c9ceef075c7daa9ccca97dcc45396ba44eaa19eea243e9ea0d2904ccc",
    },
)
"""The bundles, as reproducible; for MediaPipe's own library, beside the wheel in a release."""

LICENSE: Final = InstalledFile(
    "license",
    "LICENSE.mediapipe.txt",
    "8707eef0533987efc5b155d64761eeb6e20793f50b9bd1a68dad1cf4719d0ed8",
)
"""MediaPipe's licence, distributed with the models (Apache-2.0, section 4a)."""

PACKAGED_FILES: Final[tuple[InstalledFile, ...]] = (*MODELS.values(), LICENSE)
"""The files that a wheel carries."""

INSTALLED_FILES: Final[tuple[InstalledFile, ...]] = (*PACKAGED_FILES, *TASK_BUNDLES.values())
"""All files of a models folder."""
