"""`osg-studio robot`, run as on a robot: a process of its own, real frames, signals, pipes."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from typer.main import get_command

from app.cli.application import command_line
from app.cli.robots.ros_arguments import split_ros_arguments
from app.robot.event_messages import read_schema
from app.robot.stage_profile import STAGES
from tests.command_line import OsgStudio
from tests.conftest import ROOT
from tests.documented import documented
from tests.recognition.damaged_clips import write_clip
from tests.robot.languages import language_of, spoken
from tests.robot.mjpeg_server import MjpegServer
from tests.test_layers import modules_of, requirements_of

DOCUMENTED = [split_ros_arguments(command)[0] for command in documented()]
ON_A_CLIP = documented("robot", page="robots/without-ros.md")[0]

WITHOUT_THE_WEB_APP = f"""
import sys
sys.modules.update(dict.fromkeys({sorted(modules_of(requirements_of("studio")))!r}))
from app.cli.application import main
main(sys.argv[1:])
"""


@contextmanager
def running(*arguments: str | Path) -> Iterator[subprocess.Popen[str]]:
    """Run the command in a process in which the web app's packages cannot be imported."""
    process = subprocess.Popen(
        [sys.executable, "-c", WITHOUT_THE_WEB_APP, *map(str, arguments)],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    with process:
        try:
            yield process
        finally:
            process.kill()


def until(process: subprocess.Popen[str], event: str) -> dict[str, Any]:
    """Read lines up to the first one of an event."""
    assert process.stdout is not None
    for line in process.stdout:
        content: dict[str, Any] = json.loads(line)
        if content["event"] == event:
            return content
    raise AssertionError(f"no {event!r} was printed")


@pytest.fixture
def language(tmp_path: Path) -> Path:
    file = tmp_path / "pool.json"
    language_of("circle").save(file)
    return file


@pytest.mark.parametrize("arguments", DOCUMENTED, ids=" ".join)
def test_a_documented_command_is_one(arguments: list[str]) -> None:
    command = get_command(command_line)
    for word in list(arguments):
        with command.make_context("osg-studio", list(arguments), resilient_parsing=True) as context:
            found = getattr(command, "get_command", lambda context, word: None)(context, word)
        if found is None:
            break
        command, arguments = found, arguments[1:]
    command.make_context("osg-studio", arguments)


@pytest.mark.slow
def test_of_a_clip_the_robot_says_what_recognize_says_and_needs_no_web_app(
    osg_studio: OsgStudio, thin_clip: Callable[[str], Path]
) -> None:
    language, documented_clip = (
        Path(ON_A_CLIP[ON_A_CLIP.index(option) + 1]) for option in ("--language", "--source")
    )
    clip = thin_clip(documented_clip.stem)
    command = (clip if each == str(documented_clip) else each for each in ON_A_CLIP)
    with running(*command) as process:
        out, error = process.communicate()
    assert process.returncode == 0, error
    events = [json.loads(line) for line in out.splitlines()]
    schema = jsonschema.Draft202012Validator(json.loads(read_schema()))
    for each in events:
        schema.validate(each)
    recognized = osg_studio("recognize", clip, "--language", ROOT / language, "--json")
    takes = json.loads(recognized.out)["takes"]
    said = [each for each in events if each["event"].startswith("take_")]
    compared = ("start", "end", "closed", "label", "nearest", "confidence")
    assert takes
    assert [[each[key] for key in compared] for each in said] == [
        [take[key] for key in compared] for take in takes
    ]
    assert events[-1]["event"] == "source_ended"
    assert f"{said[0]['label']} (" in error


@pytest.mark.slow
def test_a_camera_is_watched_until_somebody_ends_it(language: Path, installed_models: None) -> None:
    with (
        MjpegServer() as server,
        running("robot", "--language", language, "--source", server.address) as process,
    ):
        first = until(process, "language_changed")
        until(process, "state_changed")
        language_of("circle", "line", revision=2).save(language)
        second = until(process, "language_changed")
        process.send_signal(signal.SIGHUP)
        third = until(process, "language_changed")
        language.write_text("{}")
        refused = until(process, "language_refused")
        process.send_signal(signal.SIGTERM)
        ended = until(process, "source_ended")
        _, error = process.communicate()
    assert first["sha256"] == spoken("circle").sha256
    assert second["sha256"] == third["sha256"] == spoken("circle", "line", revision=2).sha256
    assert refused["revision"] == 2
    assert ended["stopped"]
    assert process.returncode == 0, error
    assert "secret" not in error


@pytest.mark.slow
def test_who_reads_no_more_ends_the_robot_without_complaint(
    language: Path, installed_models: None
) -> None:
    with (
        MjpegServer() as server,
        running("robot", "--language", language, "--source", server.address) as process,
    ):
        until(process, "source_opened")
        assert process.stdout is not None
        process.stdout.close()
        process.send_signal(signal.SIGHUP)  # something to tell
        assert process.stderr is not None
        error = process.stderr.read()
    assert process.returncode == 0, error
    assert "Error" not in error
    assert "Traceback" not in error


@pytest.mark.slow
def test_the_cost_of_each_stage_is_one_object_and_a_table(
    osg_studio: OsgStudio,
    installed_models: None,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    (command,) = documented("robot", page="robots/performance.md")
    spoken, clip = (Path(command[command.index(it) + 1]) for it in ("--language", "--source"))
    (tmp_path / clip).parent.mkdir(parents=True)
    (tmp_path / spoken).symlink_to(ROOT / spoken)
    write_clip(tmp_path / clip, frames=12)
    monkeypatch.chdir(tmp_path)
    ended = osg_studio(*command)
    assert ended.code == 0
    profile = json.loads(ended.out)
    assert profile["frames"] == 2
    assert [stage["up_to"] for stage in profile["stages"]] == list(STAGES)
    assert "+ recognition" in ended.error
    assert f"2 frames, {profile['takes']} take" in " ".join(ended.error.split())


@pytest.mark.parametrize(
    ("arguments", "what"),
    [
        (["--language", "absent.json"], "absent.json"),
        (["--language", "{language}", "--source", "absent.mp4"], "absent.mp4"),
        (["--language", "{language}", "--source", "63"], "camera 63"),
        (["--language", "{language}", "--source", "rtsp://a:b@127.0.0.1:1/"], "127.0.0.1:1"),
        (["--language", "{language}", "--profile", "no"], "no profile 'no'"),
        (["--language", "{language}", "--profile", "paper", "--without-salutes"], "profile full"),
        (["--language", "{language}", "--source", "{clip}", "--hands", "none"], "no salute"),
        (["--language", "{language}", "--source", "{clip}", "--estimator", "no"], "backend 'no'"),
    ],
)
def test_bad_input_is_one_line_and_exit_code_two(
    osg_studio: OsgStudio,
    installed_models: None,
    language: Path,
    tmp_path: Path,
    arguments: list[str],
    what: str,
) -> None:
    clip = write_clip(tmp_path / "dive.mp4", frames=2)
    names = {"language": language, "clip": clip}
    ended = osg_studio("robot", *[each.format(**names) for each in arguments])
    assert (ended.code, ended.out) == (2, "")
    assert ended.error.startswith("osg-studio: ")
    assert what in ended.error
    assert ended.error.count("\n") == 1
    assert "a:b" not in ended.error
