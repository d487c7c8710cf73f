"""Normalisation takes out where the diver is and how far away, and nothing else."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition import PoseError, PoseSequence
from app.recognition.poses.sequence import MAX_GAP_SECONDS, FloatArray
from app.recognition.poses.trajectory import Trajectory
from tests.recognition.strategies import circle, in_space, known, recording, recordings

HAND_ONLY = ("right_wrist",)
UNSEEN = [np.nan, np.nan]


def moved(poses: PoseSequence, scale: float, shift: tuple[float, float]) -> PoseSequence:
    return replace(poses, xy=poses.xy * scale + shift)


def trajectory(
    xy: FloatArray | list[list[float]], time: FloatArray | list[float] | None = None
) -> Trajectory:
    """Make the trajectory of one landmark from points ``(T, 2)``, ten a second."""
    points = np.array(xy, dtype=np.float64)[:, None]
    moments = np.arange(len(points)) / 10 if time is None else np.array(time)
    return Trajectory(landmarks=HAND_ONLY, xy=points, time=moments, unit="torso_length")


@given(
    poses=recordings(),
    scale=st.floats(0.2, 5.0),
    shift=st.tuples(st.floats(-500, 500), st.floats(-500, 500)),
)
def test_translating_and_scaling_a_recording_changes_nothing(
    poses: PoseSequence, scale: float, shift: tuple[float, float]
) -> None:
    before = Trajectory.from_poses(poses)
    after = Trajectory.from_poses(moved(poses, scale, shift))
    np.testing.assert_allclose(after.xy, before.xy, atol=1e-9)
    assert after.unit == before.unit == "torso_length"


@given(poses=recordings(), offset=st.floats(-1000, 1000))
def test_shifting_the_clock_changes_nothing(poses: PoseSequence, offset: float) -> None:
    later = replace(poses, time=poses.time + offset)
    np.testing.assert_allclose(
        Trajectory.from_poses(later).time, Trajectory.from_poses(poses).time, atol=1e-9
    )


def test_a_diver_adrift_gives_the_trajectory_of_one_at_rest() -> None:
    poses = recording(circle)
    drift = np.linspace((0, 0), (150, -80), len(poses))
    adrift = replace(poses, xy=poses.xy + drift[:, None])
    np.testing.assert_allclose(
        Trajectory.from_poses(adrift).xy, Trajectory.from_poses(poses).xy, atol=1e-9
    )


def test_the_torso_is_one_long_and_lies_around_the_origin() -> None:
    normalised = Trajectory.from_poses(recording(circle, torso=77.0))
    shoulders = normalised.select(["left_shoulder", "right_shoulder"]).xy.mean(axis=1)
    np.testing.assert_allclose(shoulders, np.tile((0.0, -0.5), (60, 1)), atol=1e-9)


def test_without_a_torso_the_largest_extent_is_one() -> None:
    normalised = Trajectory.from_poses(recording(circle, landmarks=HAND_ONLY))
    assert normalised.unit == "extent"
    diagonal = np.linalg.norm(np.ptp(normalised.xy[:, 0], axis=0))
    assert diagonal == pytest.approx(1.0)


def test_without_a_torso_stillness_is_not_blown_up() -> None:
    still = recording(circle, landmarks=HAND_ONLY, torso=1.0)
    assert np.ptp(Trajectory.from_poses(still).xy) < 0.01


@pytest.mark.parametrize("frames", [0, 5])
def test_a_recording_that_shows_nothing_is_refused(frames: int) -> None:
    poses = recording(circle, frames=frames)
    nothing = replace(poses, xy=np.full_like(poses.xy, np.nan))
    with pytest.raises(PoseError, match=f"none of the {frames} frames shows a landmark"):
        Trajectory.from_poses(nothing)


def test_select_and_between_keep_what_is_asked_for() -> None:
    whole = Trajectory.from_poses(recording(circle, rate=10.0))
    part = whole.select(["right_wrist", "nose"]).between(1.0, 2.0)
    assert part.landmarks == ("right_wrist", "nose")
    assert len(part) == 11
    with pytest.raises(PoseError, match=r"no landmarks \['tail'\] in this trajectory"):
        whole.select(["tail"])


def test_a_short_gap_is_bridged_by_a_straight_line_in_time() -> None:
    filled = trajectory([[0, 0], UNSEEN, UNSEEN, [4, 8]], time=[0.0, 0.1, 0.2, 0.4]).fill_gaps()
    np.testing.assert_allclose(filled.xy[:, 0], [[0, 0], [1, 2], [2, 4], [4, 8]])


def test_a_long_gap_and_the_ends_stay_unseen() -> None:
    path: list[list[float]] = [UNSEEN, [0, 0], UNSEEN, [4, 8], UNSEEN]
    late = [0.0, 0.1, 0.2, 0.2 + MAX_GAP_SECONDS, 1.0]
    np.testing.assert_array_equal(trajectory(path, late).fill_gaps().xy, trajectory(path).xy)


def test_resampling_in_time_is_linear_between_samples() -> None:
    resampled = trajectory([[0, 0], [1, 2], [4, 2]], time=[0.0, 0.1, 0.4]).resample_in_time(5)
    np.testing.assert_allclose(resampled.time, [0.0, 0.1, 0.2, 0.3, 0.4])
    np.testing.assert_allclose(resampled.xy[:, 0], [[0, 0], [1, 2], [2, 2], [3, 2], [4, 2]])


def test_resampling_leaves_gaps_as_gaps() -> None:
    resampled = trajectory([[0, 0], [1, 0], UNSEEN, [3, 0], [4, 0]]).resample_in_time(9)
    unseen = np.isnan(resampled.xy[:, 0, 0])
    np.testing.assert_array_equal(np.flatnonzero(unseen), [3, 4, 5])


@given(poses=recordings(), count=st.integers(2, 80))
def test_resampling_keeps_the_ends_and_stays_on_the_path(poses: PoseSequence, count: int) -> None:
    whole = Trajectory.from_poses(poses).select(HAND_ONLY)
    for resampled in (whole.resample_in_time(count), whole.resample_in_arc_length(count)):
        assert len(resampled) == count
        np.testing.assert_allclose(resampled.xy[[0, -1]], whole.xy[[0, -1]], atol=1e-6)
        assert (resampled.xy >= whole.xy.min(axis=0) - 1e-9).all()
        assert (resampled.xy <= whole.xy.max(axis=0) + 1e-9).all()


def test_arc_length_steps_are_equal_whatever_the_speed() -> None:
    hurried = trajectory([[0, 0], [0.1, 0], [0.2, 0], [3, 0], [4, 0], [4, 0]])
    resampled = hurried.resample_in_arc_length(9)
    np.testing.assert_allclose(np.diff(resampled.xy[:, 0, 0]), 0.5, atol=1e-6)
    assert (np.diff(resampled.time) > 0).all()


def test_arc_length_resampling_of_stillness_is_in_time() -> None:
    resampled = trajectory([[1, 1], [1, 1], [1, 1]]).resample_in_arc_length(5)
    np.testing.assert_allclose(resampled.time, np.linspace(0, 0.2, 5))


@pytest.mark.parametrize("count", [0, 1])
def test_fewer_than_two_moments_cannot_be_asked_for(count: int) -> None:
    with pytest.raises(PoseError, match=f"cannot resample 2 moments to {count}"):
        trajectory([[0, 0], [1, 1]]).resample_in_time(count)
    with pytest.raises(PoseError, match="cannot resample 1 moments"):
        trajectory([[0, 0]]).resample_in_arc_length(3)


@given(recordings())
def test_a_mirror_image_of_a_mirror_image_is_the_movement_itself(poses: PoseSequence) -> None:
    seen = Trajectory.from_poses(poses)
    mirrored = seen.mirror()
    right = seen.select(HAND_ONLY).xy
    np.testing.assert_array_equal(mirrored.select(["left_wrist"]).xy, right * (-1, 1))
    again = mirrored.mirror()
    assert again.landmarks == seen.landmarks
    np.testing.assert_array_equal(again.xy, seen.xy)


def test_what_was_worked_out_once_is_kept_for_this_trajectory_alone() -> None:
    seen, asked = trajectory([[0, 0], [1, 1]]), []

    def work_out() -> int:
        asked.append("once more")
        return len(asked)

    assert [seen.compute_once("number", work_out) for _ in range(3)] == [1, 1, 1]
    assert seen.compute_once(("number", 2), work_out) == 2
    assert seen.between(0, 1).compute_once("number", work_out) == 3


TURNS = st.floats(-80, 80)


@given(turned=TURNS)
def test_the_way_a_diver_faces_is_read_off_the_shoulders(turned: float) -> None:
    seen = Trajectory.from_poses(in_space(recording(circle), turned))
    assert seen.facing == pytest.approx(turned, abs=1e-6)
    assert seen.mirror().facing == pytest.approx(-turned, abs=1e-6)


@given(turned=TURNS, by=TURNS)
def test_a_turned_demonstration_is_what_the_camera_sees_of_a_turned_diver(
    turned: float, by: float
) -> None:
    one = Trajectory.from_poses(in_space(recording(circle), turned)).turn(by)
    other = Trajectory.from_poses(in_space(recording(circle), turned + by))
    np.testing.assert_allclose(one.xy, other.xy, atol=1e-9)
    np.testing.assert_allclose(known(one.depth), known(other.depth), atol=1e-9)


def test_without_depth_nobody_is_known_to_be_turned_and_nothing_turns() -> None:
    seen = Trajectory.from_poses(recording(circle))
    assert seen.depth is None
    assert seen.facing is None
    assert seen.turn(30) is seen


def test_depth_is_cut_resampled_and_bridged_with_the_path() -> None:
    poses = in_space(recording(circle, frames=20, rate=10.0), 30.0)
    assert poses.world is not None
    world = poses.world.copy()
    world[5:8] = np.nan
    whole = Trajectory.from_poses(poses)
    gappy = Trajectory.from_poses(replace(poses, world=world))
    depth = known(whole.depth)
    np.testing.assert_allclose(known(gappy.fill_gaps().depth), depth, atol=0.1)
    assert known(whole.resample_in_time(7).depth).shape == (7, 34)
    np.testing.assert_array_equal(known(whole.between(0.5, 1.0).depth), depth[5:11])
    wrist = known(whole.select(["right_wrist"]).depth)
    np.testing.assert_array_equal(wrist[:, 0], depth[:, 16])


@pytest.mark.parametrize("missing", [("left_hip", "right_hip"), ("left_shoulder",)])
def test_depth_needs_the_torso_it_is_measured_from(missing: tuple[str, ...]) -> None:
    poses = in_space(recording(circle))
    kept = poses.select([name for name in poses.landmarks if name not in missing])
    assert Trajectory.from_poses(kept).depth is None
