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
from app.recognition.errors import KeypointFileError
from tests.keypoint_files.files import sleap_labels
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
    with pytest.raises(KeypointFileError, match=r"pip install 'osg-studio\[keypoints\]'"):
        read_keypoints(tmp_path / "dive.slp", AT_30)
