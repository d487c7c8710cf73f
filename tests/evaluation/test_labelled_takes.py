"""From files to takes: real recordings, real clips, and what is kept of them."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from app.clip_sources import ReadOptions
from app.evaluation.labelled_takes import collect_takes, labelled_files
from app.recognition import Recording
from app.recognition.poses.skeletons import BODY_25
from tests.evaluation.takes import drawn_takes
from tests.keypoint_files.files import write_openpose
from tests.recognition.strategies import circle, recording


def save_swipes(folder: Path) -> None:
    """Save recordings of one person's swipes as ``folder/PERSON/LABEL/NUMBER.npz``."""
    for number, take in enumerate(drawn_takes("swipes", people=(0,), takes=2)):
        recording = Recording(
            poses=take.poses, hands=((),) * len(take.poses), salute=np.zeros(len(take.poses))
        )
        path = folder / take.person / take.label / f"{number}.npz"
        path.parent.mkdir(parents=True, exist_ok=True)
        recording.save(path)


def test_a_recording_without_salutes_is_one_take_as_a_whole(tmp_path: Path) -> None:
    save_swipes(tmp_path)
    takes = collect_takes(labelled_files(tmp_path)).takes
    assert [take.label for take in takes] == ["left", "left", "right", "right", "up", "up"]
    assert {take.person for take in takes} == {"person 0"}
    expected = drawn_takes("swipes", people=(0,), takes=2)
    assert [take.poses for take in takes] == [take.poses for take in expected]


def test_files_that_cannot_be_read_are_named_and_do_not_end_the_work(tmp_path: Path) -> None:
    save_swipes(tmp_path)
    broken = tmp_path / "person 0" / "up" / "broken.npz"
    broken.write_bytes(b"no recording")
    found = collect_takes(labelled_files(tmp_path))
    assert len(found.takes) == 6
    assert list(found.problems) == [str(broken)]
    assert "not a readable recording" in found.problems[str(broken)]


def test_keypoint_files_are_takes_too_with_what_they_do_not_tell_given(tmp_path: Path) -> None:
    poses = recording(circle, frames=20)
    (tmp_path / "circle").mkdir()
    write_openpose(tmp_path / "circle" / "dive 1", poses, BODY_25)
    files = labelled_files(tmp_path)
    (take,) = collect_takes(files, options=ReadOptions(frame_rate=20)).takes
    assert (take.label, take.source) == ("circle", str(tmp_path / "circle" / "dive 1"))
    assert take.poses.duration == pytest.approx(19 / 20)
    (problem,) = collect_takes(files).problems.values()
    assert "--frame-rate" in problem


@pytest.mark.slow
@pytest.mark.usefixtures("installed_models")
def test_a_clip_is_extracted_once_whatever_it_is_called(
    tmp_path: Path, thin_clip: Callable[[str], Path]
) -> None:
    clips, kept = tmp_path / "clips", tmp_path / "kept"
    clips.mkdir()
    content = thin_clip("line-test-1").read_bytes()
    (clips / "line-1.mp4").write_bytes(content)
    (clips / "torn-1.mp4").write_bytes(content[:1000])
    frames: list[int] = []
    first = collect_takes(
        labelled_files(clips),
        keep_in=kept,
        progress=lambda done, total, name: frames.append(done),
    )
    assert [take.label for take in first.takes] == ["line"]
    assert list(first.problems) == [str(clips / "torn-1.mp4")]
    assert frames
    frames.clear()
    (clips / "line-1.mp4").rename(clips / "stroke-1.mp4")
    again = collect_takes(
        labelled_files(clips),
        keep_in=kept,
        progress=lambda done, total, name: frames.append(done),
    )
    assert not frames
    assert [take.poses for take in again.takes] == [take.poses for take in first.takes]
    assert [take.label for take in again.takes] == ["stroke"]
