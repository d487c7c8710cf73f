"""Variants of one demonstration: like it, not the same, and possible for a body."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.recognition import Language, PoseSequence
from app.recognition.decision.fused_vote import FusedVote
from app.recognition.errors import OsgError
from app.recognition.gestures.demonstration import condense
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory, Unit
from app.recognition.simulation.variation import (
    SPREADS,
    Person,
    Spread,
    draw_variants,
    take_turns,
    vary,
)
from tests.recognition.strategies import SHAPES, circle, line, recording, recordings

PEOPLE = tuple(SPREADS)
SAMPLE_LANGUAGE = Path(__file__).resolve().parents[3] / "languages" / "osg-table-2.json"
seeds = st.integers(0, 2**32 - 1)
people = st.sampled_from(PEOPLE)


def demonstration(poses: PoseSequence) -> Trajectory:
    return condense(Trajectory.from_poses(poses))


@settings(max_examples=20, deadline=None)
@given(recordings(), seeds, people)
def test_variants_have_the_landmarks_moments_and_unit_of_the_demonstration(
    poses: PoseSequence, seed: int, person: Person
) -> None:
    shown = demonstration(poses)
    for variant in draw_variants(shown, 3, seed=seed, person=person):
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
    few = draw_variants(shown, 2, seed=seed, person=person)
    many = draw_variants(shown, 5, seed=seed, person=person)
    for one, other in zip(few, many, strict=False):
        np.testing.assert_array_equal(one.xy, other.xy)
        np.testing.assert_array_equal(one.time, other.time)
    assert not np.array_equal(many[3].xy, many[4].xy)


def test_what_is_not_seen_in_the_demonstration_is_not_seen_in_its_variants() -> None:
    shown = demonstration(recording(SHAPES["circle"]))
    xy = shown.xy.copy()
    xy[10:14, shown.landmarks.index("right_wrist")] = np.nan
    xy[:, shown.landmarks.index("left_elbow")] = np.nan
    for variant in draw_variants(replace(shown, xy=xy), 3):
        np.testing.assert_array_equal(np.isnan(variant.xy), np.isnan(xy))


def test_a_single_moment_does_not_vary() -> None:
    single = demonstration(recording(SHAPES["circle"])).between(0.0, 0.0)
    np.testing.assert_array_equal(draw_variants(single, 2)[1].xy, single.xy)


def similar(trajectory: Trajectory, factor: float, shift: tuple[float, float]) -> Trajectory:
    return replace(trajectory, xy=trajectory.xy * factor + shift)


@settings(max_examples=15, deadline=None)
@given(
    recordings(),
    st.floats(0.2, 5.0),
    st.tuples(st.floats(-3, 3), st.floats(-3, 3)),
    people,
    st.sampled_from(["torso_length", "extent"]),
)
def test_variants_of_a_larger_demonstration_elsewhere_are_larger_and_elsewhere(
    poses: PoseSequence, factor: float, shift: tuple[float, float], person: Person, unit: Unit
) -> None:
    shown = replace(demonstration(poses), unit=unit)
    here = draw_variants(shown, 2, person=person)
    there = draw_variants(similar(shown, factor, shift), 2, person=person)
    for one, other in zip(here, there, strict=True):
        np.testing.assert_allclose(other.xy, similar(one, factor, shift).xy, atol=1e-9 * factor)


def bone_lengths(trajectory: Trajectory, inner: str, outer: str) -> FloatArray:
    ends = trajectory.select([inner, outer]).xy
    return np.asarray(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1))


@settings(max_examples=15, deadline=None)
@given(recordings(), seeds, people)
def test_no_bone_of_an_arm_becomes_longer_than_a_bone_can_look(
    poses: PoseSequence, seed: int, person: Person
) -> None:
    shown = demonstration(poses)
    for bone, share in (("shoulder", "elbow"), 0.65), (("elbow", "wrist"), 0.51):
        inner, outer = (f"right_{end}" for end in bone)
        bound = max(1.05 * bone_lengths(shown, inner, outer).max(), share)
        for variant in draw_variants(shown, 5, seed=seed, person=person):
            # The shoulders sway, so the trunk's length is not exactly 1.
            assert bone_lengths(variant, inner, outer).max() <= 1.02 * bound


def test_somebody_elses_takes_differ_by_more_than_ones_own() -> None:
    shown = demonstration(recording(SHAPES["infinity"], jitter=0.003))
    wrist = [shown.landmarks.index("right_wrist")]
    size = np.sqrt(((shown.xy - shown.xy.mean(axis=0))[:, wrist] ** 2).sum(axis=2).mean())
    away, doublings = [], []
    for person in PEOPLE:
        takes = draw_variants(shown, 100, person=person)
        offsets = np.array([take.xy[:, wrist] - shown.xy[:, wrist] for take in takes])
        away.append(float(np.sqrt((offsets**2).sum(axis=(2, 3)).mean()) / size))
        doublings.append(float(np.std([np.log2(take.time[-1] / shown.time[-1]) for take in takes])))
    assert 0.1 < away[0] < 0.8 * away[1] < 0.6
    assert 0.1 < doublings[0] < 0.5 * doublings[1] < 0.5


def direction_of_bone(trajectory: Trajectory, inner: str, outer: str) -> FloatArray:
    ends = trajectory.select([inner, outer]).xy
    return np.asarray(np.unwrap(np.arctan2(*(ends[:, 1] - ends[:, 0]).T)))


def test_a_hand_turns_with_its_forearm() -> None:
    """A turn of the forearm turns the hand as far, whatever its direction in the demonstration."""
    swing = np.linspace(-0.7, 0.7, 40)
    forearm = 0.5 * np.stack([np.sin(swing), -np.cos(swing)], axis=1)
    elbow = np.full((40, 2), 0.2) + 0.1 * forearm
    shown = Trajectory(
        landmarks=("right_elbow", "right_wrist", "right_index"),
        xy=np.stack([elbow, elbow + forearm, elbow + forearm + (0.15, 0)], axis=1),
        time=np.linspace(0, 2, 40),
        unit="torso_length",
    )
    wavering = Spread(
        tempo=0, size=0, slant=0, stretch=0, shear=0, waver=0.3, care=0, sway=0
    )  # without drifts of its own the hand follows the forearm
    bones = ("right_elbow", "right_wrist"), ("right_wrist", "right_index")
    for variant in vary(shown, 20, wavering):
        arm, hand = (
            direction_of_bone(variant, *bone) - direction_of_bone(shown, *bone) for bone in bones
        )
        assert np.abs(arm).max() > 0.05
        assert np.abs(hand - arm).max() < 0.25 * np.abs(arm).max()


def test_a_hand_whose_forearm_was_never_seen_goes_its_own_way() -> None:
    turn = np.linspace(0, 6, 40)
    hand = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    unseen = np.full((40, 2), np.nan)
    shown = Trajectory(
        landmarks=("right_elbow", "right_wrist", "right_index"),
        xy=np.stack([unseen, unseen, hand], axis=1),
        time=np.linspace(0, 2, 40),
        unit="torso_length",
    )
    for variant in draw_variants(shown, 10):
        assert np.ptp(variant.select(["right_index"]).xy, axis=0).min() > 1


def test_what_rests_stays_near_its_place() -> None:
    shown = demonstration(recording(SHAPES["circle"]))
    for variant in draw_variants(shown, 20, person="another"):
        moved = np.abs(variant.select(["left_wrist"]).xy - shown.select(["left_wrist"]).xy)
        assert 0 < moved.max() < 0.15


def test_fewer_than_none_are_refused() -> None:
    shown = demonstration(recording(SHAPES["circle"]))
    assert draw_variants(shown, 0) == ()
    with pytest.raises(OsgError, match="-1"):
        draw_variants(shown, -1)


@pytest.mark.parametrize(("person", "share"), [("same", 0.95), ("another", 0.85)])
def test_most_variants_of_the_sample_gestures_are_recognised(person: Person, share: float) -> None:
    language = Language.load(SAMPLE_LANGUAGE)
    vote = FusedVote(language.gestures)
    named = []
    for gesture in language.gestures:
        assert gesture.trajectory is not None
        for variant in draw_variants(gesture.trajectory, 5, person=person):
            result = vote.recognize(condense(variant))
            named.append(result is not None and result.nearest == gesture.label)
    assert np.mean(named) >= share


def test_takes_are_of_all_demonstrations_in_turn() -> None:
    one, other = (Trajectory.from_poses(recording(shape)) for shape in (circle, line))
    first, second = (draw_variants(each, 3, seed=4) for each in (one, other))
    taken = take_turns([first, second])
    assert list(map(id, taken)) == list(map(id, (first[0], second[1], first[2])))
    assert take_turns([first]) == first
