"""Models folder: the files that belong in it, its location, verification and atomic writes.

`INSTALLED_FILES` lists the files with the SHA-256 that each must have. The functions find and check
them (`model_path`, `verify_models`), and copy them (`install_models`, `export_models`).
"""

from __future__ import annotations

import hashlib
import os
import shlex
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Final, Literal, TypeVar

from app.recognition.errors import ModelError
from app.recognition.text.atomic_files import hash_file, write_atomically

ModelName = Literal[
    "pose_detection", "pose_landmark_full", "palm_detection_full", "hand_landmark_full"
]
"""The ONNX models, by MediaPipe's own names."""

TaskBundleName = Literal["pose_landmarker_full", "hand_landmarker"]
"""The bundles for MediaPipe's Tasks interface, by the names MediaPipe publishes them under."""


@dataclass(frozen=True)
class InstalledFile:
    """A file of the models folder.

    Attributes
    ----------
    name
        Identifier of the model or bundle.
    filename
        Its name in the models folder.
    sha256
        Expected hash of its content.

    """

    name: str
    filename: str
    sha256: str


Name = TypeVar("Name", bound=str)


def _name_files(ending: str, hashes: dict[Name, str]) -> dict[Name, InstalledFile]:
    return {name: InstalledFile(name, name + ending, sha256) for name, sha256 in hashes.items()}


MODELS: Final[dict[ModelName, InstalledFile]] = _name_files(
    ".onnx",
    {
        "pose_detection": "20d7377dfe4e13cf618c97520f89781acffc07ec9fb16fed8f5f4458a647e966",
        "pose_landmark_full": "6a7a75360ccb2e719dfdfbedd8dd112bea39fff4b95a8d4e1f4fc94fecf74c08",
        "palm_detection_full": "ed7bffc1721aa5dbcb67b11b735437c3972258031000f798ba8060e264c70fbd",
        "hand_landmark_full": "de8028c2509e24b5767e210b3ca30f883051621ee5e68587d228bca3462782b5",
    },
)
"""The ONNX models, part of every release; their conversion is deterministic (`release.models`)."""

HAND_FINDER: Final = InstalledFile(
    "hand_finder",
    "hand_finder.onnx",
    "126da0610476325158fd61b48d980d7a5fad6d6e59db75a3557540b14df0d09d",
)
"""The finder of divers' hands, part of the package itself; its card lies beside it."""

GLOVED_HANDS: Final = InstalledFile(
    "hand_landmark_gloved",
    "hand_landmark_gloved.onnx",
    "69c603eaa3227fc48eb80c42f958f83c6338fb37047e65a2d9b9f4d1307dfaab",
)
"""The landmark model of gloved hands, in the same way."""

TAUGHT_FILES: Final = (HAND_FINDER, GLOVED_HANDS)
"""What the project has taught itself."""

TASK_BUNDLES: Final[dict[TaskBundleName, InstalledFile]] = _name_files(
    ".task",
    {
        "pose_landmarker_full": "3c82c60bbe5fd58bdfb060737d7efed3cc64a2e5efd2292f6cdf08a7ccd51d7c",
        "hand_landmarker": "6bbbde8c9ceef075c7daa9ccca97dcc45396ba44eaa19eea243e9ea0d2904ccc",
    },
)
"""The bundles, as reproducible; for MediaPipe's own library, beside the wheel in a release."""

LICENSE: Final = InstalledFile(
    "license",
    "LICENSE.mediapipe.txt",
    "8707eef0533987efc5b155d64761eeb6e20793f50b9bd1a68dad1cf4719d0ed8",
)
"""MediaPipe's licence, distributed with the models (Apache-2.0, section 4a)."""

PACKAGED_FILES: Final[tuple[InstalledFile, ...]] = (*MODELS.values(), LICENSE)
"""The files that a wheel carries."""

INSTALLED_FILES: Final[tuple[InstalledFile, ...]] = (*PACKAGED_FILES, *TASK_BUNDLES.values())
"""All files of a models folder."""


State = Literal["ok", "missing", "damaged"]
"""Intact; absent; present, but with other content than the pinned one."""

DIRECTORY_VARIABLE: Final = "OSG_MODELS_DIR"
"""Environment variable that names another models folder."""

PACKAGED: Final = Path(__file__).parent / "files"
"""The package's own folder: a wheel has the models there, a checkout after `make models`."""

CHECKOUT_MAKEFILE: Final = Path(__file__).parents[3] / "Makefile"
"""It makes the models; beside an installed package there is none."""

TAUGHT: Final = Path(__file__).parent / "taught"
"""Folder of the model that is the project's own; git has it."""

Progress = Callable[[str, int, int], None]
"""Called with a file's name, the files done and their number; may raise to cancel."""


@dataclass(frozen=True)
class InstalledModel:
    """One file of the models folder and its state.

    Attributes
    ----------
    name
        Name of the model or bundle.
    path
        Its path, also when it is missing.
    size
        Size in bytes; 0 when missing.
    state
        ``"ok"``, ``"missing"`` or ``"damaged"``.

    """

    name: str
    path: Path
    size: int
    state: State


