"""Installing: once by pip, from the wheel as a file, or from an exported folder without network."""

import subprocess
import sys
from pathlib import Path

import pytest

from app.recognition.errors import ModelError
from app.recognition.models import export_models, install_models, installed_models

ROBOT = """
import sys
for library in ("onnx", "flatbuffers"):
    sys.modules[library] = None  # importing it fails, as where it is not installed
from pathlib import Path
from app.recognition.errors import ModelError
from app.recognition.models import install_models, model_path
try:
    install_models(source=Path(sys.argv[1]))
    print(model_path("pose_detection"))
except ModelError as error:
    print(error)
"""
"""A robot's program: it installs from an argument, without the converter's libraries."""


def states(directory: Path) -> set[str]:
    return {one.state for one in installed_models(directory)}


def output_of_robot(source: Path) -> str:
    finished = subprocess.run(
        [sys.executable, "-c", ROBOT, str(source)], capture_output=True, text=True, check=False
    )
    assert finished.stderr == ""
    return finished.stdout.strip()


def contents(directory: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in directory.iterdir()}


def test_what_was_exported_installs_again_without_network(
    exported: Path, tmp_path: Path, pip_offline: Path
) -> None:
    install_models(directory=tmp_path / "robot", source=exported)
    assert states(tmp_path / "robot") == {"ok"}
    assert contents(tmp_path / "robot") == contents(exported)


def test_the_licence_goes_with_the_models(exported: Path) -> None:
    assert "Apache License" in (exported / "LICENSE.mediapipe.txt").read_text(encoding="utf-8")


@pytest.mark.slow
def test_a_robot_installs_an_export_without_the_converters_libraries(
    exported: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("OSG_MODELS_DIR", str(tmp_path))
    assert output_of_robot(exported) == str(tmp_path / "pose_detection.onnx")


@pytest.mark.slow
def test_converting_without_the_libraries_says_which_is_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("OSG_MODELS_DIR", str(tmp_path))
    message = output_of_robot(tmp_path / "mediapipe.whl")
    assert "converting the models needs onnx, which is not installed; run `pip install" in message
    assert "osg-studio models install --source DIR" in message


def test_a_complete_installation_needs_neither_network_nor_source(
    models: Path, pip_offline: Path
) -> None:
    before = {path: path.stat().st_mtime_ns for path in models.iterdir()}
    install_models()
    assert {path: path.stat().st_mtime_ns for path in models.iterdir()} == before


def test_only_what_is_damaged_is_replaced(models: Path, exported: Path) -> None:
    damaged = models / "palm_detection_full.onnx"
    damaged.write_bytes(damaged.read_bytes()[:-100])
    before = {path: path.stat().st_mtime_ns for path in models.iterdir() if path != damaged}
    install_models(source=exported)
    assert states(models) == {"ok"}
    assert {path: path.stat().st_mtime_ns for path in before} == before


def test_progress_counts_the_files_to_the_end(exported: Path, tmp_path: Path) -> None:
    reports: list[tuple[str, int, int]] = []
    install_models(lambda *report: reports.append(report), tmp_path, exported)
    total = len(installed_models(tmp_path))
    assert [done for _, done, _ in reports] == list(range(total + 1))
    assert {of for _, _, of in reports} == {total}
    assert reports[0][0] == "pose_detection.onnx"


def test_an_interrupted_installation_leaves_whole_files_only_and_is_finished_later(
    exported: Path, tmp_path: Path
) -> None:
    def interrupt(step: str, done: int, total: int) -> None:
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        install_models(interrupt, tmp_path, exported)
    assert {path.name for path in tmp_path.iterdir()} == {
        "pose_detection.onnx",
        "pose_landmark_full.onnx",
    }
    assert states(tmp_path) == {"ok", "missing"}
    install_models(directory=tmp_path, source=exported)
    assert states(tmp_path) == {"ok"}


@pytest.mark.parametrize("content", [b"", b"not a model"])
def test_a_damaged_export_is_refused_and_nothing_of_it_is_installed(
    models: Path, tmp_path: Path, content: bytes
) -> None:
    (models / "pose_detection.onnx").write_bytes(content)
    with pytest.raises(ModelError, match=r"pose_detection\.onnx .*run `osg-studio models export"):
        install_models(directory=tmp_path / "robot", source=models)
    assert not (tmp_path / "robot").exists()


def test_an_incomplete_export_names_the_missing_file(models: Path, tmp_path: Path) -> None:
    (models / "pose_detection.onnx").unlink()
    with pytest.raises(ModelError, match=r"cannot read .*pose_detection\.onnx: No such file"):
        install_models(directory=tmp_path / "robot", source=models)


def test_a_source_that_does_not_exist_says_what_a_source_is(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match=r"nowhere: No such file.*models export DIR.*the wheel of"):
        install_models(directory=tmp_path / "robot", source=tmp_path / "nowhere")


def test_another_file_in_the_wheels_place_is_refused_unopened(tmp_path: Path) -> None:
    fake = tmp_path / "mediapipe-0.10.21-cp312-cp312-manylinux_2_28_x86_64.whl"
    fake.write_bytes(b"PK not the wheel")
    with pytest.raises(ModelError, match=r"not the pinned wheel of mediapipe==0\.10\.21.*SHA-256"):
        install_models(directory=tmp_path / "robot", source=fake)
    assert not (tmp_path / "robot").exists()


def test_a_damaged_installation_is_not_exported(models: Path, tmp_path: Path) -> None:
    (models / "hand_landmarker.task").unlink()
    with pytest.raises(ModelError, match=r"hand_landmarker\.task is missing; run"):
        export_models(tmp_path / "usb")
    assert not (tmp_path / "usb").exists()


def test_exporting_to_where_a_file_lies_says_so(models: Path, tmp_path: Path) -> None:
    (tmp_path / "usb").write_text("a file")
    with pytest.raises(ModelError, match=r"cannot write .*usb.*choose another folder"):
        export_models(tmp_path / "usb")


@pytest.mark.slow
def test_the_wheel_as_a_file_gives_the_same_installation(
    wheel: Path, exported: Path, tmp_path: Path, pip_offline: Path
) -> None:
    install_models(directory=tmp_path / "robot", source=wheel)
    assert contents(tmp_path / "robot") == contents(exported)
