"""Variants of one demonstration: like it, not the same, and possible for a body."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.recognition import Gesture, Language, PoseSequence
from app.recognition.calibrated_vote import CalibratedVote
from app.recognition.errors import RecognitionError
from app.recognition.gesture import condensed
from app.recognition.trajectory import Trajectory
from app.recognition.variation import SPREADS, Person, variants
from tests.recognition.strategies import SHAPES, recording, recordings

PEOPLE = tuple(SPREADS)
seeds = st.integers(0, 2**32 - 1)
people = st.sampled_from(PEOPLE)


def demonstration(poses: PoseSequence) -> Trajectory:
    return condensed(Trajectory.from_poses(poses))


@settings(max_examples=20, deadline=None)
@given(recordings(), seeds, people)
def test_variants_have_the_landmarks_moments_and_unit_of_the_demonstration(
    poses: PoseSequence, seed: int, person: Person
) -> None:
    shown = demonstration(poses)
    for variant in variants(shown, 3, seed=seed, person=person):
        assert variant.landmarks == shown.landmarks
        assert variant.unit == shown.unit
        assert variant.xy.shape == shown.xy.shape
        assert np.isfinite(variant.xy).all()
        assert variant.time[0] == 0
        assert (np.diff(np.round(variant.time, 4)) > 0).all()


@settings(max_examples=20, deadline=None)
@given(recordings(), seeds, people)
def test_the_same_seed_gives_the_same_variants_and_more_of_them_begin_alike(
    poses: PoseSequence, seed: int, person: Person
) -> None:
    shown = demonstration(poses)
    few = variants(shown, 2, seed=seed, person=person)
    many = variants(shown, 5, seed=seed, person=person)
    for one, other in zip(few, many, strict=False):
        np.testing.assert_array_equal(one.xy, other.xy)
        np.testing.assert_array_equal(one.time, other.time)
    assert not np.array_equal(many[3].xy, many[4].xy)


def test_what_is_not_seen_in_the_demonstration_is_not_seen_in_its_variants() -> None:
    shown = demonstration(recording(SHAPES["circle"]))
    xy = shown.xy.copy()
    xy[10:14, shown.landmarks.index("right_wrist")] = np.nan
    xy[:, shown.landmarks.index("left_elbow")] = np.nan
    for variant in variants(replace(shown, xy=xy), 3):
        np.testing.assert_array_equal(np.isnan(variant.xy), np.isnan(xy))


def test_fewer_than_none_are_refused() -> None:
    shown = demonstration(recording(SHAPES["circle"]))
    assert variants(shown, 0) == ()
    with pytest.raises(RecognitionError, match="-1"):
        variants(shown, -1)


@pytest.mark.parametrize("person", PEOPLE)
def test_most_variants_are_recognised_as_their_gesture(person: Person) -> None:
    gestures = [Gesture.from_demonstration(n, recording(s)) for n, s in SHAPES.items()]
    vote = CalibratedVote(Language(name="shapes", gestures=gestures).gestures)
    named = []
    for gesture in gestures:
        assert gesture.trajectory is not None
        for variant in variants(gesture.trajectory, 10, person=person):
            result = vote.recognize(condensed(variant))
            named.append(result is not None and result.nearest == gesture.label)
    assert np.mean(named) >= 0.9
