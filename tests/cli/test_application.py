"""The command line, run as a user runs it: files in, text and exit codes out."""

import json
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
from typer.main import get_command

from app import __version__
from app.recognition import Gesture, Language, PoseSequence
from tests.bags.bag_files import recorded
from tests.command_line import OsgStudio
from tests.conftest import ROOT

LANGUAGE = ROOT / "languages" / "osg-table-2.json"


def a_language(labels: Sequence[str] = ("sign",)) -> Language:
    time = np.linspace(0, 2, 40)
    wrist = np.stack([300 + 80 * np.cos(3 * time), 200 + 80 * np.sin(3 * time)], axis=1)
    poses = PoseSequence(
        landmarks=("right_wrist",), xy=wrist[:, None], time=time, frame_size=(640, 480)
    )
    gestures = [Gesture.from_demonstration(label, poses) for label in labels]
    return Language(name="pool", gestures=gestures)


@pytest.mark.slow
def test_version_is_printed_by_the_installed_command() -> None:
    run = subprocess.run(
        [sys.executable, "-m", "app", "--version"], capture_output=True, text=True, check=True
    )
    assert run.stdout.strip() == __version__


@pytest.mark.parametrize(
    ("arguments", "what"),
    [
        (["recognize", "absent.mp4", "--language", "{language}"], "absent.mp4"),
        (["recognize", "absent.mp4", "--language", "absent.json"], "absent.json"),
        (["recognize", "absent.mp4", "--language", "{language}", "--profile", "no"], "profile"),
        (["recognize", "absent.mp4", "--language", "{language}", "--expected", "spiral"], "spiral"),
        (["define", "circle", "--name", "pool", "--output", "out.json"], "LABEL=CLIP"),
        (["convert", "absent.json", "out.json"], "absent.json"),
        (["convert", "{language}", "no/such/folder/out.json"], "no/such/folder"),
        (["models", "install", "--source", "absent"], "absent"),
        (["serve", "--host", "0.0.0.0", "--no-browser"], "token"),
    ],
)
def test_bad_input_is_one_line_and_exit_code_two(
    osg_studio: OsgStudio,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    arguments: list[str],
    what: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("OSG_MODELS_DIR", str(tmp_path / "models"))
    a_language().save(tmp_path / "language.json")
    ended = osg_studio(*[argument.format(language="language.json") for argument in arguments])
    assert ended.code == 2
    assert ended.out == ""
    assert ended.error.startswith("osg-studio: ")
    assert what in ended.error
    assert ended.error.count("\n") == 1


@pytest.mark.parametrize("content", ["no json", '{"format": "osg-studio/gesture-language"}'])
def test_a_language_file_that_is_none_is_named(
    osg_studio: OsgStudio, tmp_path: Path, content: str
) -> None:
    path = tmp_path / "bad.json"
    path.write_text(content)
    for command in (["robot", "--source", "none", "--language"], ["check"]):
        ended = osg_studio(*command, path)
        assert ended.code == 2
        assert ended.error.startswith("osg-studio: bad.json: ")
        assert ended.error.count("bad.json") == 1


def test_a_backup_that_cannot_be_made_or_restored_is_one_line(
    osg_studio: OsgStudio, tmp_path: Path
) -> None:
    for command in ("backup", "restore"):
        ended = osg_studio(command, tmp_path / "b.zip", "--data-dir", tmp_path / "none")
        assert ended.code == 2
        assert ended.error.count("\n") == 1
    assert not (tmp_path / "b.zip").exists()


def test_a_crash_has_a_code_of_its_own(
    osg_studio: OsgStudio, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object, **__: object) -> None:
        raise IndexError("index -1 is out of bounds")

    monkeypatch.setattr("app.cli.robots.robot_options.create_listener", fail)
    a_language().save(tmp_path / "language.json")
    ended = osg_studio("robot", "--language", tmp_path / "language.json", "--source", "none")
    assert ended.code == 3
    assert "Traceback" in ended.error


def test_an_unknown_command_is_bad_use(osg_studio: OsgStudio) -> None:
    assert osg_studio("dance").code == 2


def test_converting_to_the_published_format_and_back_keeps_labels_and_images(
    osg_studio: OsgStudio, tmp_path: Path
) -> None:
    ours, published, back = (tmp_path / f"{name}.json" for name in ("ours", "published", "back"))
    language = a_language(["circle", "wedge"])
    language.save(ours)
    assert osg_studio("convert", ours, published, "--format", "osg-reference").code == 0
    document = json.loads(published.read_text())
    assert list(document) == ["circle", "wedge"]
    assert document["circle"]["salient_keypoints"] == ["RIGHT_WRIST"]
    ended = osg_studio("convert", published, back)
    assert ended.code == 0
    assert "no trajectories" in " ".join(ended.error.split())
    for before, after in zip(language.gestures, Language.load(back).gestures, strict=True):
        np.testing.assert_array_equal(before.image, after.image)


def test_models_are_listed_with_their_state(
    osg_studio: OsgStudio, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("OSG_MODELS_DIR", str(tmp_path))
    ended = osg_studio("models")
    states = {line.split("\t")[0]: line.split("\t")[1] for line in ended.out.splitlines()}
    assert states["pose_landmark_full"] == "missing"
    assert states["hand_landmark_full"] == "missing"


def test_exported_models_install_elsewhere_without_network(
    osg_studio: OsgStudio, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert osg_studio("models", "export", tmp_path / "stick").code == 0
    monkeypatch.setenv("OSG_MODELS_DIR", str(tmp_path / "robot"))
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    assert osg_studio("models", "install", "--source", tmp_path / "stick").code == 0
    assert {line.split("\t")[1] for line in osg_studio("models").out.splitlines()} == {"ok"}


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_a_shell_completes_commands_and_options(
    osg_studio: OsgStudio, monkeypatch: pytest.MonkeyPatch, shell: str
) -> None:
    # Otherwise the shell is detected from the parent processes, which may include none in tests.
    monkeypatch.setenv("_TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION", "1")
    monkeypatch.setattr("app.cli.application._build_command", get_command)  # for this variable
    assert "osg-studio" in osg_studio("--show-completion", shell).out
    typed = {"COMP_WORDS": "osg-studio rec", "COMP_CWORD": "1"}
    typed |= {"_TYPER_COMPLETE_ARGS": "osg-studio rec", "_TYPER_COMPLETE_FISH_ACTION": "get-args"}
    for name, value in (typed | {"_OSG_STUDIO_COMPLETE": f"complete_{shell}"}).items():
        monkeypatch.setenv(name, value)
    completed = osg_studio().out
    assert "recognize" in completed
    assert "serve" not in completed


@pytest.mark.slow
def test_a_language_defined_from_clips_recognises_another_take(
    osg_studio: OsgStudio, tmp_path: Path, thin_clip: Callable[[str], Path]
) -> None:
    file = tmp_path / "pool.json"
    demonstrations = [
        f"{label}={thin_clip(f'{label}-demonstration')}" for label in ("circle", "line")
    ]
    defined = osg_studio("define", *demonstrations, "--name", "pool", "--output", file)
    assert defined.code == 0, defined.error
    assert defined.out == ""
    clip = thin_clip("line-test-1")
    ended = osg_studio("recognize", clip, "--language", file, "--expected", "circle", "--json")
    assert ended.code == 0
    report = json.loads(ended.out)
    assert list(report) == ["clip", "language", "profile", "takes"]
    (take,) = report["takes"]
    assert take["closed"] is True
    assert 0 < take["start"] < take["end"]
    assert take["label"] == take["nearest"] == "line"
    assert take["gestures"] == ["circle", "line"]
    assert set(take["votes"]) <= set(take["voters"]) == set(take["weights"])
    assert np.shape(take["distances"]) == (len(take["voters"]), 2)
    assert (take["explanation"]["expected"], take["explanation"]["right"]) == ("circle", False)
    assert len(take["explanation"]["sentence"].split()) <= 15


def test_a_clip_without_salute_ends_with_one_and_says_how_to_go_on(
    osg_studio: OsgStudio, tmp_path: Path
) -> None:
    clip = recorded("ordinary-movement", tmp_path)
    ended = osg_studio("recognize", clip, "--language", LANGUAGE, "--json")
    assert ended.code == 1
    assert json.loads(ended.out)["takes"] == []
    assert "@START-END" in "".join(ended.error.split())
    ended = osg_studio("recognize", clip, "--language", LANGUAGE, "--without-salutes", "--json")
    assert ended.code == 1
    assert json.loads(ended.out)["takes"] == []


def test_a_gesture_is_found_without_looking_for_salutes(
    osg_studio: OsgStudio, tmp_path: Path
) -> None:
    clip = recorded("circle-test-1", tmp_path)
    ended = osg_studio("recognize", clip, "--language", LANGUAGE, "--without-salutes", "--json")
    assert ended.code == 0
    (take,) = json.loads(ended.out)["takes"]
    assert take["label"] == "circle"
    assert take["closed"] is True


def test_a_range_by_hand_needs_no_salute_and_a_take_of_none_is_judged(
    osg_studio: OsgStudio, tmp_path: Path
) -> None:
    clip = recorded("circle-test-1", tmp_path)
    arguments = ("recognize", f"{clip}@2.4-4.2", "--language", LANGUAGE, "--expected", "-")
    ended = osg_studio(*arguments)
    assert ended.code == 0
    assert "shows none of these: read as 'circle', wrong" in ended.error
    assert ended.out.split("\t")[:3] == ["2.40", "4.20", "circle"]


def test_what_is_no_gesture_is_rejected_and_ends_with_one(
    osg_studio: OsgStudio, tmp_path: Path
) -> None:
    clip = recorded("ordinary-movement", tmp_path)
    ended = osg_studio("recognize", f"{clip}@2.5-4.5", "--language", LANGUAGE, "--json")
    assert ended.code == 1
    (take,) = json.loads(ended.out)["takes"]
    assert take["label"] is None
    assert take["nearest"] in take["gestures"]


def test_a_demonstration_without_a_closed_take_is_refused(
    osg_studio: OsgStudio, tmp_path: Path
) -> None:
    clip = recorded("ordinary-movement", tmp_path)
    file = tmp_path / "pool.json"
    ended = osg_studio("define", f"idle={clip}", "--name", "pool", "--output", file)
    assert ended.code == 2
    assert "needs one closed take" in ended.error
    assert not file.exists()


@pytest.mark.parametrize(
    ("variable", "value", "words"),
    [("OSG_PORT", "70000", "65535"), ("OSG_HOST", "0.0.0.0", "token")],
)
def test_serve_uses_the_settings_of_the_environment(
    osg_studio: OsgStudio, monkeypatch: pytest.MonkeyPatch, variable: str, value: str, words: str
) -> None:
    monkeypatch.delenv("OSG_TOKEN", raising=False)
    monkeypatch.setenv(variable, value)
    ended = osg_studio("serve", "--no-browser")
    assert ended.code != 0
    assert words in ended.error
