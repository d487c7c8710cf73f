"""Running a model on either runtime: TensorFlow Lite's own (LiteRT), and ONNX Runtime."""

from typing import Any

import numpy as np
import numpy.typing as npt
import onnxruntime  # type: ignore[import-untyped]
import pytest

FloatTensor = npt.NDArray[np.float32]


def run_tflite(model: bytes, image: FloatTensor) -> dict[str, FloatTensor]:
    """Run on LiteRT; skip where it is not installed."""
    litert = pytest.importorskip(
        "ai_edge_litert.interpreter", reason="needs LiteRT: pip install ai-edge-litert"
    )
    interpreter: Any = litert.Interpreter(model_content=model, num_threads=1)
    interpreter.allocate_tensors()
    interpreter.set_tensor(interpreter.get_input_details()[0]["index"], image)
    interpreter.invoke()
    return {
        output["name"]: interpreter.get_tensor(output["index"]).copy()
        for output in interpreter.get_output_details()
    }


def run_onnx(model: bytes, image: FloatTensor) -> dict[str, FloatTensor]:
    """Run on ONNX Runtime, one thread."""
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = 1
    session = onnxruntime.InferenceSession(model, options, providers=["CPUExecutionProvider"])
    names = [output.name for output in session.get_outputs()]
    values = session.run(names, {session.get_inputs()[0].name: image})
    return dict(zip(names, values, strict=True))
