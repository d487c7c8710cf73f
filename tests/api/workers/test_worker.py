"""The worker process: one answer per line, and an end when the server is gone."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.api.workers.worker_messages import pose_in
from app.recognition import Recording
from tests.recognition.damaged_clips import write_clip

pytestmark = pytest.mark.slow

COMMAND = [sys.executable, "-m", "app.api.workers.worker"]


def answers(*arguments: str | Path) -> list[dict[str, Any]]:
    """Run a worker to its end with its stdin open, and return its messages."""
    command = [*COMMAND, *(str(argument) for argument in arguments)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        return [json.loads(line) for line in process.stdout]


def test_probing_tells_what_the_clip_is(tmp_path: Path) -> None:
    (answer,) = answers("probe", "video", write_clip(tmp_path / "clip.mp4", rotation=90))
    assert answer["kind"] == "probed"
    assert (answer["width"], answer["height"]) == (48, 64)  # upright


def test_a_failure_names_no_file_of_ours(tmp_path: Path) -> None:
    path = tmp_path / "0123.part"
    path.write_bytes(b"\0\0\0\x18ftypmp42")
    (answer,) = answers("probe", "video", path)
    assert (answer["kind"], answer["code"]) == ("failed", "video_unreadable")
    assert "0123" not in answer["detail"]


@pytest.mark.skipif(sys.platform != "linux", reason="the limits of other systems differ")
def test_a_worker_cannot_raise_its_own_limits() -> None:
    code = (
        "import resource; from app.api.workers.worker import limit_resources; "
        "limit_resources(8 << 30, 100, 1000); "
        "print(*(resource.getrlimit(kind) for kind in "
        "(resource.RLIMIT_AS, resource.RLIMIT_CPU, resource.RLIMIT_FSIZE)))"
    )
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert ran.stdout.strip() == f"({8 << 30}, {8 << 30}) (100, 100) (1000, 1000)"


@pytest.mark.usefixtures("installed_models")
def test_extracting_reports_progress_and_leaves_recording_and_pictures(tmp_path: Path) -> None:
    clip = write_clip(tmp_path / "clip.mp4", frames=5)
    recording, poster = tmp_path / "recording.npz", tmp_path / "poster.jpg"
    messages = answers("record", "video", clip, clip, recording, poster, tmp_path / "filmstrip.jpg")
    assert messages[-1]["kind"] == "finished"
    assert messages[-1]["frames"] == 5
    last = [answer for answer in messages if answer.get("stage") == "poses"][-1]
    assert (last["done"], last["time"]) == (5, pytest.approx(4 / 25))
    assert last["pose"] is None  # Nobody is in this clip.
    assert len(Recording.load(recording).poses) == 5
    assert poster.read_bytes()[:2] == b"\xff\xd8"
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "clip.mp4",
        "filmstrip.jpg",
        "poster.jpg",
        "recording.npz",
    ]


def test_a_pose_is_told_as_fractions_of_the_picture() -> None:
    xy = np.tile([[320.0, 60.0]], (33, 1))
    xy[1] = [-64.0, 480.0]
    xy[2] = [np.nan, 10.0]
    pose = pose_in(xy, 640, 240)
    assert pose[:4] == ((0.5, 0.25), (-0.1, 2.0), None, (0.5, 0.25))
    assert len(pose) == 33


def test_a_worker_whose_server_is_gone_ends(tmp_path: Path) -> None:
    clip = write_clip(tmp_path / "clip.mp4", frames=2000)
    left = [str(tmp_path / name) for name in ("r.npz", "p.jpg", "f.jpg")]
    command = [*COMMAND, "record", "video", str(clip), str(clip), *left]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL) as process:
        assert process.stdin is not None
        process.stdin.close()
        assert process.wait(60) == 1
    assert not (tmp_path / "r.npz").exists()
