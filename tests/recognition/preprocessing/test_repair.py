"""Repair of bad keypoints: what it undoes, what it says, and what it leaves alone."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition import Gesture, Language, PoseSequence, Recognizer
from app.recognition.gestures.profile import Tuning
from app.recognition.poses.landmarks import POSE_LANDMARKS
from app.recognition.preprocessing.repair import pair_sides, repair_poses, swap_sides
from tests.recognition.damaged_poses import with_sides_exchanged
from tests.recognition.strategies import SHAPES, circle, in_space, recording, recordings

WRIST = POSE_LANDMARKS.index("right_wrist")


def with_jumps(poses: PoseSequence, frames: list[int], pixels: float = 120) -> PoseSequence:
    xy = poses.xy.copy()
    xy[frames, WRIST] += pixels
    return replace(poses, xy=xy)


@st.composite
def damaged(draw: st.DrawFn) -> PoseSequence:
    """Draw a recording with any mixture of the faults, far beyond what can be repaired."""
    poses = draw(recordings())
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    share = draw(st.floats(0, 0.5))
    frames = np.flatnonzero(random.uniform(size=len(poses)) < share).tolist()
    poses = with_sides_exchanged(poses, frames)
    shape = poses.xy.shape[:2]
    far = random.normal(0, 150, (*shape, 2)) * (random.uniform(size=(*shape, 1)) < share / 2)
    gone = random.uniform(size=shape) < draw(st.floats(0, 0.9))
    return replace(poses, xy=np.where(gone[..., None], np.nan, poses.xy + far))


@given(recordings())
def test_an_undamaged_recording_is_returned_as_it_is(poses: PoseSequence) -> None:
    repair = repair_poses(poses)
    assert repair.poses is poses
    assert repair.findings == ()


@given(damaged())
def test_repairing_again_changes_nothing(poses: PoseSequence) -> None:
    once = repair_poses(poses).poses
    assert repair_poses(once).poses == once


@given(damaged())
def test_no_place_is_invented(poses: PoseSequence) -> None:
    """Every place that is left was in the same frame before, on the same side or the other."""
    repair = repair_poses(poses)
    before, after = poses.xy, repair.poses.xy
    left, right = pair_sides(poses.landmarks)
    order = np.arange(len(poses.landmarks))
    order[[*left, *right]] = [*right, *left]
    kept = np.isfinite(after).all(axis=2)
    same = (after == before).all(axis=2) | (after == before[:, order]).all(axis=2)
    assert same[kept].all()
    assert (repair.poses.time == poses.time).all()


@given(damaged(), st.floats(0.2, 5), st.floats(-300, 300))
def test_size_and_place_in_the_image_do_not_matter(
    poses: PoseSequence, scale: float, shift: float
) -> None:
    moved = replace(poses, xy=poses.xy * scale + shift)
    one, other = repair_poses(poses), repair_poses(moved)
    np.testing.assert_array_equal(one.exchanged, other.exchanged)
    np.testing.assert_array_equal(one.jumps, other.jumps)


def test_exchanged_sides_are_put_right_with_their_confidence() -> None:
    poses = recording(circle, jitter=0.005)
    confidence = np.random.default_rng(1).uniform(size=poses.xy.shape[:2])
    whole = replace(poses, confidence=confidence)
    left, right = pair_sides(poses.landmarks)
    mistaken = with_sides_exchanged(poses, [7, 8, 30])
    swapped = confidence.copy()
    swapped[np.ix_([7, 8, 30], [*left, *right])] = confidence[np.ix_([7, 8, 30], [*right, *left])]
    assert repair_poses(replace(mistaken, confidence=swapped)).poses == whole


def test_what_was_done_is_told_with_counts() -> None:
    poses = with_sides_exchanged(with_jumps(recording(circle), [12, 40, 41]), [20, 21])
    assert repair_poses(poses).findings == (
        "left and right were exchanged back in 2 of 60 frames",
        "places that landmarks jumped to were left out: right_wrist in 3 of 60 frames",
    )


@pytest.mark.parametrize("frames", [0, 1, 2, 3])
def test_short_and_empty_recordings_are_returned_as_they_are(frames: int) -> None:
    poses = recording(circle, frames=frames)
    assert repair_poses(poses).poses is poses
    unseen = replace(poses, xy=np.full_like(poses.xy, np.nan))
    assert repair_poses(unseen).poses is unseen


def test_jumps_cost_profile_full_no_confidence() -> None:
    gestures = [
        Gesture.from_demonstration(label, recording(shape)) for label, shape in SHAPES.items()
    ]
    language = Language(name="shapes", gestures=gestures)
    bad = with_jumps(recording(circle, jitter=0.005), list(range(3, 57, 5)))
    result = Recognizer(language, "full").recognize(bad)
    clean = Recognizer(language, "full").recognize(recording(circle, jitter=0.005))
    assert result.nearest == "circle"
    assert result.confidence == pytest.approx(clean.confidence, abs=0.05)
    left_as_it_is = Recognizer(language, "full", tuning=Tuning(keypoints_repaired=False))
    assert left_as_it_is.recognize(bad).confidence < result.confidence - 0.1


def test_places_in_the_world_are_exchanged_back_with_their_landmarks() -> None:
    poses = in_space(recording(circle))
    assert poses.world is not None
    damaged = np.zeros(len(poses), dtype=bool)
    damaged[20:26] = True
    swapped = replace(
        poses,
        xy=swap_sides(poses.xy, poses.landmarks, damaged),
        world=swap_sides(poses.world, poses.landmarks, damaged),
    )
    np.testing.assert_array_equal(repair_poses(swapped).poses.world, poses.world)
