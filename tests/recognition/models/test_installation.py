"""Installing: model files are copied from the package, an exported folder or a release."""

from pathlib import Path

import pytest

from app.recognition.errors import ModelError
from app.recognition.models import export_models, install_models, installed_models, model_path


def states(directory: Path) -> set[str]:
    return {one.state for one in installed_models(directory)}


def contents(directory: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in directory.iterdir()}


def test_what_was_exported_installs_again_without_network(exported: Path, tmp_path: Path) -> None:
    install_models(directory=tmp_path / "robot", source=exported)
    assert states(tmp_path / "robot") == {"ok"}
    assert contents(tmp_path / "robot") == contents(exported)


def test_the_licence_goes_with_the_models(exported: Path) -> None:
    assert "Apache License" in (exported / "LICENSE.mediapipe.txt").read_text(encoding="utf-8")


def test_without_a_source_the_packages_own_models_are_copied(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("OSG_MODELS_DIR", str(tmp_path / "robot"))
    install_models()
    assert states(tmp_path / "robot") == {"ok"}
    assert model_path("pose_detection") == tmp_path / "robot" / "pose_detection.onnx"


def test_a_checkout_without_models_says_how_to_obtain_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.recognition.models.installation.PACKAGED", tmp_path)
    with pytest.raises(ModelError, match=r"cannot read .*pose_detection\.onnx.*`make models`"):
        install_models(directory=tmp_path / "robot")


def test_the_bundles_are_copied_from_where_they_are(models: Path, tmp_path: Path) -> None:
    (models / "hand_landmarker.task").unlink()
    install_models(directory=tmp_path / "robot", source=models)
    assert not (tmp_path / "robot" / "hand_landmarker.task").exists()
    assert (tmp_path / "robot" / "pose_landmarker_full.task").exists()
    assert states(tmp_path / "robot") == {"ok"}


def test_a_complete_folder_is_left_as_it_is(models: Path) -> None:
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
    with pytest.raises(ModelError, match=r"nowhere is no folder: .*models export DIR"):
        install_models(directory=tmp_path / "robot", source=tmp_path / "nowhere")


def test_a_damaged_installation_is_not_exported(models: Path, tmp_path: Path) -> None:
    (models / "pose_detection.onnx").unlink()
    with pytest.raises(ModelError, match=r"pose_detection\.onnx is missing; run"):
        export_models(tmp_path / "usb")
    assert not (tmp_path / "usb").exists()


def test_exporting_to_where_a_file_lies_says_so(models: Path, tmp_path: Path) -> None:
    (tmp_path / "usb").write_text("a file")
    with pytest.raises(ModelError, match=r"cannot write .*usb.*choose another folder"):
        export_models(tmp_path / "usb")
