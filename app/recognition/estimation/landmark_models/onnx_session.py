"""ONNX session: loads a model once, checks its shapes, and runs it per frame.

ONNX Runtime is imported with the first model: it starts a thread, and a process with threads must
not fork, as the studio's does for its workers.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal, TypeAlias, get_args

import numpy as np
import numpy.typing as npt

from app.recognition.errors import EstimatorError, ModelError

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
