"""Triggers on the command line: shown, set from clips, and used where no hand can be seen."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from app.cli.clip_argument import spot_takes
from app.evaluation.labelled_takes import LAYOUTS
from app.recognition import Language, PoseSequence, Recognizer
from app.recognition.poses.landmarks import POSE_LANDMARKS
from app.recognition.spotting import Spotter
from tests.command_line import OsgStudio
from tests.keypoint_files.files import write_openpose
from tests.posed import BY_BELLY, posed_clip, posed_language, posed_recording

OPENPOSE = tuple(
    name
    for name in POSE_LANDMARKS
    if name.split("_")[-1] in {"nose", "shoulder", "elbow", "wrist", "hip", "knee", "ankle"}
)
RATE = ("--frame-rate", "25")


def keypoints(path: Path, name: str) -> Path:
    """Write a clip's landmarks as a keypoint file without hands."""
    shown = posed_recording(name).poses
    poses: PoseSequence = replace(shown.select(OPENPOSE), confidence=None, world=None)
    return write_openpose(path, poses)


@pytest.fixture
def clips(tmp_path: Path) -> dict[str, Path]:
    names = ("circle-by-belly", "circle-by-belly-2", "wedge-by-belly", "wedge-by-belly-and-head")
    return {name: keypoints(tmp_path / name, name) for name in names}


def test_a_language_with_an_arm_trigger_is_made_and_used_without_any_hand(
    osg_studio: OsgStudio, tmp_path: Path, clips: dict[str, Path]
) -> None:
    trigger, pool = tmp_path / "belly.json", tmp_path / "pool.json"
    ended = osg_studio("trigger", trigger, "--pose", f"{clips['circle-by-belly']}@1-2", *RATE)
    assert ended.code == 0, ended.error
    assert "left hand before the body" in ended.error
    given = [f"{name}={clips[f'{name}-by-belly']}" for name in ("circle", "wedge")]
    ended = osg_studio(
        "define", *given, "--name", "pool", "--output", pool, "--trigger", trigger, *RATE
    )
    assert ended.code == 0, ended.error
    assert Language.load(pool).trigger == Language.load(trigger).trigger
    ended = osg_studio("recognize", clips["circle-by-belly-2"], "--language", pool, "--json", *RATE)
    assert ended.code == 0, ended.error
    (take,) = json.loads(ended.out)["takes"]
    assert take["label"] == "circle"
    assert "salute" not in ended.error
    ended = osg_studio("demonstrations", "add", pool, f"circle={clips['circle-by-belly-2']}", *RATE)
    assert ended.code == 0, ended.error


def test_a_trigger_is_shown_and_changed(
    osg_studio: OsgStudio, tmp_path: Path, clips: dict[str, Path]
) -> None:
    file = tmp_path / "pool.json"
    Language("pool").save(file)
    assert osg_studio("trigger", file).out == "between two salutes\n"
    pose, stop = (f"{clips['wedge-by-belly-and-head']}@{span}" for span in ("1-2", "5.2-6.2"))
    assert osg_studio("trigger", file, "--pose", pose, "--stop", stop, *RATE).code == 0
    assert osg_studio("trigger", file).out.endswith("; left hand at the head)\n")
    assert osg_studio("trigger", file, "--none").code == 0
    assert osg_studio("trigger", file).out == "without a trigger, gestures anywhere\n"
    assert osg_studio("trigger", file, "--salute").code == 0
    assert Language.load(file).revision == 4
    assert "trigger" not in json.loads(file.read_text())


def test_gestures_between_a_trigger_gesture_are_found(
    osg_studio: OsgStudio, tmp_path: Path, clips: dict[str, Path]
) -> None:
    pool = tmp_path / "pool.json"
    posed_language().save(pool)
    ended = osg_studio("trigger", pool, "--gesture", "wedge", "--stop-gesture", "circle")
    assert ended.code == 0, ended.error
    assert osg_studio("trigger", pool).out == "between the gestures 'wedge' and 'circle'\n"
    asked = ("recognize", clips["circle-by-belly"], "--language", pool, *RATE)
    assert osg_studio(*asked).code == 1
    assert osg_studio(*asked, "--without-salutes").code == 0
    ended = osg_studio("trigger", pool, "--gesture", "line")
    assert (ended.code, "needs a gesture 'line'" in ended.error) == (2, True)


