"""A clip played into nodes of other processes is recognised as the file is."""

from __future__ import annotations

import itertools
import json
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import av
import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from osg_interfaces.msg import GestureRecognition, Hands
from sensor_msgs.msg import Image

from app.recognition.recording.video import read_frames
from osg_ros.topics.image_messages import to_image_message
from osg_ros.topics.stamps import to_nanoseconds, to_stamp
from tests.documented import documented
from tests.ros2 import workspace
from tests.ros2.nodes.bench import BEST_EFFORT, PATIENCE, RELIABLE, Bench
from tests.ros2.nodes.keypoint_messages import stamped

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("installed_models")]

BEGIN, END = 1.0, 5.4
"""Seconds of the sample: the gesture is from 2.0 to 4.5, the salutes last longer than needed."""

SEPARATE = ("pose_node", "hand_node", "recognition_node")
TOGETHER = ("gesture_process",)

ATTEMPTS = 5
"""A robot that plays a clip does not wait for listeners: on a busy machine the clip may be over
before the two processes have connected."""

ARRIVAL = 5.0
"""Seconds for messages acknowledged before the robot ended to pass the listener's queue."""

PARAMETERS = """
/**:
  ros__parameters:
    language: {language}
    threads: 1
    diagnostic_period: 0.2
    qos_overrides:
      /image.subscription.reliability: reliable
      /body_keypoints.publisher.reliability: reliable
      /body_keypoints.subscription.reliability: reliable
      /hands.publisher.reliability: reliable
      /hands.subscription.reliability: reliable
"""
"""No picture may be lost: this is about what is recognised, not about what a network does."""


