"""Movements: the features of a recording that motion voters use."""

from dataclasses import replace

import numpy as np
import pytest

from app.recognition.features.motion import (
    RESTING_SHARE,
    STEPS,
    build_movement,
    find_followed_landmarks,
    find_hands,
    list_limbs,
    parse_body_part,
    uses_both_sides,
)
from app.recognition.poses.landmarks import other_side
from app.recognition.poses.trajectory import Trajectory
from tests.recognition.strategies import circle, recording

WRIST = ("right_wrist",)


def test_steps_are_equally_long_and_reached_in_time() -> None:
    seen = build_movement(Trajectory.from_poses(recording(circle)), WRIST)
    assert seen.paths.shape == (STEPS, 1, 2)
    steps = np.linalg.norm(np.diff(seen.paths[:, 0], axis=0), axis=1)
    assert steps.std() < 0.02 * steps.mean()
    assert (np.diff(seen.reached) > 0).all()
    # The rests, and a little of the path at either end, are cut.
    assert seen.duration == pytest.approx((1 - 2 * RESTING_SHARE) * 59 / 30, abs=2 / 30)


def test_arms_are_followed_in_equal_steps_without_the_body_and_where_all_are_seen() -> None:
    poses = recording(circle)
    lean = 30 * np.sin(np.linspace(0, np.pi, len(poses)))[:, None, None] * (1.0, 0.0)
    seen, leaning = (
        build_movement(Trajectory.from_poses(each), WRIST).ways
        for each in (poses, replace(poses, xy=poses.xy + lean))
    )
    steps = np.linalg.norm(np.diff(seen.reshape(STEPS, -1), axis=0), axis=1)
    assert steps.std() < 0.02 * steps.mean()
    np.testing.assert_allclose(leaning, seen, atol=0.02)
    one_arm = [name for name in poses.landmarks if name != "left_elbow"]
    alone = build_movement(Trajectory.from_poses(poses.select(one_arm)), WRIST)
    assert np.isnan(alone.ways).all()


def test_the_size_is_in_doublings_of_the_torso_and_unknown_without_one() -> None:
    whole = recording(circle)
    half = recording(lambda share: 0.5 * circle(share))
    large, small = (
        build_movement(Trajectory.from_poses(each), WRIST).size for each in (whole, half)
    )
    np.testing.assert_allclose(large - small, 1.0, atol=0.05)
    assert np.isnan(build_movement(Trajectory.from_poses(whole.select(WRIST)), WRIST).size).all()


def test_jitter_is_smoothed() -> None:
    calm = build_movement(Trajectory.from_poses(recording(circle)), WRIST)
    shaky = build_movement(Trajectory.from_poses(recording(circle, jitter=0.03)), WRIST)
    assert np.abs(shaky.paths - calm.paths).mean() < 0.03


def test_what_is_never_seen_does_not_move() -> None:
    poses = recording(circle).select(["right_wrist", "right_shoulder", "left_shoulder"])
    seen = build_movement(Trajectory.from_poses(poses), ("left_wrist", "right_wrist"))
    assert not seen.paths[:, 0].any()
    assert seen.paths[:, 1].any()


def test_a_gap_is_bridged_however_long() -> None:
    poses = recording(circle)
    hidden = poses.xy.copy()
    hidden[10:40, poses.landmarks.index("right_wrist")] = np.nan
    seen = build_movement(Trajectory.from_poses(replace(poses, xy=hidden)), WRIST)
    assert np.isfinite(seen.paths).all()


def test_exchanging_sides_is_naming_the_landmarks_of_the_other_side() -> None:
    wrists = ("left_wrist", "right_wrist")
    shown = Trajectory.from_poses(recording(circle))
    mistaken = replace(shown, landmarks=tuple(map(other_side, shown.landmarks)))
    exchanged = build_movement(shown, wrists).with_sides_exchanged(wrists)
    np.testing.assert_allclose(exchanged.paths, build_movement(mistaken, wrists).paths)
    np.testing.assert_allclose(exchanged.limbs, build_movement(mistaken, wrists).limbs)
    np.testing.assert_allclose(exchanged.ways, build_movement(mistaken, wrists).ways)
    spread = np.ptp(exchanged.paths, axis=0).max(axis=1)
    assert spread[0] > 0.5 > 1e-9 > spread[1]
    again = exchanged.with_sides_exchanged(wrists)
    np.testing.assert_array_equal(again.paths, build_movement(shown, wrists).paths)


def test_a_landmark_in_the_middle_is_on_both_sides() -> None:
    assert uses_both_sides(("left_wrist", "right_wrist", "nose"))
    assert not uses_both_sides(("left_elbow", "right_wrist"))


def test_limbs_are_seen_under_other_names() -> None:
    poses = recording(circle)
    kinect = {"right_shoulder": "ShoulderRight", "right_elbow": "ElbowRight"}
    kinect["right_wrist"] = "WristRight"
    kept = poses.select([*kinect, "left_shoulder"])
    named = replace(kept, landmarks=(*kinect.values(), "ShoulderLeft"))
    ours = build_movement(replace(Trajectory.from_poses(kept), unit="extent"), WRIST)
    theirs = build_movement(
        replace(Trajectory.from_poses(kept), landmarks=named.landmarks), ("WristRight",)
    )
    np.testing.assert_allclose(theirs.limbs, ours.limbs)
    assert np.isfinite(ours.limbs[:, :2]).all()


@pytest.mark.parametrize(
    ("name", "part"),
    [
        ("right_wrist", "right_wrist"),
        ("WristRight", "right_wrist"),
        ("HAND_LEFT", "left_hand"),
        ("nose", "nose"),
    ],
)
def test_parts_of_the_body_have_one_name(name: str, part: str) -> None:
    assert parse_body_part(name) == part


def test_a_language_follows_what_is_salient_in_any_gesture() -> None:
    followed = find_followed_landmarks([("right_wrist",), ("left_wrist", "right_wrist"), ()])
    assert followed == ("left_wrist", "right_wrist")
    assert {inner.split("_")[0] for inner, _ in list_limbs(WRIST)} == {"right"}
    assert find_hands(("left_wrist", "left_hand_tip")) == 1
    assert find_hands(("left_wrist", "right_wrist", "nose")) == 3
