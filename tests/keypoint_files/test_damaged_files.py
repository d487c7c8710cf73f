"""Damaged keypoint files: read, or refused with the right reason."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from app.keypoint_files import KeypointOptions, read_keypoints
from app.recognition.errors import OsgError
from app.recognition.poses.skeletons import BODY_25
from tests.keypoint_files.files import (
    write_browser,
    write_deeplabcut,
    write_hands,
    write_long,
    write_named,
    write_numbered,
    write_openpose,
    write_pose_format,
    write_results,
    write_tracks,
)
from tests.recognition.parametric_hand import hand_xy, salute
from tests.recognition.strategies import BODY, circle, recording

POSES = recording(circle, frames=4, landmarks=tuple(BODY))
WHOLE = recording(circle, frames=4)
OPTIONS = KeypointOptions(frame_rate=30, frame_size=(640, 480))

WRITERS: dict[str, Callable[[Path], Path]] = {
    "named": lambda folder: write_named(folder / "named.csv", POSES),
    "numbered": lambda folder: write_numbered(folder / "numbered.csv", recording(circle, frames=3)),
    "long": lambda folder: write_long(folder / "long.csv", POSES),
    "deeplabcut": lambda folder: write_deeplabcut(folder / "dlc.csv", {"a": POSES, "b": POSES}),
    "tracks": lambda folder: write_tracks(folder / "tracks.csv", [POSES, POSES]),
    "hands": lambda folder: write_hands(folder / "hands.csv", WHOLE, hand_xy(salute()), "lh_{}_{}"),
    "mmpose": lambda folder: write_results(folder / "mmpose.json", [POSES, POSES], "mmpose"),
    "coco": lambda folder: write_results(folder / "coco.json", [POSES, POSES], "coco"),
    "browser": lambda folder: write_browser(folder / "browser.json", WHOLE),
    "excel": lambda folder: _by_excel(write_named(folder / "excel.csv", POSES)),
    "pose": lambda folder: write_pose_format(folder / "dive.pose", [POSES, POSES]),
    "openpose": lambda folder: write_openpose(folder / "json", POSES, BODY_25),
    "json": lambda folder: _one_frame_of(write_openpose(folder / "one", POSES, BODY_25)),
}


def _by_excel(path: Path) -> Path:
    text = path.read_text().replace(",", ";").replace(".", ",")
    path.write_text(text, encoding="utf-16")
    return path


def _one_frame_of(folder: Path) -> Path:
    return min(folder.iterdir())


def damaged(content: bytes, seed: int, share: float) -> bytes:
    """Change a few characters to others that such files hold, and cut the end off."""
    generator = np.random.default_rng(seed)
    values = bytearray(content[: max(1, int(len(content) * share))])
    for place in generator.integers(0, len(values), size=3):
        values[place] = generator.choice(list(b'0159.-e,"\n[]{}:nNx\x00\xff'))
    return bytes(values)


@pytest.mark.parametrize("form", WRITERS)
@settings(
    # An example takes milliseconds, but the machine may be busy with something else.
    deadline=None,
    max_examples=25,
    suppress_health_check=[HealthCheck.function_scoped_fixture],  # every example writes it anew
)
@given(seed=st.integers(0, 2**32 - 1), share=st.floats(0, 1))
def test_a_damaged_file_is_read_or_refused(
    tmp_path: Path, form: str, seed: int, share: float
) -> None:
    path = WRITERS[form](tmp_path)
    file = _one_frame_of(path) if path.is_dir() else path
    file.write_bytes(damaged(file.read_bytes(), seed, share))
    try:
        poses = read_keypoints(path, OPTIONS).recording.poses
    except OsgError:
        return
    assert poses.seen.any()


def test_a_coordinate_that_is_in_no_picture_is_refused(tmp_path: Path) -> None:
    poses = replace(POSES, xy=np.where(POSES.xy == POSES.xy[2, 1], 1e308, POSES.xy))
    table = write_named(tmp_path / "named.csv", poses)
    with pytest.raises(OsgError, match=r"coordinate 1e\+308, which is in no picture"):
        read_keypoints(table, OPTIONS)