@pytest.fixture(scope="module")
def clip(sample_clips: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a sample's gesture and a part of its salutes: every third frame, at half its size."""
    path = tmp_path_factory.mktemp("clips") / "circle.mp4"
    with read_frames(sample_clips / "circle-test-1.mp4") as frames, av.open(path, "w") as made:
        stream = made.add_stream("mpeg4", rate=1000)
        stream.width, stream.height, stream.bit_rate = 320, 240, 2_000_000
        for frame in frames:
            if frame.index % 3 == 0 and BEGIN <= frame.time <= END:
                picture = av.VideoFrame.from_ndarray(frame.image).reformat(320, 240, "yuv420p")
                picture.pts = round((frame.time - BEGIN) * 1000)
                made.mux(stream.encode(picture))
        made.mux(stream.encode(None))
    return path


@pytest.fixture(scope="module")
def recognised(clip: Path, language_file: Path) -> list[dict[str, Any]]:
    """Return the takes that `osg-studio recognize --json` prints for the clip."""
    asked = ["recognize", str(clip), "--language", str(language_file), "--json"]
    command = [sys.executable, "-m", "app", *asked]
    ran = subprocess.run(command, capture_output=True, text=True, check=True, cwd=workspace.ROOT)
    takes: list[dict[str, Any]] = json.loads(ran.stdout)["takes"]
    return takes


@contextmanager
def process(executable: str, environment: dict[str, str], parameters: Path) -> Iterator[None]:
    """Run an executable of the package as `ros2 run` does."""
    started = [
        sys.executable,
        "-c",
        f"from osg_ros.nodes.{executable} import main; main()",
        "--ros-args",
        "--params-file",
        str(parameters),
    ]
    running = subprocess.Popen(started, env=environment)
    try:
        yield
    finally:
        running.terminate()
        assert running.wait(timeout=PATIENCE) == 0


@pytest.mark.parametrize("executables", [TOGETHER, SEPARATE], ids=["one process", "three"])
def test_label_by_label_and_stamp_by_stamp(
    bench: Bench,
    domain: int,
    clip: Path,
    language_file: Path,
    tmp_path: Path,
    recognised: list[dict[str, Any]],
    executables: Sequence[str],
) -> None:
    parameters = tmp_path / "parameters.yaml"
    parameters.write_text(PARAMETERS.format(language=language_file), encoding="utf-8")
    seen = bench.subscribe(Hands, "hands")
    recognitions = bench.subscribe(GestureRecognition, "recognition")
    pictures = bench.probe.create_publisher(Image, "image", RELIABLE)
    with ExitStack() as running:
        for executable in executables:
            running.enter_context(process(executable, workspace.environment(domain), parameters))
        warm_up(bench, pictures)
        play(bench, clip, pictures, seen)
        bench.wait(lambda: bool(recognitions), "recognition")
    assert len(recognitions) == len(recognised) == 1
    for message, take in zip(recognitions, recognised, strict=True):
        assert message.label == take["label"] == "circle"
        assert message.nearest == take["nearest"]
        assert message.confidence == pytest.approx(take["confidence"], abs=1e-6)
        assert json.loads(message.report)["votes"] == take["votes"]
        assert to_nanoseconds(message.start) == stamped(take["start"])
        assert to_nanoseconds(message.end) == stamped(take["end"])


def test_the_robot_command_tells_ros_what_it_writes_under_the_names_asked_for(
    bench: Bench, domain: int, clip: Path, language_file: Path, recognised: list[dict[str, Any]]
) -> None:
    recognitions = bench.subscribe(GestureRecognition, "/auv/gestures")
    seen = bench.subscribe(Hands, "/auv/hands", BEST_EFFORT)
    (command,) = documented("robot", "--ros2", page="robots/ros2-nodes.md")
    given = {"pool.json": str(language_file), "0": str(clip)}
    asked = [given.get(argument, argument) for argument in command]
    for _ in range(ATTEMPTS):
        running = subprocess.Popen(
            [sys.executable, "-m", "app", *asked],
            env=workspace.environment(domain),
            stdout=subprocess.PIPE,
            text=True,
        )
        bench.wait(lambda: running.poll() is not None, "end of the robot")  # noqa: B023
        if bench.comes(lambda: bool(recognitions), ARRIVAL):
            break
    written = [json.loads(line) for line in running.communicate()[0].splitlines()]
    assert running.returncode == 0
    (line,) = [line for line in written if line["event"] == "take_recognized"]
    (message,), (take,) = recognitions, recognised
    assert message.label == line["label"] == take["label"]
    assert message.confidence == pytest.approx(take["confidence"], abs=1e-9)
    duration = to_nanoseconds(message.end) - to_nanoseconds(message.start)
    assert duration == stamped(take["end"]) - stamped(take["start"])
    assert seen


def warm_up(bench: Bench, pictures: Any) -> None:
    """Send black pictures of an hour ago until the last of the nodes has received one.

    Processes find each other one by one, and what is sent before is lost.
    """
    reports = bench.subscribe(DiagnosticArray, "/diagnostics")
    black = np.zeros((240, 320, 3), dtype=np.uint8)
    for number in itertools.count():
        message = to_image_message(black)
        message.header.stamp = to_stamp(stamped(number - 3600))
        pictures.publish(message)
        news = len(reports) + 3
        bench.wait(lambda news=news: len(reports) >= news, "diagnostics")  # type: ignore[misc]
        if any(recogniser_received(report.status[0]) for report in reports):
            return


def recogniser_received(status: DiagnosticStatus) -> bool:
    """Return whether the recognition node has processed a picture."""
    values = {value.key: value.value for value in status.values}
    return status.name in ("/gesture_node", "/recognition_node") and values["messages"] != "0"


def play(bench: Bench, clip: Path, pictures: Any, seen: list[Hands]) -> None:
    """Send the clip's frames with their timestamps, each when the one before was looked at."""
    with read_frames(clip) as frames:
        for frame in frames:
            message = to_image_message(frame.image)
            message.header.stamp = to_stamp(stamped(frame.time))
            pictures.publish(message)
            bench.wait(
                lambda: bool(seen) and seen[-1].header.stamp == message.header.stamp,  # noqa: B023
                f"hands in the picture at {frame.time:g} s",
            )
