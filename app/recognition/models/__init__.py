"""Model files: MediaPipe's pose and hand models, converted to ONNX, part of every release.

`model_path` returns a file of `models_dir` whose content is verified, or raises an error that names
the remedy. In a checkout, ``make models`` obtains them (`release.models`).
"""
