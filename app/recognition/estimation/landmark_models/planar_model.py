"""Planar model: a user's ONNX model that takes colour planes, loaded once and run per frame.

MediaPipe's pinned models use `onnx_session`. A wrong file is the usual mistake here, so errors
state the shape found and the shape needed.

Letterbox: fits an image into a model's input without distortion, with bars at the sides.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import cv2
import numpy as np
import numpy.typing as npt

from app.recognition.errors import ModelError
from app.recognition.estimation.landmark_models.onnx_session import (
    Provider,
    check_provider,
    open_session,
)
from app.recognition.poses.frame import Image
from app.recognition.poses.sequence import FloatArray

BAR: Final = (114, 114, 114)
"""The grey of the bars, as in the training of YOLO models."""


@dataclass(frozen=True)
class Letterbox:
    """Position of an image in a model's input.

    Attributes
    ----------
    width, height
        Pixels of the input that the image fills, at least one each.
    left, top
        Pixels of the bars before it.
    image_size
        Width and height of the image in pixels.
    input_size
        Width and height of the input in pixels.

    """

    width: int
    height: int
    left: int
    top: int
    image_size: tuple[int, int]
    input_size: tuple[int, int]

    @classmethod
    def fitting(cls, image_size: tuple[int, int], input_size: tuple[int, int]) -> Letterbox:
        """Centre an image in an input, as large as it goes; sizes are width and height."""
        scale = min(room / side for room, side in zip(input_size, image_size, strict=True))
        width, height = (
            min(room, max(1, round(side * scale)))
            for room, side in zip(input_size, image_size, strict=True)
        )
        left, top = (input_size[0] - width) // 2, (input_size[1] - height) // 2
        return cls(width, height, left, top, image_size, input_size)

    def apply(self, image: Image) -> npt.NDArray[np.uint8]:
        """Return the input ``(height, width, 3)`` for an image of `image_size`."""
        resized = cv2.resize(image, (self.width, self.height), interpolation=cv2.INTER_LINEAR)
        below = self.input_size[1] - self.height - self.top
        beside = self.input_size[0] - self.width - self.left
        filled = cv2.copyMakeBorder(
            resized, self.top, below, self.left, beside, cv2.BORDER_CONSTANT, value=BAR
        )
        return np.asarray(filled, dtype=np.uint8)

    def to_image(self, points: npt.NDArray[np.floating]) -> FloatArray:
        """Map ``(..., 2)`` pixels of the input to pixels of the image; (0, 0) is a corner."""
        return np.asarray((points - np.array([self.left, self.top])) / self._scale)

    @property
    def _scale(self) -> FloatArray:
        """Pixels of the input per pixel of the image, across and down: they differ by rounding."""
        filled = np.array([self.width, self.height], dtype=np.float64)
        return np.asarray(filled / np.array(self.image_size))


TYPES: Final = {"tensor(float)": np.float32, "tensor(float16)": np.float16}
"""Input types of exported models: single or half precision."""


class PlanarModel:
    """An ONNX model that takes one image as ``(1, 3, height, width)``.

    Parameters
    ----------
    path
        The user's model file.
    purpose
        The expected kind of file, for messages: ``"a YOLO-pose export"``.
    side
        Pixels of the input where the file leaves them open (dynamic axes).
    threads, provider
        As in `session.ModelSession`.

    Attributes
    ----------
    path
        See above.
    input_size
        Width and height of the image it takes, pixels.

    Raises
    ------
    ModelError
        When the file is missing, damaged, or takes another input.
    EstimatorError
        When the provider is not available here.

    """

    def __init__(
        self, path: Path, purpose: str, *, side: int, threads: int, provider: Provider
    ) -> None:
        check_provider(provider)
        self.path = path
        needed = f"{purpose} is needed"
        if not path.is_file():
            raise ModelError(f"no model file {path}; {needed}")
        self._session = open_session(path, threads, provider, remedy=needed)
        inputs = self._session.get_inputs()
        shape = tuple(inputs[0].shape) if len(inputs) == 1 else ()
        if len(shape) != 4 or inputs[0].type not in TYPES or not _takes_planes(shape):
            raise ModelError(
                f"{path} takes {[(tuple(one.shape), one.type) for one in inputs]}, needed: one "
                f"image (1, 3, height, width) of tensor(float); {needed}"
            )
        self._name, self._type = inputs[0].name, TYPES[inputs[0].type]
        height, width = (extent if isinstance(extent, int) else side for extent in shape[2:])
        self.input_size = (width, height)

    def run(self, planes: npt.NDArray[np.floating]) -> list[npt.NDArray[np.float32]]:
        """Run the model.

        Parameters
        ----------
        planes
            ``(3, height, width)`` in the model's own scale.

        Returns
        -------
        Its outputs in the file's order.

        """
        tensor = np.ascontiguousarray(planes[None], dtype=self._type)
        outputs: list[Any] = self._session.run(None, {self._name: tensor})
        return [np.asarray(output, dtype=np.float32) for output in outputs]

    def blank(self) -> list[npt.NDArray[np.float32]]:
        """Run the model on black: with dynamic axes, only a run shows the output's shape."""
        width, height = self.input_size
        return self.run(np.zeros((3, height, width), np.float32))


def _takes_planes(shape: tuple[int | str | None, ...]) -> bool:
    """Return whether an input takes three planes, in a batch of one or of open size."""
    return shape[1] == 3 and (shape[0] == 1 or not isinstance(shape[0], int))
