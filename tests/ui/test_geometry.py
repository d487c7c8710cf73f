"""The space-time cube's geometry: pixels and seconds to places."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition import PoseSequence
from app.recognition.poses.landmarks import POSE_LANDMARKS
from app.ui.geometry import (
    DEPTH_LIMITS,
    DEPTH_PER_SECOND,
    MAX_TRAIL_SEGMENTS,
    CubeGeometry,
    find_complete,
)
from tests.api.recordings import recording_of


def cube_of(seconds: float, frames: int = 11) -> CubeGeometry:
    """Return the cube of one landmark that crosses a 200 x 100 frame from corner to corner."""
    share = np.linspace(0, 1, frames)
    poses = PoseSequence(
        landmarks=("right_wrist",),
        xy=np.stack([200 * share, 100 * share], axis=1)[:, None],
        time=5 + seconds * share,
        frame_size=(200, 100),
    )
    return CubeGeometry.from_poses(poses)


def test_the_video_is_one_high_centred_and_keeps_its_aspect() -> None:
    cube = cube_of(2.0)
    assert cube.aspect == 2.0
    np.testing.assert_allclose(cube.points[0, 0], [-1.0, -0.5, 0.0], atol=1e-6)
    np.testing.assert_allclose(cube.points[-1, 0, :2], [1.0, 0.5], atol=1e-6)


def test_time_runs_away_from_the_viewer_at_an_even_pace() -> None:
    cube = cube_of(2.5)
    assert cube.depth[0] == 0.0
    assert cube.back == pytest.approx(2.5 * DEPTH_PER_SECOND, rel=1e-5)
    np.testing.assert_allclose(np.diff(cube.depth), cube.back / 10, rtol=1e-4)
    assert cube.depth_at(1.25) == pytest.approx(cube.back / 2)


@given(st.floats(0.05, 900))
def test_every_clip_makes_a_cube_that_fits_the_view(seconds: float) -> None:
    cube = cube_of(seconds)
    assert DEPTH_LIMITS[0] - 1e-5 <= cube.back <= DEPTH_LIMITS[1] + 1e-5
    ticks = cube.ticks()
    assert 1 <= len(ticks) <= 10
    assert all(0 <= second <= seconds + 1e-6 for second in ticks)


def test_a_single_frame_is_a_cube_as_well() -> None:
    poses = recording_of("circle").poses.between(0.0, 0.0)
    cube = CubeGeometry.from_poses(poses)
    assert cube.back == DEPTH_LIMITS[0]
    assert len(cube.edges()) == 12
    assert cube.trail("right_wrist").shape == (0, 2, 3)


def test_bones_and_joints_that_were_not_seen_are_not_drawn() -> None:
    cube = CubeGeometry.from_poses(recording_of("circle").poses)
    # Seen: both shoulders and hips, joined by four bones; wrists without elbows have none.
    assert cube.bones(cube.points[0]).shape == (4, 2, 3)
    assert len(cube.joints(cube.points[0])) == 6
    assert np.isfinite(cube.bones(cube.points[0])).all()


def test_a_trail_runs_from_the_start_to_the_frame_on_display() -> None:
    cube = CubeGeometry.from_poses(recording_of("circle").poses)
    column = POSE_LANDMARKS.index("right_wrist")
    trail = cube.trail("right_wrist", 7)
    assert trail.shape == (7, 2, 3)
    np.testing.assert_array_equal(trail[:, 0], cube.points[:7, column])
    np.testing.assert_array_equal(trail[:, 1], cube.points[1:8, column])


def test_the_trail_of_a_long_clip_is_thinned_out_but_ends_at_the_frame() -> None:
    cube = cube_of(600.0, frames=15_000)
    assert len(cube.trail("right_wrist")) <= MAX_TRAIL_SEGMENTS
    np.testing.assert_array_equal(cube.trail("right_wrist", 7_777)[-1, 1], cube.points[7_777, 0])


def test_landmarks_beside_the_video_are_guesses_and_not_drawn() -> None:
    poses = recording_of("circle").poses
    xy = poses.xy.copy()
    xy[:, POSE_LANDMARKS.index("left_hip"), 1] = 600.0
    beside = CubeGeometry.from_poses(
        PoseSequence(landmarks=POSE_LANDMARKS, xy=xy, time=poses.time, frame_size=poses.frame_size)
    )
    inside = CubeGeometry.from_poses(poses)
    assert len(beside.joints(beside.points[0])) == len(inside.joints(inside.points[0])) - 1
    assert len(beside.bones(beside.points[0])) == len(inside.bones(inside.points[0])) - 2
    assert len(beside.other_trails(())) < len(inside.other_trails(()))


def test_a_gap_in_a_landmarks_path_is_a_gap_in_its_trail() -> None:
    poses = recording_of("circle").poses
    xy = poses.xy.copy()
    xy[3, POSE_LANDMARKS.index("right_wrist")] = np.nan
    cube = CubeGeometry.from_poses(
        PoseSequence(landmarks=POSE_LANDMARKS, xy=xy, time=poses.time, frame_size=poses.frame_size)
    )
    np.testing.assert_array_equal(np.flatnonzero(~find_complete(cube.trail("right_wrist"))), [2, 3])


def test_other_trails_leave_out_what_is_salient() -> None:
    cube = CubeGeometry.from_poses(recording_of("circle").poses)
    frames = len(cube.depth)
    everything = cube.other_trails(())
    assert len(everything) == 6 * (frames - 1)
    assert len(cube.other_trails(("right_wrist",))) == 5 * (frames - 1)