def models_dir() -> Path:
    """Return the models folder: ``OSG_MODELS_DIR``, or the package's own."""
    chosen = os.environ.get(DIRECTORY_VARIABLE)
    return Path(chosen).expanduser() if chosen else PACKAGED


def model_path(name: ModelName, directory: Path | None = None) -> Path:
    """Return the path of an ONNX model whose content is verified.

    Parameters
    ----------
    name
        Name of the model.
    directory
        Folder to look in, `models_dir` by default.

    Raises
    ------
    ModelError
        When there is no such model, or its file is missing, truncated or altered; the message
        names the file and the command that repairs it.

    """
    if name not in MODELS:
        raise ModelError(f"no model is called {name!r}; there are {', '.join(MODELS)}")
    return verify_models(MODELS[name], directory or models_dir())


def task_bundle_path(name: TaskBundleName, directory: Path | None = None) -> Path:
    """Return the path of a bundle for MediaPipe's Tasks interface, verified like a model.

    Raises
    ------
    ModelError
        As `model_path`.

    """
    if name not in TASK_BUNDLES:
        raise ModelError(f"no task bundle is called {name!r}; there are {', '.join(TASK_BUNDLES)}")
    return verify_models(TASK_BUNDLES[name], directory or models_dir())


def taught_path(file: InstalledFile) -> Path | None:
    """Return the path of one of `TAUGHT_FILES`; None where there is none.

    One in the models folder, taught by a team itself, comes before the package's own.

    Raises
    ------
    ModelError
        When the package's own is truncated or altered.

    """
    own = models_dir() / file.filename
    if own.exists():
        return own
    return None if file_state(file, TAUGHT) == "missing" else verify_models(file, TAUGHT)


def finder_path() -> Path | None:
    """Return the path of the finder of divers' hands; see `taught_path`."""
    return taught_path(HAND_FINDER)


def gloves_path() -> Path | None:
    """Return the path of the landmark model of gloved hands; see `taught_path`."""
    return taught_path(GLOVED_HANDS)


def installed_models(directory: Path | None = None) -> tuple[InstalledModel, ...]:
    """Return every file of a models folder with its state; damaged files raise no error.

    The bundles, which few need, are listed where they are present. Without a folder the taught
    models, which lie in the package, are listed too.
    """
    taught = () if directory else tuple((file, TAUGHT) for file in TAUGHT_FILES)
    directory = directory or models_dir()
    files = *((file, directory) for file in INSTALLED_FILES), *taught
    return tuple(
        InstalledModel(file.name, path, _size(path), file_state(file, place))
        for file, place in files
        for path in [place / file.filename]
        if file not in TASK_BUNDLES.values() or path.exists()
    )


def file_state(file: InstalledFile, directory: Path) -> State:
    """Return the state of a file in a models folder by its pinned SHA-256."""
    path = directory / file.filename
    try:
        status = path.stat()
        intact = _sha256(path, status.st_size, status.st_mtime_ns) == file.sha256
    except (FileNotFoundError, NotADirectoryError):
        return "missing"
    except OSError:  # a folder of that name, no permission, a failing disk
        return "damaged"
    return "ok" if intact else "damaged"


def verify_models(file: InstalledFile, directory: Path) -> Path:
    """Return the path of an intact file of a models folder.

    Raises
    ------
    ModelError
        When it is missing or damaged, with the command that repairs it.

    """
    state = file_state(file, directory)
    path = directory / file.filename
    if state == "missing":
        raise ModelError(f"model file {path} is missing; run `{mending_command(directory)}`")
    if state == "damaged":
        raise ModelError(
            f"model file {path} ({_size(path)} bytes) is truncated or not the pinned one; "
            f"run `{mending_command(directory)}`"
        )
    return path


def mending_command(directory: Path) -> str:
    """Return the command that completes a models folder; intact files are kept.

    `install_models` copies from the package's own folder, so it cannot complete that of a checkout.
    """
    if directory == PACKAGED and CHECKOUT_MAKEFILE.is_file():
        return "make models"
    command = "osg-studio models install"
    if directory == models_dir():
        return command
    return f"{DIRECTORY_VARIABLE}={shlex.quote(str(directory))} {command}"


def write_file(path: Path, content: bytes) -> None:
    """Write a file atomically: complete or not at all, also after a crash or with two writers.

    Raises
    ------
    ModelError
        When the folder cannot be written to.

    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(path, content)
        path.chmod(0o644)  # A server or robot may run as another user, whatever the umask.
    except OSError as error:
        raise ModelError(
            f"cannot write {path}: {error.strerror}; "
            f"make room there or choose another folder ({DIRECTORY_VARIABLE} for the models in use)"
        ) from error


def _size(path: Path) -> int:
    try:
        return path.stat().st_size
    except OSError:
        return 0


@lru_cache(maxsize=64)
def _sha256(path: Path, size: int, changed: int) -> str:
    """Hash a file; `size` and `changed` (ns) invalidate the cache when it is rewritten."""
    del size, changed
    return hash_file(path)


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
    if source is not None and not source.is_dir():
        raise ModelError(
            f"{source} is no folder: give one made by `osg-studio models export DIR`, or that of "
            f"a release"
        )
    directory, source = directory or models_dir(), source or PACKAGED
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
