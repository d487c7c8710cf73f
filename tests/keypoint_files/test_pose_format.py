"""pose-format's files: body and hands, of both versions and any number of people."""

from __future__ import annotations

import struct
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.keypoint_files import keypoint_ending, read_keypoints
from app.recognition.errors import KeypointFileError, VideoError
from app.recognition.recording.video_limits import VideoLimits
from tests.keypoint_files.files import write_pose_format
from tests.recognition.parametric_hand import hand_xy, salute
from tests.recognition.strategies import BODY, circle, recording

POSES = recording(circle, frames=8)
FAR = replace(POSES, xy=POSES.xy * 0.3 + 5)
SALUTE = [hand_xy(salute()) if index < 3 else None for index in range(len(POSES))]


@pytest.mark.parametrize("version", [0.1, 0.2])
def test_body_and_hands_of_the_most_prominent_person_are_read(
    tmp_path: Path, version: float
) -> None:
    path = write_pose_format(tmp_path / "dive.pose", [FAR, POSES], SALUTE, version=version)
    read = read_keypoints(path)
    poses = read.recording.poses
    assert (poses.landmarks, poses.frame_size) == (POSES.landmarks, POSES.frame_size)
    np.testing.assert_allclose(poses.xy, POSES.xy, atol=1e-3)
    np.testing.assert_allclose(np.diff(poses.time), 1 / 25)
    assert [len(hands) for hands in read.recording.hands] == [1] * 3 + [0] * 5
    assert read.recording.hands[0][0].side == "right"
    assert (read.recording.salute > 0.5).tolist() == [True] * 3 + [False] * 5
    told = "two people are seen; the body is that of the person who stands out most"
    assert told in read.recording.warnings
    assert keypoint_ending(path.read_bytes()[:4096], "dive") == ".pose"


def test_what_is_not_seen_and_a_file_without_hands(tmp_path: Path) -> None:
    xy = POSES.xy.copy()
    xy[2:4] = np.nan
    path = write_pose_format(tmp_path / "dive.pose", [replace(POSES, xy=xy)])
    read = read_keypoints(path)
    assert np.flatnonzero(~read.recording.poses.seen.any(axis=1)).tolist() == [2, 3]
    assert not read.has_hands


def test_what_cannot_be_read_is_one_line(tmp_path: Path) -> None:
    path = write_pose_format(tmp_path / "dive.pose", [POSES])
    content = path.read_bytes()
    for broken in (b"", content[:300], content[:-400], struct.pack("<f", 0.0) + content[4:]):
        path.write_bytes(broken)
        with pytest.raises(KeypointFileError, match=r"cannot be read as a \.pose file") as refused:
            read_keypoints(path)
        assert "\n" not in str(refused.value)
    objects = replace(
        recording(circle, frames=8, landmarks=tuple(BODY)),
        landmarks=tuple(f"p{place}" for place in range(len(BODY))),
    )
    with pytest.raises(KeypointFileError, match="holds no body that is known here, only POSE_LAND"):
        read_keypoints(write_pose_format(path, [objects]))


def test_a_file_that_announces_more_than_it_holds_or_than_is_allowed_is_refused(
    tmp_path: Path,
) -> None:
    path = write_pose_format(tmp_path / "dive.pose", [POSES])
    with pytest.raises(VideoError):
        read_keypoints(path, limits=VideoLimits(frames=7))
    content = path.read_bytes()
    counts = struct.pack("<fIH", 25.0, len(POSES), 1)
    path.write_bytes(content.replace(counts, struct.pack("<fIH", 25.0, 2**32 - 1, 65535)))
    with pytest.raises(KeypointFileError, match="cannot be read"):
        read_keypoints(path)
