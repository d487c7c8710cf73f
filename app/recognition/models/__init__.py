"""Model files: MediaPipe's pose and hand models, downloaded once, converted and verified.

The models are Google's (Apache-2.0) and part of MediaPipe's wheel. `install_models` downloads that
wheel with pip, checks it against its pinned SHA-256, converts the models to ONNX and stores them
in `models_dir`; `model_path` returns a verified file or raises an error that names the remedy.
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
