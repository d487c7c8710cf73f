"""`osg-studio robot`, run as on a robot: a process of its own, real frames, signals, pipes."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any
from urllib.request import Request, urlopen

import jsonschema
import pytest
from typer.main import get_command

from app.cli.application import command_line
from app.cli.robots.robot import split_ros_arguments
from app.robot.publishing.status_page import UPLOAD_TYPE
from tests.command_line import OsgStudio
from tests.conftest import ROOT
from tests.documented import documented
from tests.ports import free_port
from tests.published_schemas import ROBOT_EVENT
from tests.recognition.damaged_clips import write_clip
from tests.robot.languages import language_of, spoken
from tests.robot.mjpeg_server import MjpegServer
from tests.short_clips import thinned
from tests.test_layers import modules_of, requirements_of

DOCUMENTED = [split_ros_arguments(command)[0] for command in documented()]
ON_A_CLIP = documented("robot", page="robots/without-ros.md")[0]

EMERGENCY_TABLE = """
format = "osg-studio/vehicle-table"
version = 1
[emergency]
circle = "surface"
"""

WITHOUT_THE_WEB_APP = f"""
import sys
sys.modules.update(dict.fromkeys({sorted(modules_of(requirements_of("studio")))!r}))
from app.cli.application import main
main(sys.argv[1:])
"""


@contextmanager
def running(
    *arguments: str | Path, stdout: Any = subprocess.PIPE, stderr: Any = subprocess.PIPE
) -> Iterator[subprocess.Popen[str]]:
    """Run the command in a process in which the web app's packages cannot be imported."""
    process = subprocess.Popen(
        [sys.executable, "-c", WITHOUT_THE_WEB_APP, *map(str, arguments)],
        cwd=ROOT,
        stdout=stdout,
        stderr=stderr,
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
    schema = jsonschema.Draft202012Validator(ROBOT_EVENT.content)
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
def test_of_a_take_that_nobody_ended_robot_and_recognize_say_the_same(
    osg_studio: OsgStudio, sample_clips: Path, installed_models: None, tmp_path: Path
) -> None:
    clip = thinned(sample_clips / "circle-test-1.mp4", tmp_path / "open.mp4", share=0.6)
    language = sample_clips.parent / "osg-table-2.json"
    with running("robot", "--language", language, "--source", clip) as process:
        out, _ = process.communicate()
    assert process.returncode == 1
    said = [json.loads(line) for line in out.splitlines()]
    (rejected,) = [each for each in said if each["event"].startswith("take_")]
    recognized = osg_studio("recognize", clip, "--language", language, "--json")
    assert recognized.code == 1
    (take,) = json.loads(recognized.out)["takes"]
    assert (rejected["event"], rejected["closed"]) == ("take_rejected", False)
    assert (take["label"], take["closed"]) == (None, False)
    assert take["fault"] == "no second salute ended it"
    assert (rejected["nearest"], rejected["confidence"]) == (take["nearest"], take["confidence"])


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


def until_words(process: subprocess.Popen[str], words: str) -> str:
    """Read lines of stderr up to the first one with these words."""
    assert process.stderr is not None
    lines = []
    for line in process.stderr:
        if words in line:
            return line
        lines.append(line)
    raise AssertionError(f"nothing with {words!r} was printed, but {lines}")


@pytest.mark.withstands(row="H36")
@pytest.mark.slow
@pytest.mark.parametrize("full", ["stdout", "stderr"])
def test_a_full_disk_ends_a_log_and_not_the_robot(
    language: Path, installed_models: None, full: str
) -> None:
    arguments = ("robot", "--language", language, "--page", "0", "--source")
    with (
        MjpegServer() as server,
        open("/dev/full", "w") as disk,  # noqa: PTH123
        running(*arguments, server.address, **{full: disk}) as process,
    ):
        said = "is not written any more: No space left on device; recognition goes on"
        if full == "stdout":
            assert until_words(process, said).startswith("stdout")
            process.send_signal(signal.SIGHUP)
            until_words(process, "listening for")
        else:
            assert until(process, "output_failed")["output"] == "stderr"
            process.send_signal(signal.SIGHUP)
            until(process, "language_changed")
        process.send_signal(signal.SIGTERM)
        process.communicate()
    assert process.returncode == 4


@pytest.mark.slow
def test_a_reader_that_leaves_does_not_end_a_robot_that_commands_a_vehicle(
    language: Path, installed_models: None, tmp_path: Path
) -> None:
    pytest.importorskip("pymavlink", reason="needs the extra mavlink")
    from tests.robot.mavlink.vehicle import sailing

    table = tmp_path / "vehicle.toml"
    table.write_text(EMERGENCY_TABLE)
    with (
        MjpegServer() as server,
        sailing() as vehicle,
        running(
            *("robot", "--language", language, "--source", server.address, "--vehicle", table),
            *("--mavlink", f"udpout:127.0.0.1:{vehicle.port}"),
        ) as process,
    ):
        until(process, "recognition_ready")
        assert process.stdout is not None
        process.stdout.close()
        process.send_signal(signal.SIGHUP)
        assert "Broken pipe" in until_words(process, "stdout is not written any more")
        process.send_signal(signal.SIGHUP)
        until_words(process, "listening for")
        process.send_signal(signal.SIGTERM)
        assert process.stderr is not None
        process.stderr.read()
    assert process.returncode == 4
    assert "stdout cannot be written" in vehicle.texts


@pytest.mark.withstands(row="H36")
@pytest.mark.slow
@pytest.mark.parametrize("stalled", ["stdout", "stderr"])
def test_a_reader_that_stalls_keeps_no_emergency_from_a_vehicle(
    installed_models: None,
    sample_clips: Path,
    thin_clip: Callable[[str], Path],
    tmp_path: Path,
    stalled: str,
) -> None:
    pytest.importorskip("pymavlink", reason="needs the extra mavlink")
    from tests.robot.mavlink.vehicle import sailing

    table = tmp_path / "vehicle.toml"
    table.write_text(EMERGENCY_TABLE.replace("circle", "line"))
    language = sample_clips.parent / "osg-table-2.json"
    unread, end = os.pipe()
    os.set_blocking(end, False)
    with suppress(BlockingIOError):
        while True:
            os.write(end, b"x" * 4096)
    os.set_blocking(end, True)
    with (
        sailing() as vehicle,
        running(
            *("robot", "--language", language, "--source", thin_clip("line-test-1")),
            *("--mavlink", f"udpout:127.0.0.1:{vehicle.port}", "--vehicle", table),
            **{stalled: end},
        ) as process,
    ):
        process.communicate()
    os.close(unread)
    os.close(end)
    assert process.returncode == 4
    assert vehicle.obeyed == ["SURFACE"]
    assert f"{stalled} cannot be written" in vehicle.texts


@pytest.mark.slow
def test_a_robot_without_files_waits_for_them_on_its_page(
    installed_models: None, tmp_path: Path
) -> None:
    pytest.importorskip("pymavlink", reason="needs the extra mavlink")
    from tests.robot.mavlink.vehicle import sailing

    port = free_port()
    language, table = tmp_path / "language.json", tmp_path / "vehicle.toml"
    with (
        MjpegServer() as server,
        sailing() as vehicle,
        running(
            *("robot", "--language", language, "--source", server.address),
            *("--page", f"127.0.0.1:{port}", "--upload"),
            *("--mavlink", f"udpout:127.0.0.1:{vehicle.port}", "--vehicle", table),
        ) as process,
    ):
        assert "language.json" in until_words(process, "waiting: ")
        status = json.loads(fetch(port, "/status.json"))
        assert "language.json" in status["waits_for"]
        assert json.loads(fetch(port, "/healthz")) == {"works": True}
        upload(port, "language", language_of("circle").to_json().encode())
        until(process, "recognition_ready")
        assert vehicle.texts == []
        upload(port, "vehicle", EMERGENCY_TABLE.encode())
        until(process, "source_ended")
        until(process, "recognition_ready")
        assert json.loads(fetch(port, "/status.json"))["files"] == {"missing": []}
        while "ready for gestures" not in vehicle.texts:
            time.sleep(0.05)
        upload(port, "language", language_of("circle", "line", revision=2).to_json().encode())
        assert until(process, "language_changed")["revision"] == 2
        process.send_signal(signal.SIGTERM)
        _, error = process.communicate()
    assert process.returncode == 0, error


def fetch(port: int, path: str) -> bytes:
    with urlopen(f"http://127.0.0.1:{port}{path}") as answer:
        return bytes(answer.read())


def upload(port: int, kind: str, content: bytes) -> None:
    """Upload a file, and confirm its changes."""
    address = f"http://127.0.0.1:{port}"
    headers = {"Origin": address, "Content-Type": UPLOAD_TYPE}
    token = None
    for _ in range(2):
        request = Request(f"{address}/files/{kind}", content, headers)
        with urlopen(request) as answer:
            token = json.loads(answer.read()).get("token")
        headers = {**headers, "Confirm": str(token)}
    assert token is None


@pytest.mark.parametrize(
    ("arguments", "what"),
    [
        (["--language", "absent.json"], "absent.json"),
        (["--language", "{language}", "--source", "absent.mp4"], "absent.mp4"),
        (["--language", "{language}", "--source", "{folder}"], "is a sequence of pictures"),
        (["--language", "{language}", "--source", "{folder}/f%04d.png"], "make a clip of it"),
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
    folder = tmp_path / "frames"
    folder.mkdir()
    (folder / "f0001.png").write_bytes(b"\x89PNG")
    names = {"language": language, "clip": clip, "folder": folder}
    ended = osg_studio("robot", *[each.format(**names) for each in arguments])
    assert (ended.code, ended.out) == (2, "")
    assert ended.error.startswith("osg-studio: ")
    assert what in ended.error
    assert ended.error.count("\n") == 1
    assert "a:b" not in ended.error


@pytest.mark.parametrize(
    ("given", "own", "ros"),
    [
        ("robot --ros2", "robot --ros2", ""),
        ("robot --ros-args -r a:=b", "robot", "--ros-args -r a:=b"),
        ("robot --ros-args -r a:=b -- --ros2", "robot --ros2", "--ros-args -r a:=b"),
        ("--ros-args -r a:=b -- -x --ros-args", "-x", "--ros-args -r a:=b --ros-args"),
        ("robot -- --ros2", "robot -- --ros2", ""),
    ],
)
def test_they_go_from_where_they_begin_to_where_they_end(given: str, own: str, ros: str) -> None:
    assert split_ros_arguments(given.split()) == (own.split(), ros.split())


def test_a_robot_that_is_not_to_publish_refuses_them(osg_studio: OsgStudio) -> None:
    ended = osg_studio("robot", "--language", "pool.json", "--ros-args", "-r", "__ns:=/auv")
    assert ended.code == 2
    assert "--ros-args needs --ros2: add that option" in " ".join(ended.error.split())


def test_no_other_command_takes_them(osg_studio: OsgStudio) -> None:
    ended = osg_studio("recognize", "clip.mp4", "--language", "pool.json", "--ros-args")
    assert ended.code == 2
    assert "No such option: --ros-args" in " ".join(ended.error.split())
