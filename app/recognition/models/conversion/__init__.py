"""Model conversion: MediaPipe's TensorFlow Lite files to ONNX models and task bundles.

Only the installation uses this package and its libraries `onnx` and `flatbuffers`; a robot with the
converted files needs neither. It converts only the operators of MediaPipe's pose and hand models,
without TensorFlow. Conversion is deterministic, so `app.recognition.models.catalogue` pins the
results.
"""

from app.recognition.models.conversion.onnx_model import to_onnx
from app.recognition.models.conversion.schemas import Schemas
from app.recognition.models.conversion.task_bundle import task_bundle

__all__ = ["Schemas", "task_bundle", "to_onnx"]
