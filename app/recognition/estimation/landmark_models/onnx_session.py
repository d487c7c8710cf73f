"""ONNX sessions: models that are loaded once, checked by their shapes, and run per frame.

`ModelSession` runs MediaPipe's pinned models on square crops. `PlanarModel` runs a user's own model
that takes colour planes; there a wrong file is the usual mistake, so errors state the shape found
and the shape needed. `Letterbox` fits an image into its input without distortion, with bars at the
sides.

ONNX Runtime is imported with the first model: it starts a thread, and a process with threads must
not fork, as the studio's does for its workers.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal, TypeAlias, get_args

import cv2
import numpy as np
import numpy.typing as npt

from app.recognition.errors import EstimatorError, ModelError
from app.recognition.poses.frame import Image
from app.recognition.poses.sequence import FloatArray

Provider = Literal["cpu", "cuda", "tensorrt", "coreml"]
"""Execution provider of the models: the processor, or an accelerator with the processor as its
fallback."""

Tensor: TypeAlias = npt.NDArray[np.float32]

_RUNTIME_NAMES: Final[dict[Provider, tuple[str, ...]]] = {
    "cpu": ("CPUExecutionProvider",),
    "cuda": ("CUDAExecutionProvider", "CPUExecutionProvider"),
    "tensorrt": (
        "TensorrtExecutionProvider",
        "CUDAExecutionProvider",
        "CPUExecutionProvider",
    ),
    "coreml": ("CoreMLExecutionProvider", "CPUExecutionProvider"),
}
"""ONNX Runtime's names, first choice first; what the first cannot run falls to the next."""

ONLY_FATAL: Final = 4
"""ONNX Runtime's log level; other messages repeat the raised errors."""


@dataclass(frozen=True)
class Signature:
    """The input and output shapes that identify a model file.

    Attributes
    ----------
    input_size
        Side in pixels of the square RGB image the model takes, as ``(1, side, side, 3)``.
    outputs
        Shapes of the outputs wanted, in the order in which `ModelSession.run` gives them.
        Outputs of equal shape are taken in the file's order.

    """

    input_size: int
    outputs: tuple[tuple[int, ...], ...]


class ModelSession:
    """An ONNX model, ready to run on square crops.

    Parameters
    ----------
    path
        The model file.
    signature
        The shapes that the file must have.
    threads
        Processor threads within one run of the model.
    provider
        The execution provider.

    Raises
    ------
    ModelError
        When the file is missing, damaged, or another model than the one expected.
    EstimatorError
        When the provider is not available here; the message lists what is.

    """

    def __init__(
        self, path: Path, signature: Signature, *, threads: int, provider: Provider
    ) -> None:
        check_provider(provider)
        if not path.is_file():
            raise ModelError(f"no model file {path}; run `osg-studio models install`")
        self.input_size = signature.input_size
        self._session = open_session(
            path, threads, provider, remedy="run `osg-studio models install`"
        )
        self._input, self._outputs = _match_signature(path, self._session, signature)
        self._pixels = np.empty((self.input_size, self.input_size, 3), np.uint8)
        self._tensor = np.empty((1, self.input_size, self.input_size, 3), np.float32)

    @property
    def pixels(self) -> npt.NDArray[np.uint8]:
        """The ``(side, side, 3)`` buffer to write the next crop into."""
        return self._pixels

    def run(self, lowest: float = 0.0) -> list[Tensor]:
        """Run the model on `pixels`, scaled from `lowest` to 1.

        Returns
        -------
        The outputs of the signature, in its order.

        """
        tensor = self._tensor
        np.multiply(self._pixels, np.float32((1 - lowest) / 255), out=tensor[0])
        if lowest:
            tensor += np.float32(lowest)
        outputs: list[Tensor] = self._session.run(self._outputs, {self._input: tensor})
        return outputs


def check_provider(provider: str) -> None:
    """Check that a provider exists and that this installation can use it.

    Raises
    ------
    EstimatorError
        When it does not or cannot; the message names the available providers.

    """
    here = ", ".join(available_providers())
    if provider not in get_args(Provider):
        raise EstimatorError(f"unknown provider {provider!r}; available here: {here}")
    if provider not in available_providers():
        raise EstimatorError(
            f"provider {provider!r} is not part of this ONNX Runtime; available here: {here}"
        )


def available_providers() -> tuple[Provider, ...]:
    """Return the providers that this installation of ONNX Runtime was built with."""
    built_in = set(_load_runtime().get_available_providers())
    return tuple(name for name, chain in _RUNTIME_NAMES.items() if chain[0] in built_in)


def _load_runtime() -> Any:
    """Import ONNX Runtime without the reports of its use to its maker."""
    os.environ.setdefault("ORT_DISABLE_TELEMETRY", "1")
    import onnxruntime  # type: ignore[import-untyped]

    return onnxruntime


def open_session(path: Path, threads: int, provider: Provider, *, remedy: str) -> Any:
    """Open a model file in ONNX Runtime, set up as all models here are.

    Parameters
    ----------
    path, threads, provider
        As in `ModelSession`.
    remedy
        Remedy in the message if the file cannot be loaded.

    Raises
    ------
    ModelError
        When the runtime cannot load the file.
    EstimatorError
        When the provider does not start.

    """
    onnxruntime = _load_runtime()
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = threads
    options.inter_op_num_threads = 1
    options.log_severity_level = ONLY_FATAL
    # Spinning threads would gain microseconds and take a core from decoder and server.
    options.add_session_config_entry("session.intra_op.allow_spinning", "0")
    chain = _RUNTIME_NAMES[provider]
    try:
        session = onnxruntime.InferenceSession(str(path), options, providers=list(chain))
    except Exception as error:  # the runtime's exceptions share no base but Exception
        reason = str(error).splitlines()[0]
        raise ModelError(f"{path} cannot be loaded ({reason}); {remedy}") from error
    if chain[0] not in session.get_providers():
        raise EstimatorError(
            f"provider {provider!r} does not start here, its driver or libraries are missing; "
            f"use provider 'cpu'"
        )
    return session


def _match_signature(path: Path, session: Any, signature: Signature) -> tuple[str, list[str]]:
    """Return the names of the input and of the outputs that the signature asks for."""
    inputs, outputs = session.get_inputs(), session.get_outputs()
    side = signature.input_size
    if len(inputs) != 1 or tuple(inputs[0].shape) != (1, side, side, 3):
        raise ModelError(
            f"{path} takes {[tuple(one.shape) for one in inputs]}, expected (1, {side}, {side}, 3):"
            f" it is another model; run `osg-studio models install`"
        )
    names = []
    for shape in signature.outputs:
        match = next((one for one in outputs if tuple(one.shape) == shape), None)
        if match is None:
            raise ModelError(
                f"{path} has no output of shape {shape}: it is another model; "
                f"run `osg-studio models install`"
            )
        outputs = [one for one in outputs if one.name != match.name]
        names.append(match.name)
    return inputs[0].name, names


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
