"""The salute: which hands show it, how well against the published rule, and since when."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from app.recognition.errors import PoseError
from app.recognition.poses.frame import Hand
from app.recognition.poses.sequence import FloatArray
from app.recognition.recording.salute import (
    HOLD_SECONDS,
    HeldTrigger,
    best_salute,
    salute_score,
)
from benchmarks.accuracy.pictures import check_published_rule
from tests.recognition.parametric_hand import (
    SHAPES,
    Finger,
    View,
    hand_xy,
    labelled_hands,
    salute,
)

SALUTING = hand_xy(salute())
FLAT = hand_xy((Finger(3), Finger(0), Finger(-3), Finger(-6)))
BENT = (75.0, 85.0, 50.0)


def test_a_salute_is_one() -> None:
    assert salute_score(SALUTING) > 0.9
    assert check_published_rule(SALUTING)


@pytest.mark.parametrize(
    "fingers",
    [
        (Finger(3), Finger(0), Finger(-3), Finger(-6)),
        (Finger(16), Finger(4), Finger(-8), Finger(-21)),
        (Finger(13, BENT), Finger(13, BENT), Finger(-13, BENT), Finger(-13, BENT)),
        (Finger(12), Finger(-6), Finger(-3, BENT), Finger(-7, BENT)),
        (Finger(2), Finger(0), Finger(-3, BENT), Finger(-7, BENT)),
        (Finger(6), Finger(1, BENT), Finger(-3, BENT), Finger(-10)),
    ],
    ids=["flat", "open", "fist", "victory", "two together", "horns"],
)
def test_other_hands_are_none(fingers: tuple[Finger, Finger, Finger, Finger]) -> None:
    assert salute_score(hand_xy(fingers)) < 0.2


@pytest.mark.parametrize("shape", ["victory", "two together"])
def test_the_published_rule_takes_folded_fingers_for_a_salute(shape: str) -> None:
    random = np.random.default_rng(0)
    hands = [hand_xy(SHAPES[shape](random)) for _ in range(50)]
    assert sum(map(check_published_rule, hands)) > 40
    assert sum(salute_score(hand) > 0.5 for hand in hands) == 0


def test_fingertips_that_the_model_bends_still_salute_when_the_v_is_wide() -> None:
    fingers = salute(gap=28)
    misread = (*fingers[:2], Finger(-14, (10, 80, 45)), Finger(-17, (10, 80, 45)))
    assert salute_score(hand_xy(misread)) > 0.5


def test_an_edge_on_hand_is_not_judged() -> None:
    assert salute_score(hand_xy(salute(), View(yaw=85))) < 0.5


@given(
    scale=st.floats(0.01, 1000),
    degrees=st.floats(-180, 180),
    shift=st.tuples(st.floats(-2000, 2000), st.floats(-2000, 2000)),
    mirrored=st.booleans(),
    seed=st.integers(0, 1000),
)
def test_place_size_turn_and_side_do_not_matter(
    scale: float, degrees: float, shift: tuple[float, float], mirrored: bool, seed: int
) -> None:
    (hand,) = labelled_hands(1, seed)
    turn = math.radians(degrees)
    rotation = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
    moved = hand.xy * ([-1, 1] if mirrored else [1, 1]) @ rotation * scale + np.array(shift)
    assert salute_score(moved) == pytest.approx(salute_score(hand.xy), abs=1e-5)


@given(st.integers(0, 10**6), st.floats(0, 1))
def test_the_score_is_a_share(seed: int, noise: float) -> None:
    (hand,) = labelled_hands(1, seed, noise)
    assert 0 <= salute_score(hand.xy) <= 1


@given(arrays(np.float64, (21, 2), elements=st.floats(allow_nan=False, allow_infinity=False)))
def test_coordinates_as_large_as_numbers_go_give_a_share_too(hand: FloatArray) -> None:
    assert 0 <= salute_score(hand) <= 1


def test_a_hand_that_is_partly_unseen_does_not_salute() -> None:
    hidden = SALUTING.copy()
    hidden[12] = np.nan
    assert salute_score(hidden) == 0
    assert not check_published_rule(hidden)


def test_a_hand_has_twenty_one_points() -> None:
    with pytest.raises(PoseError, match=r"\(20, 2\), expected \(21, 2\)"):
        salute_score(SALUTING[:20])


def test_points_on_one_spot_are_no_salute() -> None:
    assert salute_score(np.zeros((21, 2))) < 0.5


@pytest.mark.parametrize("noise", [0.02, 0.04])
def test_at_least_the_published_recall_at_a_tenth_of_its_false_positives(noise: float) -> None:
    hands = list(labelled_hands(2000, seed=5, noise=noise))
    saluting = [hand.xy for hand in hands if hand.salutes]
    others = [hand.xy for hand in hands if not hand.salutes]
    found = np.mean([salute_score(hand) > 0.5 for hand in saluting])
    wrong = np.mean([salute_score(hand) > 0.5 for hand in others])
    assert found >= np.mean([check_published_rule(hand) for hand in saluting])
    assert wrong <= np.mean([check_published_rule(hand) for hand in others]) / 10


def test_the_best_hand_counts_whichever_side_and_size() -> None:
    flat = Hand(xy=3 * FLAT, side="right", score=0.9)
    saluting = Hand(xy=SALUTING, side="left", score=0.9)
    assert best_salute((flat, saluting)) == salute_score(SALUTING)
    assert best_salute(()) == 0


def test_a_hand_that_is_asked_for_twice_has_the_same_score() -> None:
    shown = labelled_hands(100, seed=7, noise=0.05)
    hands = [Hand(xy=each.xy, side="left", score=0.9) for each in shown]
    scores = [salute_score(hand.xy) for hand in hands]
    for _ in range(2):
        assert [best_salute((hand,)) for hand in hands] == scores
        assert best_salute(hands) == max(scores)


def held_since(*frames: tuple[float, float]) -> float | None:
    """Return the time at which a salute first counts."""
    trigger = HeldTrigger()
    return next((time for time, score in frames if trigger.update(time, score)), None)


@pytest.mark.parametrize("rate", [8.0, 15.0, 30.0, 120.0])
def test_a_salute_counts_after_the_hold_time_at_any_rate(rate: float) -> None:
    frames = [(index / rate, 0.9) for index in range(int(rate))]
    since = held_since(*frames)
    assert since is not None
    assert HOLD_SECONDS - 1e-6 <= since <= HOLD_SECONDS + 2 / rate


def test_two_frames_of_a_stalled_camera_are_no_salute() -> None:
    assert held_since((0.0, 0.9), (2.0, 0.9)) is None


def test_a_salute_in_every_other_frame_is_not_believed() -> None:
    assert held_since(*[(index / 25, 0.9 * (index % 2)) for index in range(100)]) is None


def test_a_salute_is_released_after_the_dropout_time_and_dated_back() -> None:
    trigger = HeldTrigger()
    for index in range(25):
        trigger.update(index / 25, 0.9)
    assert trigger.held
    for index in range(25, 36):
        assert trigger.update(index / 25, 0.0)
    for index in range(36, 40):
        trigger.update(index / 25, 0.0)
    assert not trigger.held
    assert trigger.since == 0
    assert trigger.until == pytest.approx(24 / 25)
