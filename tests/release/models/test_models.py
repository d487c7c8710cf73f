"""The models of a release: what MediaPipe's wheel gives is what is pinned, and nothing else."""

import subprocess
import sys
from pathlib import Path

import pytest

from app.recognition.errors import ModelError
from app.recognition.models.storage import installed_models
from release.models.__main__ import obtain_models
from tests.conftest import ROOT


@pytest.mark.slow
def test_the_wheel_gives_every_file_and_a_second_call_changes_none(
    wheel: Path, tmp_path: Path, pip_offline: Path
) -> None:
    obtain_models(tmp_path, wheel)
    assert {one.state for one in installed_models(tmp_path)} == {"ok"}
    assert "Apache License" in (tmp_path / "LICENSE.mediapipe.txt").read_text(encoding="utf-8")
    before = {path: path.stat().st_mtime_ns for path in tmp_path.glob("*.*")}
    obtain_models(tmp_path)
    assert {path: path.stat().st_mtime_ns for path in before} == before


def test_another_file_in_the_wheels_place_is_refused_unopened(tmp_path: Path) -> None:
    fake = tmp_path / "mediapipe-0.10.21-cp312-cp312-manylinux_2_28_x86_64.whl"
    fake.write_bytes(b"PK not the wheel")
    with pytest.raises(ModelError, match=r"not the pinned wheel of mediapipe==0\.10\.21.*SHA-256"):
        obtain_models(tmp_path / "models", fake)
    assert not (tmp_path / "models").exists()


@pytest.mark.slow
def test_without_network_the_command_says_what_to_do(pip_offline: Path, tmp_path: Path) -> None:
    finished = subprocess.run(
        [sys.executable, "-m", "release.models", str(tmp_path / "models")],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert finished.returncode == 1
    assert finished.stderr.startswith("models: pip could not obtain mediapipe==0.10.21")
