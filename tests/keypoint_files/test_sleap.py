"""SLEAP's files, written and read by its own library."""

from __future__ import annotations

import importlib
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.keypoint_files import KeypointOptions, read_keypoints
from app.recognition import PoseSequence
from app.recognition.errors import KeypointFileError
from tests.keypoint_files.files import sleap_labels, write_tracks
from tests.recognition.strategies import BODY, circle, recording

POSES = recording(circle, frames=8, landmarks=tuple(BODY))
FAR = replace(POSES, xy=POSES.xy * 0.3 + (400, 0))
AT_30 = KeypointOptions(frame_rate=30)


@pytest.fixture
def library() -> Any:
    """Return SLEAP's own library."""
    return importlib.import_module("sleap_io")


@pytest.mark.parametrize(("ending", "tracked"), [(".slp", True), (".slp", False), (".h5", True)])
def test_the_larger_person_comes_back(
    library: Any, tmp_path: Path, ending: str, tracked: bool
) -> None:
    labels = sleap_labels(library, [FAR, POSES], tracked=tracked)
    path = tmp_path / f"dive{ending}"
    if ending == ".slp":
        library.save_slp(labels, str(path))
    else:
        library.save_analysis_h5(labels, str(path))
    read = read_keypoints(path, AT_30)
    poses = read.recording.poses
    assert poses.landmarks == POSES.landmarks
    first = len(poses) - len(POSES)
    np.testing.assert_allclose(poses.xy[first:], POSES.xy, atol=1e-3)
    np.testing.assert_allclose(np.diff(poses.time), 1 / 30)
    told = "of 2 people" if tracked else "two people are seen"
    assert any(told in warning for warning in read.recording.warnings)
    assert not read.has_hands


@pytest.mark.parametrize("ending", [".slp", ".h5"])
def test_a_file_of_something_else_is_refused(library: Any, tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"dive{ending}"
    path.write_bytes(b"no HDF5 at all")
    with pytest.raises(
        KeypointFileError, match=r"cannot be read as SLEAP's.*DeepLabCut"
    ) as refused:
        read_keypoints(path, AT_30)
    assert "\n" not in str(refused.value)


def test_without_the_library_the_extra_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "sleap_io", None)
    (tmp_path / "dive.slp").touch()
    with pytest.raises(KeypointFileError, match=r'pip install "osg-studio\[keypoints\]"'):
        read_keypoints(tmp_path / "dive.slp", AT_30)


def write_old_analysis(path: Path, people: list[PoseSequence]) -> Path:
    """Write an analysis as SLEAP did before 1.1.4: no scores."""
    h5py = importlib.import_module("h5py")
    with h5py.File(path, "w") as file:
        file["node_names"] = [name.encode() for name in people[0].landmarks]
        file["track_names"] = [f"track_{number}".encode() for number in range(len(people))]
        file["tracks"] = np.stack([each.xy.transpose(2, 1, 0) for each in people])
        file["track_occupancy"] = np.ones((len(people[0]), len(people)))
    return path


@pytest.mark.usefixtures("library")
def test_an_older_analysis_without_scores_is_read(tmp_path: Path) -> None:
    read = read_keypoints(write_old_analysis(tmp_path / "dive.h5", [FAR, POSES]), AT_30)
    np.testing.assert_allclose(read.recording.poses.xy, POSES.xy)
    assert "of 2 people track 'track_1' stands out most and is followed" in read.recording.warnings
    assert read.recording.people is not None
    assert read.recording.people.tolist() == [2] * len(POSES)
    strange = replace(POSES, landmarks=POSES.landmarks[:1], xy=POSES.xy[:, :1])
    path = write_old_analysis(tmp_path / "strange.h5", [strange])
    with importlib.import_module("h5py").File(path, "a") as file:
        file["node_names"][:] = [b"nose"]
        del file["tracks"]
        file["tracks"] = np.zeros((1, 3, 1, 8))
    with pytest.raises(KeypointFileError, match="cannot be read as SLEAP's"):
        read_keypoints(path, AT_30)


def test_a_table_of_several_tracks_gives_the_most_prominent_one(tmp_path: Path) -> None:
    path = write_tracks(tmp_path / "dive.csv", [FAR, POSES])
    lines = path.read_text().splitlines()
    del lines[6]  # the second track in the third frame
    path.write_text("\n".join(lines))
    read = read_keypoints(path, AT_30)
    poses = read.recording.poses
    kept = [0, 1, *range(3, len(POSES))]
    np.testing.assert_allclose(poses.xy[kept], POSES.xy[kept])
    assert np.isnan(poses.xy[2]).all()
    np.testing.assert_allclose(np.diff(poses.time), 1 / 30)
    assert "of 2 people track 'track_1' stands out most and is followed" in read.recording.warnings
    assert read.recording.people is not None
    assert read.recording.people.tolist() == [2, 2, 1, *[2] * (len(POSES) - 3)]


def test_a_table_of_people_without_names_is_refused_in_one_line(tmp_path: Path) -> None:
    path = write_tracks(tmp_path / "dive.csv", [FAR, POSES], name="")
    path.write_text(path.read_text().replace("\n,7,", "\nother,7,"))
    with pytest.raises(KeypointFileError, match="two rows of nobody by name at one time"):
        read_keypoints(path, AT_30)
