"""Other programs' keypoint files where the command line takes clips."""

from __future__ import annotations

import importlib
import json
from dataclasses import replace
from pathlib import Path

import jsonschema
import numpy as np
import pytest

from app.cli.recognize import RecognitionReport
from app.recognition import Gesture, Language
from app.recognition.gestures.profile import Tuning
from app.recognition.poses.frame import Hand
from app.recognition.poses.skeletons import BODY_25, COCO_18
from tests.command_line import OsgStudio, Outcome
from tests.documented import documented
from tests.keypoint_files.files import (
    renamed,
    sleap_labels,
    write_deeplabcut,
    write_hands,
    write_named,
    write_numbered,
    write_openpose,
)
from tests.published_schemas import RECOGNITION_REPORT
from tests.recognition.demonstrations import pool
from tests.recognition.parametric_hand import hand_xy, salute
from tests.recognition.strategies import BODY, Shape, circle, line, recording

ARMS = tuple(BODY)


@pytest.fixture
def language(tmp_path: Path) -> Path:
    """Return the file of a language of a circle and a line."""
    pool(circle=circle, line=line).save(tmp_path / "pool.json")
    return tmp_path / "pool.json"


def recognize_circle(
    osg_studio: OsgStudio, folder: Path, *options: str, **shapes: Shape
) -> Outcome:
    """Recognise a take of a circle by a language of these shapes."""
    pool(**shapes).save(folder / "pool.json")
    write_named(folder / "dive.csv", recording(circle, frames=50, jitter=0.005))
    return osg_studio(
        "recognize", folder / "dive.csv", "--language", folder / "pool.json", *options
    )


def test_a_take_between_two_gestures_is_a_question_and_nothing_is_recognised(
    osg_studio: OsgStudio, tmp_path: Path
) -> None:
    shapes = {"circle": circle, "ring": circle, "line": line}
    ended = recognize_circle(osg_studio, tmp_path, **shapes)
    assert ended.code == 1
    assert ended.out.split("\t")[2] == "circle or ring?"
    ended = recognize_circle(osg_studio, tmp_path, "--json", **shapes)
    assert ended.code == 1
    (take,) = json.loads(ended.out)["takes"]
    assert (take["label"], take["pair"]) == (None, ["circle", "ring"])
    jsonschema.validate(json.loads(ended.out), RECOGNITION_REPORT.content)
    assert RecognitionReport.model_validate_json(ended.out).takes[0].pair == ("circle", "ring")


def test_a_take_between_three_gestures_is_rejected_with_their_names(
    osg_studio: OsgStudio, tmp_path: Path
) -> None:
    ended = recognize_circle(osg_studio, tmp_path, circle=circle, ring=circle, loop=circle)
    assert ended.code == 1
    assert ended.out.split("\t")[2] == "None"
    assert "lies between circle, ring and loop" in " ".join(ended.error.split())


def test_a_language_is_defined_from_a_folder_of_openpose_and_understands_another(
    osg_studio: OsgStudio, tmp_path: Path
) -> None:
    folders = {
        shape.__name__: write_openpose(
            tmp_path / shape.__name__, recording(shape, landmarks=ARMS), BODY_25
        )
        for shape in (circle, line)
    }
    file = tmp_path / "pool.json"
    defined = osg_studio(
        "define",
        *(f"{label}={folder}" for label, folder in folders.items()),
        *("--name", "pool", "--output", file, "--frame-rate", "30"),
    )
    assert defined.code == 0, defined.error
    assert {gesture.salient for gesture in Language.load(file).gestures} == {("right_wrist",)}
    again = recording(circle, landmarks=ARMS, frames=50, jitter=0.005, torso=80)
    folder = write_openpose(tmp_path / "again", again, COCO_18)
    ended = osg_studio("recognize", folder, "--language", file, "--frame-rate", "30", "--json")
    assert ended.code == 0, ended.error
    (take,) = json.loads(ended.out)["takes"]
    assert (take["label"], take["closed"]) == ("circle", True)


