"""The models folder: a damaged file is reported with the command that repairs it."""

import os
from pathlib import Path
from typing import get_args

import pytest

from app.recognition.errors import ModelError
from app.recognition.models.storage import (
    GLOVED_HANDS,
    HAND_FINDER,
    PACKAGED,
    TAUGHT,
    TAUGHT_FILES,
    ModelName,
    TaskBundleName,
    export_models,
    finder_path,
    gloves_path,
    install_models,
    installed_models,
    model_path,
    models_dir,
    task_bundle_path,
    write_file,
)

NAMES: tuple[ModelName, ...] = get_args(ModelName)
BUNDLES: tuple[TaskBundleName, ...] = get_args(TaskBundleName)


def test_every_model_and_bundle_of_a_complete_folder_is_found(models: Path) -> None:
    assert [model_path(name) for name in NAMES] == [models / f"{name}.onnx" for name in NAMES]
    assert [task_bundle_path(name) for name in BUNDLES] == [
        models / f"{name}.task" for name in BUNDLES
    ]


def test_a_complete_folder_lists_every_file_as_ok(models: Path) -> None:
    listed = installed_models()
    taught = {TAUGHT / file.filename for file in TAUGHT_FILES}
    assert {one.path for one in listed} == {*models.iterdir(), *taught}
    assert {one.state for one in listed} == {"ok"}
    assert all(one.size == one.path.stat().st_size for one in listed)


def test_an_empty_folder_lists_every_file_as_missing(tmp_path: Path) -> None:
    assert {(one.state, one.size) for one in installed_models(tmp_path)} == {("missing", 0)}


def test_the_folder_is_the_one_the_environment_names(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("OSG_MODELS_DIR", str(tmp_path))
    assert models_dir() == tmp_path


def test_the_folder_is_the_packages_own_by_default(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("OSG_MODELS_DIR", raising=False)
    assert models_dir() == PACKAGED


def test_a_missing_model_is_named_with_the_mending_command(models: Path) -> None:
    (models / "hand_landmark_full.onnx").unlink()
    with pytest.raises(ModelError, match="missing; run `osg-studio models install`") as caught:
        model_path("hand_landmark_full")
    assert str(models / "hand_landmark_full.onnx") in str(caught.value)
    assert "\n" not in str(caught.value)
    assert model_path("pose_detection").is_file()


def test_a_checkout_without_models_is_told_to_make_them(
    models: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.recognition.models.storage.PACKAGED", models)
    (models / "hand_landmark_full.onnx").unlink()
    with pytest.raises(ModelError, match=r"missing; run `make models`$"):
        model_path("hand_landmark_full")


@pytest.mark.parametrize("kept", [0, 1, 1000, -1])
@pytest.mark.withstands(row="H25")
def test_a_truncated_model_is_named_with_its_size(models: Path, kept: int) -> None:
    path = models / "pose_detection.onnx"
    content = path.read_bytes()[:kept]
    path.write_bytes(content)
    with pytest.raises(
        ModelError, match=rf"\({len(content)} bytes\) is truncated or not"
    ) as caught:
        model_path("pose_detection")
    assert "osg-studio models install" in str(caught.value)


def test_another_model_under_a_models_name_is_refused(models: Path) -> None:
    (models / "pose_detection.onnx").write_bytes((models / "pose_landmark_full.onnx").read_bytes())
    with pytest.raises(ModelError, match=r"pose_detection\.onnx .*not the pinned one"):
        model_path("pose_detection")


def test_one_changed_bit_is_noticed_though_the_model_was_intact_before(models: Path) -> None:
    path = model_path("palm_detection_full")
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)
    with pytest.raises(ModelError, match="not the pinned one"):
        model_path("palm_detection_full")


def test_a_folder_in_a_models_place_is_damage_not_a_crash(models: Path) -> None:
    (models / "pose_detection.onnx").unlink()
    (models / "pose_detection.onnx").mkdir()
    states = {one.name: one.state for one in installed_models()}
    assert states.pop("pose_detection") == "damaged"
    assert set(states.values()) == {"ok"}


def test_a_missing_bundle_is_named_too(models: Path) -> None:
    (models / "hand_landmarker.task").unlink()
    with pytest.raises(ModelError, match=r"hand_landmarker\.task is missing; run"):
        task_bundle_path("hand_landmarker")


def test_the_command_names_a_folder_that_is_not_the_usual_one(models: Path, tmp_path: Path) -> None:
    other = tmp_path / "my robot"
    with pytest.raises(ModelError) as caught:
        model_path("pose_detection", other)
    assert f"OSG_MODELS_DIR='{other}' osg-studio models install" in str(caught.value)


def test_an_unknown_name_lists_the_known_ones() -> None:
    with pytest.raises(ModelError, match="'pose'; there are pose_detection, "):
        model_path("pose")  # type: ignore[arg-type]
    with pytest.raises(ModelError, match="pose_landmarker_full, hand_landmarker"):
        task_bundle_path("pose")  # type: ignore[arg-type]


def test_a_write_that_fails_leaves_the_old_file_and_nothing_else(tmp_path: Path) -> None:
    path = tmp_path / "model.onnx"
    path.mkdir()
    with pytest.raises(ModelError, match=r"cannot write .*model\.onnx: "):
        write_file(path, b"new")
    assert list(tmp_path.iterdir()) == [path]


def test_a_written_file_can_be_read_by_other_users(tmp_path: Path) -> None:
    write_file(tmp_path / "deep" / "model.onnx", b"content")
    path = tmp_path / "deep" / "model.onnx"
    assert path.read_bytes() == b"content"
    if os.name == "posix":
        assert path.stat().st_mode & 0o777 == 0o644


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
    monkeypatch.setattr("app.recognition.models.storage.PACKAGED", tmp_path / "files")
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


def test_the_models_of_divers_hands_are_the_packages_own(models: Path) -> None:
    finder, gloves = finder_path(), gloves_path()
    assert finder == TAUGHT / HAND_FINDER.filename
    assert finder.stat().st_size < 4_000_000
    assert gloves == TAUGHT / GLOVED_HANDS.filename


def test_a_finder_that_a_team_taught_comes_first(models: Path) -> None:
    (models / HAND_FINDER.filename).write_bytes(b"taught by a team")
    assert finder_path() == models / HAND_FINDER.filename


def test_a_finder_that_is_missing_is_none_and_a_damaged_one_is_told(
    models: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.recognition.models.storage.TAUGHT", tmp_path)
    assert finder_path() is gloves_path() is None
    (tmp_path / HAND_FINDER.filename).write_bytes(b"cut off")
    with pytest.raises(ModelError, match="not the pinned one"):
        finder_path()
