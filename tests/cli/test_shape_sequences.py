"""Sequences of two held hand shapes on the command line: defined, listed, recognised, checked."""

from __future__ import annotations

from pathlib import Path

import pytest

from app.recognition import Language
from app.recognition.poses.frame import Hand
from tests.command_line import OsgStudio
from tests.keypoint_files.files import write_openpose
from tests.recognition.held_takes import FIST, FLAT, follow, hold
from tests.recognition.parametric_hand import Fingers, salute

RATE = ("--frame-rate", "25", "--frame-size", "640x480")


def write_clip(path: Path, *shapes: Fingers, seed: int = 0) -> Path:
    """Write keypoints of hand shapes one after the other between two salutes."""
    shown = (salute(gap=34), *shapes, salute(gap=34))
    takes = (hold(each, frames=30, seed=seed + n, thumb=60) for n, each in enumerate(shown))
    poses = follow(*takes, transition=0.2)
    assert poses.hands is not None
    hands = [[Hand(frame[1], "right", 1.0)] for frame in poses.hands]
    return write_openpose(path, poses, hands=hands)


@pytest.fixture
def signs(osg_studio: OsgStudio, tmp_path: Path) -> Path:
    """Return the file of a language of a sequence and its first shape."""
    file = tmp_path / "signs.json"
    clips = {
        "again": write_clip(tmp_path / "again", FLAT, FIST),
        "stop": write_clip(tmp_path / "stop", FLAT),
    }
    given = [f"{label}={clip}" for label, clip in clips.items()]
    ended = osg_studio("define", *given, "--name", "signs", "--output", file, *RATE)
    assert ended.code == 0, ended.error
    assert "held hand shapes: right hand, two in sequence" in ended.error
    assert "held hand shape: right hand" in ended.error
    return file


def test_a_sequence_is_defined_and_recognised(
    osg_studio: OsgStudio, signs: Path, tmp_path: Path
) -> None:
    shapes = [len(gesture.held_shapes) for gesture in Language.load(signs).gestures]
    assert shapes == [2, 1]
    for name, shown, label in (("right", (FLAT, FIST), "again"), ("one", (FLAT,), "stop")):
        clip = write_clip(tmp_path / name, *shown, seed=9)
        ended = osg_studio("recognize", clip, "--language", signs, *RATE)
        assert (ended.code, label in ended.out) == (0, True), ended.out + ended.error
    swapped = write_clip(tmp_path / "swapped", FIST, FLAT, seed=9)
    ended = osg_studio("recognize", swapped, "--language", signs, "--expected", "again", *RATE)
    assert ended.code == 1
    assert "The shapes come in the other order" in ended.out + ended.error


def test_three_shapes_are_refused_in_one_line(osg_studio: OsgStudio, tmp_path: Path) -> None:
    clip = write_clip(tmp_path / "three", FLAT, FIST, FLAT)
    ended = osg_studio("define", f"x={clip}", "--name", "x", "--output", tmp_path / "x.json", *RATE)
    assert ended.code == 2
    assert "three hand shapes one after the other" in " ".join(ended.error.split())