def test_the_documented_commands_do_what_they_say(
    osg_studio: OsgStudio, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    library = importlib.import_module("sleap_io")
    for shape in (circle, line):
        poses = renamed(recording(shape, landmarks=ARMS), {"right_wrist": "claw"})
        labels = sleap_labels(library, [poses], tracked=False)
        library.save_slp(labels, str(tmp_path / f"{shape.__name__}.slp"))
    write_openpose(tmp_path / "openpose-output", recording(circle, landmarks=ARMS))
    whole = recording(line)
    unseen = np.isin(whole.landmarks, ARMS, invert=True)
    xy = np.where(unseen[:, np.newaxis], np.nan, whole.xy)
    write_numbered(tmp_path / "landmarks.csv", replace(whole, xy=xy, frame_size=(1920, 1080)))
    monkeypatch.chdir(tmp_path)
    (define,) = documented("define", page="guides/keypoint-files.md")
    defined = osg_studio(*define)
    assert defined.code == 0, defined.error
    of_openpose, of_mediapipe = documented("recognize", page="guides/keypoint-files.md")
    ended = osg_studio(*of_openpose)
    assert ended.out.split("\t")[2] == "circle", ended.error
    assert "openpose-output: the folder gives no left_pinky" in " ".join(ended.error.split())
    ended = osg_studio(*of_mediapipe)
    assert ended.out.split("\t")[2] == "line", ended.error


def test_salutes_of_openpose_s_hands_cut_the_takes(
    osg_studio: OsgStudio, tmp_path: Path, language: Path
) -> None:
    poses = recording(line, landmarks=ARMS, frames=120)
    hand = Hand(hand_xy(salute()) * 60 + (200, 150), "right", 0.9)
    hands = [[hand] if index < 20 or index >= 100 else [] for index in range(120)]
    folder = write_openpose(tmp_path / "json", poses, BODY_25, hands=hands)
    ended = osg_studio("recognize", folder, "--language", language, "--frame-rate", "30", "--json")
    (take,) = json.loads(ended.out)["takes"]
    assert take["closed"]
    assert take["start"] == pytest.approx(19 / 30, abs=0.05)
    assert take["end"] == pytest.approx(100 / 30, abs=0.05)


def test_a_language_is_recognised_as_its_author_kept_it(
    osg_studio: OsgStudio, tmp_path: Path, language: Path
) -> None:
    tuning = Tuning(weights={"hu": 0.0})
    replace(Language.load(language), profile="paper", tuning=tuning).save(language)
    folder = write_openpose(tmp_path / "dive", recording(circle, landmarks=ARMS), BODY_25)
    command = ("recognize", folder, "--language", language, "--frame-rate", "30", "--json")
    report = json.loads(osg_studio(*command).out)
    assert (report["profile"], report["takes"][0]["weights"]["hu"]) == ("paper", 0.0)
    other = json.loads(osg_studio(*command, "--profile", "full").out)
    assert (other["profile"], other["takes"][0]["weights"]["velocity"] > 0) == ("full", True)


@pytest.mark.parametrize("form", ["numbered", "named", "deeplabcut"])
def test_tables_are_clips_too(
    osg_studio: OsgStudio, tmp_path: Path, language: Path, form: str
) -> None:
    poses = recording(line, frames=45)
    path = tmp_path / "dive.csv"
    if form == "numbered":
        write_numbered(path, poses)
    elif form == "named":
        write_named(path, poses)
    else:
        write_deeplabcut(path, {"diver": recording(line, frames=45, landmarks=ARMS)})
    ended = osg_studio(
        "recognize",
        *(path, "--language", language, "--json"),
        *("--frame-rate", "30", "--frame-size", "640x480"),
    )
    assert ended.code == 0, ended.error
    assert [take["label"] for take in json.loads(ended.out)["takes"]] == ["line"]


def test_a_range_and_no_salutes_work_as_for_clips(
    osg_studio: OsgStudio, tmp_path: Path, language: Path
) -> None:
    path = write_named(tmp_path / "dive.csv", recording(line, frames=60))
    ended = osg_studio("recognize", f"{path}@0-1.5", "--language", language, "--json")
    (take,) = json.loads(ended.out)["takes"]
    assert (take["start"], take["end"]) == (0, 1.5)
    ended = osg_studio("recognize", path, "--language", language, "--without-salutes", "--json")
    assert [found["label"] for found in json.loads(ended.out)["takes"]] == ["line"]


def test_a_long_recording_without_hands_is_not_one_gesture(
    osg_studio: OsgStudio, tmp_path: Path, language: Path
) -> None:
    path = write_named(tmp_path / "dive.csv", recording(line, frames=130, rate=2, landmarks=ARMS))
    ended = osg_studio("recognize", path, "--language", language)
    assert ended.code == 2
    assert "at most 60 s" in ended.error
    assert "--without-salutes" in ended.error


def test_a_landmark_that_the_file_lacks_is_named(osg_studio: OsgStudio, tmp_path: Path) -> None:
    poses = recording(circle, hand="right_index")
    pointed = Gesture.from_demonstration("pointed", poses, salient=["right_index"])
    Language("fingers", [pointed]).save(tmp_path / "fingers.json")
    folder = write_openpose(tmp_path / "json", recording(circle, landmarks=ARMS))
    ended = osg_studio(
        "recognize", folder, "--language", tmp_path / "fingers.json", "--frame-rate", "30"
    )
    assert ended.code == 2
    assert "gives no landmark 'right_index', which 'pointed' of 'fingers' follows" in ended.error


def test_a_keypoint_of_another_name_is_mapped_by_the_user(
    osg_studio: OsgStudio, tmp_path: Path, language: Path
) -> None:
    poses = renamed(recording(line, landmarks=ARMS, frames=45), {"right_wrist": "claw"})
    path = write_deeplabcut(tmp_path / "dive.csv", {"diver": poses})
    arguments = ("recognize", path, "--language", language, "--frame-rate", "30", "--json")
    ended = osg_studio(*arguments)
    assert ended.code == 2
    assert "gives no landmark 'right_wrist'" in ended.error
    ended = osg_studio(*arguments, "--landmark", "claw=right_wrist")
    assert ended.code == 0, ended.error
    assert [take["label"] for take in json.loads(ended.out)["takes"]] == ["line"]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ((), "--frame-rate 30"),
        (("--frame-rate", "0"), "the frame rate is 0"),
        (("--frame-rate", "30", "--frame-size", "huge"), "give WIDTHxHEIGHT"),
        (
            ("--frame-rate", "30", "--frame-size", "0x480"),
            "the frame size is 0x480, and a width of 0",
        ),
        (("--frame-rate", "30", "--landmark", "claw"), "not NAME=LANDMARK"),
        (("--frame-rate", "30", "--landmark", "fin=nose"), "no keypoint 'fin'"),
    ],
)
def test_what_cannot_be_used_is_one_line(
    osg_studio: OsgStudio, tmp_path: Path, language: Path, options: tuple[str, ...], message: str
) -> None:
    path = write_deeplabcut(tmp_path / "dive.csv", {"diver": recording(line, landmarks=ARMS)})
    ended = osg_studio("recognize", path, "--language", language, *options)
    assert (ended.code, ended.out) == (2, "")
    assert message in ended.error
    assert ended.error.count("\n") == 1


def test_an_empty_folder_is_refused(osg_studio: OsgStudio, tmp_path: Path, language: Path) -> None:
    (tmp_path / "empty").mkdir()
    ended = osg_studio("recognize", tmp_path / "empty", "--language", language)
    assert ended.code == 2
    assert "neither a dive recording (metadata.yaml) nor frames of OpenPose" in ended.error


def test_a_chapter_without_a_take_names_the_next_one(
    osg_studio: OsgStudio, language: Path, tmp_path: Path
) -> None:
    poses = recording(circle, frames=50)
    path = write_hands(tmp_path / "GX010042.csv", poses, hand_xy(salute()), "left_hand_{}_{}")
    options = ("--frame-rate", "30", "--frame-size", "640x480")
    ended = osg_studio("recognize", path, "--language", language, *options)
    assert ended.code == 1
    assert "GX010042.csv may go on in GX020042.csv" in (" ".join(ended.error.split()))
