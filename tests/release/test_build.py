"""A release: two builds give the same bytes, with everything that belongs to it inside.

Tested where what makes a release differs from the main branch, or in its last commit. CI builds and
installs one each night and after each such change (.github/workflows/release.yml).
"""

import hashlib
import json
import os
import re
import shutil
import subprocess
import venv
import zipfile
from pathlib import Path

import pytest

pytest.importorskip("cyclonedx", reason="needs cyclonedx-python-lib")

from app.recognition.models.storage import INSTALLED_FILES, PACKAGED_FILES
from release.build import build_release
from release.checkout import ReleaseError, run_git
from tests.conftest import ROOT

NO_NETWORK = re.compile(r"No matching distribution|connection|timed out|name resolution", re.I)

MAKES_A_RELEASE = ("release/*.py", "pyproject.toml", "requirements*.txt", "app/recognition/models")

pytestmark = pytest.mark.slow


def list_changed() -> bytes:
    """Return the changed files that make a release, since the main branch or the last commit."""
    head = run_git("rev-parse", "HEAD")
    try:
        base = run_git("merge-base", "HEAD", "origin/main")
    except ReleaseError:
        base = head
    try:
        base = run_git("rev-parse", "HEAD^") if base == head else base
    except ReleaseError:
        return b"everything: no earlier commit is known"
    return run_git("diff", "--name-only", base.decode().strip(), "--", *MAKES_A_RELEASE)


@pytest.fixture(scope="module")
def release(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build a release of the last commit; it fails by itself where two builds differ."""
    try:
        changed = list_changed()
    except ReleaseError as error:
        pytest.skip(str(error))
    if not changed:
        pytest.skip("needs a change in what makes a release; CI builds one each night")
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


def test_the_wheel_carries_the_models_with_their_licence(wheel: Path) -> None:
    archive = zipfile.ZipFile(wheel)
    for file in PACKAGED_FILES:
        content = archive.read(f"app/recognition/models/files/{file.filename}")
        assert hashlib.sha256(content).hexdigest() == file.sha256
    assert not [name for name in archive.namelist() if name.endswith(".task")]


def test_the_bill_of_materials_is_in_the_wheel(release: Path, wheel: Path) -> None:
    archive = zipfile.ZipFile(wheel)
    (name,) = [name for name in archive.namelist() if "/sboms/" in name]
    assert archive.read(name) == (release / "osg-studio.cdx.json").read_bytes()


@pytest.mark.skipif(os.name == "nt", reason="the commands are for a POSIX shell")
def test_the_documented_commands_lead_from_the_wheel_alone_to_a_recognised_clip(
    release: Path, tmp_path: Path
) -> None:
    home = tmp_path / "robot"
    shutil.copytree(release, home / "dist")
    venv.create(home / "env", with_pip=True, symlinks=True)
    kept = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    environment = kept | {
        "PATH": f"{home / 'env' / 'bin'}{os.pathsep}{kept.get('PATH', '')}",
        "PIP_NO_COMPILE": "1",  # most of what is installed is never imported here
    }
    page = (ROOT / "docs" / "robots" / "without-ros.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```sh\n(.*?)```", page, re.DOTALL)
    commands = [*blocks[0].splitlines(), blocks[1].splitlines()[0]]
    assert commands[0].startswith("pip install --find-links dist ")
    assert commands[-1].startswith("osg-studio robot ")
    for command in commands:
        finished = subprocess.run(
            command,
            shell=True,
            cwd=home,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )
        if finished.returncode != 0 and NO_NETWORK.search(finished.stderr):
            pytest.skip("needs what a robot installs: " + finished.stderr[-300:])
        assert finished.returncode == 0, finished.stderr
    events = [json.loads(line) for line in finished.stdout.splitlines()]
    labels = [event["label"] for event in events if event["event"] == "take_recognized"]
    assert labels == ["line"]
