"""Model files: MediaPipe's pose and hand models, converted to ONNX, part of every release.

`model_path` returns a file of `models_dir` whose content is verified, or raises an error that names
the remedy. In a checkout, ``make models`` obtains them (`release.models`).
"""

from app.recognition.models.catalogue import ModelName, TaskBundleName
from app.recognition.models.storage import (
    export_models,
    finder_path,
    gloves_path,
    install_models,
    installed_models,
    model_path,
    models_dir,
    task_bundle_path,
)
