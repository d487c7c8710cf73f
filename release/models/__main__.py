"""Obtains the models: ``python -m release.models [FOLDER]``, the package's own folder if left out.

The models are Google's (Apache-2.0) and part of MediaPipe's wheel. pip downloads that wheel, which
is checked against its pinned SHA-256; the models are converted to ONNX and bundled for MediaPipe's
Tasks interface. Conversion is deterministic, so its results are pinned as well. Only operators of
these models are converted, without TensorFlow. A wheel built from a checkout with models has them.
"""

from __future__ import annotations

import hashlib
import sys
import tempfile
import zipfile
from collections.abc import Callable
from functools import partial
from pathlib import Path

from app.recognition.errors import ModelError
from app.recognition.models.storage import (
    INSTALLED_FILES,
    LICENSE,
    MODELS,
    PACKAGED,
    TASK_BUNDLES,
    InstalledFile,
    file_state,
    write_file,
)
from release.models.onnx_model import to_onnx
from release.models.schemas import Schemas
from release.models.sources import (
    BUNDLE_PARTS,
    LICENSE_SOURCE,
    METADATA_SCHEMA_SOURCE,
    MODEL_SCHEMA_SOURCE,
    SOURCES,
    UNUSED_OUTPUTS,
    WHEEL,
    credit,
)
from release.models.task_bundle import task_bundle
from release.models.wheel import check_wheel, download_wheel


def obtain_models(directory: Path, wheel: Path | None = None) -> None:
    """Write the model files that are missing or damaged in a folder.

    Parameters
    ----------
    directory
        The folder.
    wheel
        MediaPipe's wheel; pip downloads it (34 MB) when not given.

    Raises
    ------
    ModelError
        When the wheel cannot be downloaded or is not the pinned one, a library converts in another
        way than the pinned one, or the folder is not writable.

    """
    wanted = [file for file in INSTALLED_FILES if file_state(file, directory) != "ok"]
    if not wanted:
        return
    with tempfile.TemporaryDirectory(prefix="osg-models-") as scratch:
        if wheel is None:
            print(f"downloading {WHEEL.requirement}", flush=True)
            wheel = download_wheel(Path(scratch))
        check_wheel(wheel)
        makers = list_makers(wheel)
        for file in wanted:
            write_file(directory / file.filename, _check_pinned(makers[file](), file))


def list_makers(path: Path) -> dict[InstalledFile, Callable[[], bytes]]:
    """Return what makes each file from MediaPipe's wheel, which has been checked."""
    with zipfile.ZipFile(path) as wheel:
        schemas = Schemas.from_source(
            model=wheel.read(MODEL_SCHEMA_SOURCE), metadata=wheel.read(METADATA_SCHEMA_SOURCE)
        )
        sources = {model: wheel.read(member) for model, member in SOURCES.items()}
        makers: dict[InstalledFile, Callable[[], bytes]] = {
            LICENSE: partial(bytes, wheel.read(LICENSE_SOURCE))
        }
        for model, content in sources.items():
            unused = UNUSED_OUTPUTS.get(model, ())
            makers[MODELS[model]] = partial(to_onnx, content, schemas.model, credit(model), unused)
        for bundle, models in BUNDLE_PARTS.items():
            parts = {name: sources[model] for name, model in models.items()}
            makers[TASK_BUNDLES[bundle]] = partial(task_bundle, parts, schemas)
    return makers


def _check_pinned(content: bytes, file: InstalledFile) -> bytes:
    """Return converted content after checking it against its pinned SHA-256."""
    found = hashlib.sha256(content).hexdigest()
    if found != file.sha256:
        raise ModelError(
            f"conversion gave another {file.filename} than expected (SHA-256 {found}): a library "
            f"differs; install the pinned `onnx` and `flatbuffers` of requirements.txt"
        )
    return content


if __name__ == "__main__":
    folder = Path(sys.argv[1]) if sys.argv[1:] else PACKAGED
    try:
        obtain_models(folder)
    except ModelError as error:
        sys.exit(f"models: {error}")
    print(f"all models are in {folder}")
