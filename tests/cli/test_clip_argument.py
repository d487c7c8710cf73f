"""Other pose estimators on the command line: real inference from a clip to a label."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from app.recognition import Language
from app.recognition.poses.landmarks import TORSO
from app.recognition.poses.skeletons import COCO_17
from tests.command_line import OsgStudio
from tests.documented import documented
from tests.marker_clips import RATE, marker_clip
from tests.recognition.demonstrations import pool
from tests.recognition.estimation.marker_models import save_yolo_pose
from tests.recognition.strategies import circle, line, recording


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a model that finds markers, as an Ultralytics export with ``imgsz=320`` would."""
    return save_yolo_pose(tmp_path_factory.mktemp("model") / "markers-pose.onnx", side=320)


WITHOUT_HANDS = ("--hands", "none", "--water", "off")
"""Options: the model finds no hands, and a colour correction would change the markers' colours."""


def arguments(model: Path) -> tuple[str, ...]:
    return ("--estimator", f"yolo-pose:{model}", *WITHOUT_HANDS)


@pytest.mark.slow
def test_a_language_is_defined_and_recognised_by_yolo_pose_as_documented(
    osg_studio: OsgStudio, tmp_path: Path, model: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, shape, frames in (("circle", circle, 30), ("line", line, 30), ("dive", circle, 24)):
        clip = marker_clip(tmp_path / f"{name}.mkv", shape, frames=frames)
        clip.rename(clip.with_suffix(".mp4"))
    (tmp_path / "yolo11n-pose.onnx").symlink_to(model)
    monkeypatch.chdir(tmp_path)
    (define,), (recognize,) = (
        documented(word, page="guides/pose-estimators.md") for word in ("define", "recognize")
    )
    defined = osg_studio(*define, *WITHOUT_HANDS)
    assert defined.code == 0, defined.error
    language = Language.load(tmp_path / "pool.json")
    for gesture in language.gestures:
        assert gesture.salient == ("right_wrist",)
        assert gesture.trajectory is not None
        assert set(gesture.trajectory.landmarks) <= {*COCO_17, TORSO}
    ended = osg_studio(*recognize, "--json", *WITHOUT_HANDS)
    assert ended.code == 0, ended.error
    (take,) = json.loads(ended.out)["takes"]
    assert take["label"] == "circle"
    assert (take["start"], take["end"]) == (0, pytest.approx(23 / RATE, abs=0.01))


@pytest.mark.slow
def test_a_language_of_mediapipe_is_understood_by_yolo_pose(
    osg_studio: OsgStudio, tmp_path: Path, model: Path
) -> None:
    file = tmp_path / "pool.json"
    pool(circle=circle, line=line).save(file)
    clip = marker_clip(tmp_path / "line.mkv", line)
    ended = osg_studio("recognize", clip, "--language", file, "--json", *arguments(model))
    assert ended.code == 0, ended.error
    assert [take["label"] for take in json.loads(ended.out)["takes"]] == ["line"]
    error = " ".join(ended.error.split())
    assert "this pose model gives no left_pinky, right_pinky, left_index" in error
    assert "no hand" not in error


def test_a_language_that_follows_a_finger_is_refused_before_the_clip_is_read(
    osg_studio: OsgStudio, tmp_path: Path, model: Path
) -> None:
    from app.recognition import Gesture

    file = tmp_path / "pool.json"
    poses = recording(circle, hand="right_index")
    pointed = Gesture.from_demonstration("pointed", poses, salient=["right_index"])
    Language("fingers", [pointed]).save(file)
    clip = tmp_path / "unread.mkv"
    clip.write_text("no video at all")
    ended = osg_studio("recognize", clip, "--language", file, *arguments(model))
    assert ended.code == 2
    assert "gives no landmark 'right_index', which 'pointed' of 'fingers' follows" in ended.error


@pytest.mark.slow
def test_the_robot_says_by_yolo_pose_what_recognize_says(
    osg_studio: OsgStudio, tmp_path: Path, model: Path
) -> None:
    file = tmp_path / "pool.json"
    pool(circle=circle, line=line).save(file)
    clip = marker_clip(tmp_path / "line.mkv", line)
    options: tuple[str | Path, ...] = (
        "--language",
        file,
        "--without-salutes",
        *arguments(model),
    )
    ended = osg_studio("recognize", clip, "--json", *options)
    takes = json.loads(ended.out)["takes"]
    assert [take["label"] for take in takes] == ["line"]
    ended = osg_studio("robot", "--source", clip, *options)
    assert ended.code == 0, ended.error
    events = [json.loads(line) for line in ended.out.splitlines()]
    recognised = [event for event in events if event["event"] == "take_recognized"]
    for event, take in zip(recognised, takes, strict=True):
        for key in ("label", "start", "end", "confidence"):
            assert event[key] == pytest.approx(take[key], abs=1e-6), key


def test_a_robot_without_hands_waits_for_no_salute(
    osg_studio: OsgStudio, tmp_path: Path, model: Path
) -> None:
    file = tmp_path / "pool.json"
    pool(circle=circle).save(file)
    clip = marker_clip(tmp_path / "circle.mkv", circle, frames=2)
    ended = osg_studio("robot", "--language", file, "--source", clip, *arguments(model))
    assert ended.code == 2
    assert "finds no hand and so no salute" in ended.error


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--estimator", "yolo-pose"), "yolo-pose needs its model file"),
        (("--estimator", "yolo-pose:nowhere.onnx"), "no model file nowhere.onnx"),
        (("--estimator", "openpose"), "unknown backend 'openpose'"),
        (("--hands", "two"), "unknown hands 'two'"),
        (("--estimator", "mediapipe", "--hands", "none"), "finds the hands itself"),
    ],
)
def test_what_cannot_be_used_is_one_line(
    osg_studio: OsgStudio, tmp_path: Path, options: tuple[str, ...], message: str
) -> None:
    file = tmp_path / "pool.json"
    pool(circle=circle).save(file)
    clip = tmp_path / "clip.mkv"
    clip.touch()
    ended = osg_studio("recognize", clip, "--language", file, *options)
    assert (ended.code, ended.out) == (2, "")
    assert message in ended.error
    assert ended.error.count("\n") == 1
