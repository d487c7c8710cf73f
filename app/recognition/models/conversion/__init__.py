"""From MediaPipe's TensorFlow Lite files to what runs here: ONNX models and task bundles.

Only the installation needs this package, and only it needs the libraries `onnx` and `flatbuffers`:
a robot that gets the finished files runs without. It converts just the operators that MediaPipe's
pose and hand models use; no TensorFlow is involved. The same input always gives the same bytes,
which is why `app.recognition.models.catalogue` can pin the results.
"""

from app.recognition.models.conversion.onnx_model import to_onnx
from app.recognition.models.conversion.schemas import Schemas
from app.recognition.models.conversion.task_bundle import task_bundle

__all__ = ["Schemas", "task_bundle", "to_onnx"]
