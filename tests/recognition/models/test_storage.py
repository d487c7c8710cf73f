"""The models folder: a damaged file is reported with the command that repairs it."""

import os
from pathlib import Path
from typing import get_args

import pytest

from app.recognition.errors import ModelError
from app.recognition.models import (
    ModelName,
    TaskBundleName,
    installed_models,
    model_path,
    models_dir,
    task_bundle_path,
)
from app.recognition.models.storage import PACKAGED, write_file

NAMES: tuple[ModelName, ...] = get_args(ModelName)
BUNDLES: tuple[TaskBundleName, ...] = get_args(TaskBundleName)


def test_every_model_and_bundle_of_a_complete_folder_is_found(models: Path) -> None:
    assert [model_path(name) for name in NAMES] == [models / f"{name}.onnx" for name in NAMES]
    assert [task_bundle_path(name) for name in BUNDLES] == [
        models / f"{name}.task" for name in BUNDLES
    ]


def test_a_complete_folder_lists_every_file_as_ok(models: Path) -> None:
    listed = installed_models()
    assert {one.path for one in listed} == set(models.iterdir())
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
