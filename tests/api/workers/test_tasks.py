"""Tasks: what each reports, and how it fails in the words of its kind."""

import asyncio
import base64
import io
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from app.api.workers.rights import line_of
from app.api.workers.tasks import AnyTask, Check, Export, Import, Probe, TestRun
from app.api.workers.worker_messages import (
    MOST_PICTURE_BYTES,
    PART_CHARACTERS,
    Failed,
    Finished,
    Message,
    Probed,
    Progressed,
    dump,
    parse,
)
from app.api.workers.worker_processes import Workers
from app.recognition import Recording
from app.recognition.poses.frame import pose_in
from app.settings import Limits, Settings
from tests.api.workers.test_local_processes import order, record
from tests.recognition.damaged_clips import write_clip
from tests.recognition.demonstrations import pool
from tests.recognition.strategies import circle, line

pytestmark = pytest.mark.slow

COMMAND = [sys.executable, "-m", "app.api.workers"]

PLACE = Path("/nowhere")


def reports(task: AnyTask) -> list[Message]:
    """Run a task in this process, and return what it reports."""
    found: list[Message] = []
    task.run(found.append)
    return found


def ended(task: AnyTask, folder: Path, memory: int = 0) -> Finished | Failed:
    """Run a task in a process with a limit of megabytes, and return how it ended."""
    limits = Limits(worker_memory_bytes=memory * 1024 * 1024)
    settings = Settings(data_dir=folder, limits=limits)
    settings.clips.mkdir(exist_ok=True)
    return asyncio.run(Workers(settings).run(task))


def test_probing_tells_what_the_clip_is(tmp_path: Path) -> None:
    clip = write_clip(tmp_path / "clip.mp4", rotation=90)
    (answer,) = reports(Probe(source="video", file=clip))
    assert isinstance(answer, Probed)
    assert (answer.width, answer.height) == (48, 64)  # upright
    assert answer.picture is not None
    with Image.open(io.BytesIO(answer.picture)) as picture:
        assert (picture.format, picture.size) == ("JPEG", (48, 64))
    (line,) = dump(answer)
    assert parse(line.encode()) == answer


@pytest.mark.parametrize("picture", [b"<svg/>", b"\xff\xd8\xff" + bytes(MOST_PICTURE_BYTES)])
def test_a_picture_that_is_no_small_jpeg_is_no_answer(picture: bytes) -> None:
    said = {"kind": "probed", "width": 4, "height": 3, "duration": None, "frames": None}
    line = json.dumps({**said, "picture": base64.b64encode(picture).decode()})
    with pytest.raises(ValueError, match="no JPEG"):
        parse(line.encode())


def test_a_failure_names_no_file_of_ours(tmp_path: Path) -> None:
    path = tmp_path / "0123.part"
    path.write_bytes(b"\0\0\0\x18ftypmp42")
    answer = ended(Probe(source="video", file=path), tmp_path)
    assert isinstance(answer, Failed)
    assert answer.code == "video_unreadable"
    assert "0123" not in answer.detail


def test_a_language_comes_back_however_long_it_is(tmp_path: Path) -> None:
    file = tmp_path / "language.json"
    file.write_text(pool(circle=circle, line=line).to_json(), encoding="utf-8")
    answer = ended(Import(file=file, name="none"), tmp_path)
    assert isinstance(answer, Finished)
    assert answer.result["labels"] == ["circle", "line"]
    assert len(answer.result["document"]) > PART_CHARACTERS
    file.write_text("{}", encoding="utf-8")
    refused = ended(Import(file=file, name="none"), tmp_path)
    assert isinstance(refused, Failed)
    assert refused.code == "language_invalid"


@pytest.mark.parametrize(
    ("task", "code", "word"),
    [
        (Probe(source="video", file=PLACE), "decoder", "the clip"),
        (record(PLACE / "clip.mp4"), "decoder", "the clip"),
        (
            Export(clip="", video=PLACE, recording=PLACE, target=PLACE, recognitions=()),
            "decoder",
            "the process that wrote it",
        ),
        (Import(file=PLACE, name=""), "language_too_large", "this language"),
        (Check(document=""), "language_too_large", "this language"),
        (TestRun(document="", takes=()), "test_run_broken_off", "the takes"),
    ],
    ids=lambda value: getattr(value, "kind", ""),
)
def test_a_lack_of_memory_is_told_in_the_words_of_the_kind(
    task: AnyTask, code: str, word: str
) -> None:
    failed = task.refuse(MemoryError())
    assert failed.code == code
    assert word in failed.detail


@pytest.mark.skipif(sys.platform != "linux", reason="the limits of other systems differ")
@pytest.mark.parametrize("memory", [250, 450])
def test_a_check_without_enough_memory_blames_the_language_and_no_clip(
    tmp_path: Path, memory: int
) -> None:
    task = Check(document=pool(circle=circle, line=line).to_json())
    failed = ended(task, tmp_path, memory)
    assert isinstance(failed, Failed)
    assert failed == task.broken_off
    assert "clip" not in failed.detail
    assert isinstance(ended(task, tmp_path), Finished)


@pytest.mark.skipif(sys.platform != "linux", reason="the limits of other systems differ")
def test_a_worker_cannot_raise_its_own_limits() -> None:
    code = (
        "import resource; from app.api.workers.__main__ import limit_resources; "
        "limit_resources(8 << 30, 100, 1000); "
        "print(*(resource.getrlimit(kind) for kind in "
        "(resource.RLIMIT_AS, resource.RLIMIT_CPU, resource.RLIMIT_FSIZE)))"
    )
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert ran.stdout.strip() == f"({8 << 30}, {8 << 30}) (100, 100) (1000, 1000)"


@pytest.mark.usefixtures("installed_models")
def test_recording_reports_progress_and_leaves_recording_and_pictures(tmp_path: Path) -> None:
    task = record(write_clip(tmp_path / "clip.mp4", frames=5))
    messages = reports(task)
    (finished,) = (message for message in messages if isinstance(message, Finished))
    assert (finished, finished.frames) == (messages[-1], 5)
    steps = [message for message in messages if isinstance(message, Progressed)]
    last = [step for step in steps if step.stage == "poses"][-1]
    assert last.done == 5
    assert last.time == pytest.approx(4 / 25)
    assert last.pose is None  # Nobody is in this clip.
    assert len(Recording.load(task.recording).poses) == 5
    assert task.poster.read_bytes()[:2] == b"\xff\xd8"
    names = sorted(path.name for path in tmp_path.iterdir())
    assert names == ["clip.mp4", "clip.npz", "clip.poster.jpg", "clip.strip.jpg"]


def test_a_pose_is_told_as_fractions_of_the_picture() -> None:
    xy = np.tile([[320.0, 60.0]], (33, 1))
    xy[1] = [-64.0, 480.0]
    xy[2] = [np.nan, 10.0]
    pose = pose_in(xy, 640, 240)
    assert pose[:4] == ((0.5, 0.25), (-0.1, 2.0), None, (0.5, 0.25))
    assert len(pose) == 33


def test_a_worker_whose_server_is_gone_ends(tmp_path: Path) -> None:
    task = record(write_clip(tmp_path / "clip.mp4", frames=2000))
    with subprocess.Popen(COMMAND, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL) as process:
        assert process.stdin is not None
        process.stdin.write(line_of(order(task)))
        process.stdin.close()
        assert process.wait(60) == 1
    assert not task.recording.exists()
