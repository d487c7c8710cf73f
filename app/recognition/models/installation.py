"""Model installation: copies model files to another folder, for MediaPipe's library or a robot."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path

from app.recognition.errors import ModelError
from app.recognition.models.catalogue import (
    INSTALLED_FILES,
    PACKAGED_FILES,
    InstalledFile,
)
from app.recognition.models.storage import (
    PACKAGED,
    file_state,
    models_dir,
    verify_models,
    write_file,
)

Progress = Callable[[str, int, int], None]
"""Called with a file's name, the files done and their number; may raise to cancel."""


def install_models(
    progress: Progress | None = None, directory: Path | None = None, source: Path | None = None
) -> None:
    """Copy the model files that are missing or damaged in a folder.

    Files are written atomically, so that running an interrupted installation again completes it.

    Parameters
    ----------
    progress
        Called at each file.
    directory
        Folder to fill, `models_dir` by default.
    source
        Folder to copy from: one made by `export_models`, that of a release, or by default the
        package's own. The bundles of MediaPipe's library are copied where the source has them.

    Raises
    ------
    ModelError
        When the source lacks a file or has another one, or the folder is not writable; the message
        says what to do.

    """
    directory, source = directory or models_dir(), source or PACKAGED
    if not source.is_dir():
        raise ModelError(
            f"{source} is no folder: give one made by `osg-studio models export DIR`, or that of "
            f"a release"
        )
    missing = [file for file in INSTALLED_FILES if file_state(file, directory) != "ok"]
    wanted = [
        file for file in missing if file in PACKAGED_FILES or (source / file.filename).exists()
    ]
    for done, file in enumerate(wanted):
        if progress:
            progress(file.filename, done, len(wanted))
        write_file(directory / file.filename, _read_checked(source, file))
    if progress:
        progress("installed", len(wanted), len(wanted))


def export_models(directory: Path) -> None:
    """Copy the models, and the bundles where there are any, to a folder.

    On a machine without network `install_models` takes the folder as its `source`.

    Raises
    ------
    ModelError
        When a model is missing or damaged, or the folder is not writable.

    """
    installed = models_dir()
    for file in PACKAGED_FILES:
        verify_models(file, installed)
    install_models(directory=directory, source=installed)


def _read_checked(source: Path, file: InstalledFile) -> bytes:
    """Read a file of a folder and check it against its pinned SHA-256."""
    path = source / file.filename
    remedy = (
        "run `make models` in the checkout, or give `--source` a folder made by "
        "`osg-studio models export DIR`"
        if source == PACKAGED
        else "run `osg-studio models export DIR` again where the models are installed"
    )
    try:
        content = path.read_bytes()
    except OSError as error:
        raise ModelError(f"cannot read {path}: {error.strerror}; {remedy}") from error
    if hashlib.sha256(content).hexdigest() != file.sha256:
        raise ModelError(
            f"{path} ({len(content)} bytes) is truncated or not the pinned one; {remedy}"
        )
    return content
