"""Arms kept within what their bones can reach."""

import numpy as np
import pytest

from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.limb_length import LEEWAY, SHARE_OF_TORSO, limit_limbs

ARM = ("right_shoulder", "right_elbow", "right_wrist", "right_index")


def still(**places: tuple[float, float]) -> Trajectory:
    xy = np.tile(np.array([*places.values()]), (3, 1, 1))
    time = np.arange(3) / 30
    return Trajectory(landmarks=tuple(places), xy=xy, time=time, unit="torso_length")


SHOWN = still(
    right_shoulder=(0.0, 0.0),
    right_elbow=(0.3, 0.0),
    right_wrist=(0.6, 0.0),
    right_index=(0.7, 0.0),
)


def bones(paths: FloatArray) -> FloatArray:
    return np.asarray(np.linalg.norm(np.diff(paths, axis=-2), axis=-1))


def test_an_arm_within_reach_stays_as_it_is() -> None:
    np.testing.assert_array_equal(limit_limbs(SHOWN.xy, SHOWN), SHOWN.xy)


def test_a_wrist_too_far_away_takes_its_elbow_along_and_stops_where_the_arm_ends() -> None:
    paths = np.stack([SHOWN.xy, SHOWN.xy])
    paths[1, :, 2:, 1] += 2.0
    near, far = limit_limbs(paths, SHOWN)
    np.testing.assert_array_equal(near, SHOWN.xy)
    np.testing.assert_allclose(bones(far)[:, :2], LEEWAY * 0.3)
    assert (bones(far)[:, 2] <= LEEWAY * 0.1 + 1e-9).all()
    assert (far[:, 1, 1] > 0).all()
    np.testing.assert_array_equal(far[:, 0], SHOWN.xy[:, 0])


def test_a_bone_may_look_as_long_as_beside_this_trunk_even_if_shown_shorter() -> None:
    trunk = still(
        left_shoulder=(0.3, 0.0),
        right_shoulder=(-0.3, 0.0),
        left_hip=(0.2, 2.0),
        right_hip=(-0.2, 2.0),
        right_elbow=(-0.4, 0.0),
    )
    stretched = trunk.xy.copy()
    stretched[:, 4, 0] = -10.0
    elbow = limit_limbs(stretched, trunk)[:, 4]
    np.testing.assert_allclose(elbow - trunk.xy[:, 1], [[-2.0 * SHARE_OF_TORSO["elbow"], 0]] * 3)


@pytest.mark.parametrize("unseen", ["right_elbow", "right_shoulder"])
def test_a_bone_that_was_never_seen_bounds_nothing(unseen: str) -> None:
    xy = SHOWN.xy.copy()
    xy[:, ARM.index(unseen)] = np.nan
    shown = Trajectory(landmarks=ARM, xy=xy, time=SHOWN.time, unit="extent")
    moved = SHOWN.xy + (0.0, 5.0)
    np.testing.assert_array_equal(limit_limbs(moved, shown), moved)


def test_landmarks_of_no_arm_go_anywhere() -> None:
    shown = still(nose=(0.0, -0.8), hand_marker=(0.5, 0.0))
    np.testing.assert_array_equal(limit_limbs(shown.xy * 9, shown), shown.xy * 9)