def test_a_clip_that_holds_no_pose_is_refused_by_name(
    osg_studio: OsgStudio, tmp_path: Path, clips: dict[str, Path]
) -> None:
    file = tmp_path / "pool.json"
    ended = osg_studio("trigger", file, "--pose", f"{clips['circle-by-belly']}@3-4", *RATE)
    assert ended.code == 2
    assert "circle-by-belly@3-4: the arms are never still" in ended.error
    assert not file.exists()
    for options in (("--none", "--salute"), ("--stop", "clip.mp4")):
        ended = osg_studio("trigger", file, *options)
        assert (ended.code, "give one of --pose" in ended.error) == (2, True)


def test_a_language_without_trigger_finds_gestures_anywhere(
    osg_studio: OsgStudio, tmp_path: Path, clips: dict[str, Path]
) -> None:
    pool = tmp_path / "pool.json"
    posed_language().save(pool)
    assert osg_studio("trigger", pool, "--none").code == 0
    ended = osg_studio("recognize", clips["circle-by-belly"], "--language", pool, "--json", *RATE)
    assert ended.code == 0, ended.error
    assert "circle" in [take["label"] for take in json.loads(ended.out)["takes"]]


def test_a_clip_without_the_pose_says_what_was_looked_for(
    osg_studio: OsgStudio, tmp_path: Path
) -> None:
    pool = tmp_path / "pool.json"
    posed_language().save(pool)
    shown = posed_recording("circle-by-belly").poses.between(2.6, 4.4).select(OPENPOSE)
    clip = write_openpose(tmp_path / "bare", replace(shown, confidence=None, world=None))
    ended = osg_studio("recognize", clip, "--language", pool, *RATE)
    assert ended.code == 1
    assert f"no take {BY_BELLY.words} found" in " ".join(ended.error.split())


def test_labelled_clips_are_evaluated_by_the_trigger_of_a_language(
    osg_studio: OsgStudio, tmp_path: Path
) -> None:
    pool = tmp_path / "pool.json"
    posed_language().save(pool)
    names = {"circle": ("circle-by-belly", "circle-by-belly-2"), "wedge": ("wedge-by-belly",)}
    for label, shown in names.items():
        (tmp_path / "takes" / label).mkdir(parents=True)
        for name in shown:
            posed_recording(name).save(tmp_path / "takes" / label / f"{name}.npz")
    asked = ("evaluate", tmp_path / "takes", "--profile", "full", "--layout", LAYOUTS[1])
    ended = osg_studio(*asked, "--language", pool)
    assert "100.0%" in ended.out, ended.error
    ended = osg_studio(*asked, "--trigger", pool)
    assert ended.code == 0, ended.error


def test_a_file_that_cannot_hold_a_trigger_is_said_to_lack_it(
    osg_studio: OsgStudio, tmp_path: Path
) -> None:
    pool = tmp_path / "pool.json"
    posed_language().save(pool)
    ended = osg_studio("convert", pool, tmp_path / "pool.ldf")
    assert "proteus knows no trigger" in " ".join(ended.error.split())
    ended = osg_studio("convert", pool, tmp_path / "copy.json")
    assert "knows no trigger" not in ended.error
    assert Language.load(tmp_path / "copy.json").trigger == BY_BELLY


def test_gestures_are_spotted_in_one_clip_after_another() -> None:
    spotter = Spotter(Recognizer(posed_language()))
    for name in ("circle-by-belly", "circle-by-belly-2"):
        found = spot_takes(spotter, posed_recording(name), None)
        assert "circle" in [recognition.label for _, recognition in found]


@pytest.mark.slow
def test_a_robot_hears_a_gesture_in_a_clip_without_any_hand(
    osg_studio: OsgStudio, tmp_path: Path, installed_models: None
) -> None:
    pool = tmp_path / "pool.json"
    posed_language().save(pool)
    clip = posed_clip("circle-by-belly-2")
    ended = osg_studio("robot", "--language", pool, "--source", clip, "--hands", "none")
    assert ended.code == 0, ended.error
    events = [json.loads(line) for line in ended.out.splitlines()]
    assert [each["label"] for each in events if each["event"] == "take_recognized"] == ["circle"]
