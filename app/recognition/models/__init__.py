"""MediaPipe's pose and hand models: obtained once, converted, verified; then no network is needed.

The models are Google's (Apache-2.0) and lie in MediaPipe's own wheel. `install_models` obtains
that wheel with pip, checks it against its pinned SHA-256, converts the models to ONNX and keeps
them in `models_dir`; `model_path` gives a verified file or says what is wrong with it.
"""

from app.recognition.models.catalogue import ModelName, TaskBundleName
from app.recognition.models.installation import export_models, install_models
from app.recognition.models.storage import (
    InstalledModel,
    installed_models,
    model_path,
    models_dir,
    task_bundle_path,
)

__all__ = [
    "InstalledModel",
    "ModelName",
    "TaskBundleName",
    "export_models",
    "install_models",
    "installed_models",
    "model_path",
    "models_dir",
    "task_bundle_path",
]
