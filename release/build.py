"""Release build: builds everything twice from the committed files; the bytes must be equal."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from app import __version__
from app.recognition.models.storage import (
    INSTALLED_FILES,
    PACKAGED,
    PACKAGED_FILES,
    TASK_BUNDLES,
    verify_models,
)
from release.bill import FILE_NAME, build_bill
from release.checkout import ROOT, ReleaseError, commit_seconds, export_commit
from release.licences import Licensed, list_licences
from release.notes import read_notes


def build_release(target: Path) -> list[Path]:
    """Build a release into a folder, which is emptied first.

    Returns
    -------
    The files of the release: wheel, source distribution, bill of materials, licences, notes, the
    bundles of models for MediaPipe's own library, and the checksums of these and of the models.

    Raises
    ------
    ReleaseError
        When there is no checkout, the changelog lacks the version, a build fails, or two builds
        differ.
    ModelError
        When the checkout lacks a model file.

    """
    notes = read_notes((ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), __version__)
    packages = list_licences()
    seconds = commit_seconds()
    bill = build_bill(__version__, seconds, packages)
    shutil.rmtree(target, ignore_errors=True)
    target.mkdir(parents=True)
    with tempfile.TemporaryDirectory() as scratch:
        # The second build has another path, as on another machine.
        first, second = Path(scratch, "first"), Path(scratch, "again", "elsewhere")
        with ThreadPoolExecutor() as pool:
            list(pool.map(lambda place: _build_once(place, bill, seconds), (first, second)))
        for built in sorted((first / "dist").iterdir()):
            if built.read_bytes() != (second / "dist" / built.name).read_bytes():
                raise ReleaseError(f"two builds of {built.name} differ; find out what does")
            shutil.copyfile(built, target / built.name)
    for bundle in TASK_BUNDLES.values():
        shutil.copyfile(verify_models(bundle, PACKAGED), target / bundle.filename)
    (target / FILE_NAME).write_text(bill, encoding="utf-8")
    (target / "licences.txt").write_text(_format_licences(packages), encoding="utf-8")
    (target / "notes.md").write_text(notes, encoding="utf-8")
    models = "".join(f"{file.sha256}  {file.filename}\n" for file in INSTALLED_FILES)
    (target / "models.sha256").write_text(models, encoding="utf-8")
    files = sorted(target.iterdir())
    sums = "".join(f"{_hash(file)}  {file.name}\n" for file in files)
    (target / "SHA256SUMS").write_text(sums, encoding="utf-8")
    return sorted(target.iterdir())


def _build_once(place: Path, bill: str, seconds: int) -> None:
    """Build wheel and source distribution in a fresh copy of the commit."""
    place.mkdir(parents=True)
    export_commit(place)
    (place / "release" / FILE_NAME).write_text(bill, encoding="utf-8")
    models = place / PACKAGED.relative_to(ROOT)
    models.mkdir()
    for file in PACKAGED_FILES:
        shutil.copyfile(verify_models(file, PACKAGED), models / file.filename)
    finished = subprocess.run(
        [sys.executable, "-m", "hatchling", "build", "--directory", "dist"],
        cwd=place,
        env=os.environ | {"SOURCE_DATE_EPOCH": str(seconds)},
        capture_output=True,
        text=True,
        check=False,
    )
    if finished.returncode != 0:
        raise ReleaseError(f"the build failed: {finished.stderr.strip()}")


def _format_licences(packages: list[Licensed]) -> str:
    return "".join(f"{each.name:<28} {each.version:<16} {each.licence}\n" for each in packages)


def _hash(file: Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()
