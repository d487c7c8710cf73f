"""A release: two builds give the same bytes, with everything that belongs to it inside."""

import hashlib
import json
import os
import subprocess
import sys
import venv
import zipfile
from pathlib import Path

import pytest

pytest.importorskip("cyclonedx", reason="needs cyclonedx-python-lib")

from app.recognition.models import models_dir
from app.recognition.models.catalogue import INSTALLED_FILES
from release.build import build_release
from release.checkout import ReleaseError, run_git
from tests.documented import documented

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def release(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build a release of the last commit; it fails by itself where two builds differ."""
    try:
        run_git("rev-parse", "HEAD")
    except ReleaseError as error:
        pytest.skip(str(error))
    folder = tmp_path_factory.mktemp("release") / "dist"
    build_release(folder)
    return folder


@pytest.fixture(scope="module")
def wheel(release: Path) -> Path:
    (found,) = release.glob("*.whl")
    return found


def test_a_release_is_complete_and_its_checksums_are_right(release: Path) -> None:
    names = {file.name for file in release.iterdir()}
    assert names >= {"licences.txt", "notes.md", "models.sha256", "osg-studio.cdx.json"}
    assert {Path(name).suffix for name in names} >= {".whl", ".gz"}
    lines = (release / "SHA256SUMS").read_text().splitlines()
    sums = {name: expected for expected, _, name in (line.partition("  ") for line in lines)}
    assert sums.keys() == names - {"SHA256SUMS"}
    for name, expected in sums.items():
        assert hashlib.sha256((release / name).read_bytes()).hexdigest() == expected
    models = (release / "models.sha256").read_text().splitlines()
    assert models == [f"{file.sha256}  {file.filename}" for file in INSTALLED_FILES]


def test_the_bill_of_materials_is_in_the_wheel(release: Path, wheel: Path) -> None:
    archive = zipfile.ZipFile(wheel)
    (name,) = [name for name in archive.namelist() if "/sboms/" in name]
    assert archive.read(name) == (release / "osg-studio.cdx.json").read_bytes()


def test_from_the_wheel_alone_a_robot_recognises_a_sample_clip(
    wheel: Path, tmp_path: Path, installed_models: None
) -> None:
    home = tmp_path / "robot"
    venv.create(home / "env", with_pip=False, symlinks=True)
    binaries = home / "env" / ("Scripts" if os.name == "nt" else "bin")
    python = str(binaries / "python")
    pip = [sys.executable, "-m", "pip", "--python", python, "install", "--quiet"]
    installed = subprocess.run(
        [*pip, f"{wheel}[robot]"], capture_output=True, text=True, check=False
    )
    if "No matching distribution" in installed.stderr or "connection" in installed.stderr:
        pytest.skip("needs the packages that a robot installs: " + installed.stderr[-300:])
    assert installed.returncode == 0, installed.stderr
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    environment |= {"XDG_DATA_HOME": str(home / "data"), "OSG_MODELS_DIR": str(home / "models")}

    def run(*arguments: str | Path) -> str:
        finished = subprocess.run(
            [binaries / "osg-studio", *arguments],
            cwd=home,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )
        assert finished.returncode == 0, finished.stderr
        return finished.stdout

    # As on a robot without network: the models come from a folder.
    run("models", "install", "--source", models_dir())
    run("samples")
    (command,) = [
        command
        for command in documented("robot", page="robots/without-ros.md")
        if "languages/clips/line-test-1.mp4" in command
    ]
    events = [json.loads(line) for line in run(*command).splitlines()]
    labels = [event["label"] for event in events if event["event"] == "take_recognized"]
    assert labels == ["line"]
