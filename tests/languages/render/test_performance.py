"""A take is composed of the phases that recognition expects, and is the same for the same seed."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from languages.render.gestures import DRAWINGS
from languages.render.performance import SALUTE, Manner, move_about, perform

PHASES = [
    *("rest", "raise", "salute", "transit", "pause", "stroke"),
    *("pause", "transit", "salute", "lower", "rest"),
]


@pytest.mark.parametrize("gesture", sorted(DRAWINGS))
def test_a_take_runs_from_salute_to_salute(gesture: str) -> None:
    take = perform(DRAWINGS[gesture], Manner(), 25, seed=1)
    assert [phase.name for phase in take.phases] == PHASES
    ends = [phase.end for phase in take.phases]
    assert [phase.start for phase in take.phases] == [0, *ends[:-1]]
    assert ends[-1] * 25 == pytest.approx(len(take))
    assert len(take.right) == len(take.left) == len(take.body)


@pytest.mark.parametrize("gesture", sorted(DRAWINGS))
def test_the_hand_keeps_still_while_it_salutes(gesture: str) -> None:
    take = perform(DRAWINGS[gesture], Manner(), 25, seed=1)
    for phase in take.phases:
        if phase.name == "salute":
            held = take.right[round(phase.start * 25) : round(phase.end * 25)]
            away = [np.linalg.norm(target.wrist - SALUTE.wrist) for target in held]
            assert max(away) < 0.02
            assert all(np.array_equal(target.fingers, SALUTE.fingers) for target in held)


@given(
    st.sampled_from(sorted(DRAWINGS)),
    st.floats(0.7, 1.4),
    st.floats(0.7, 1.25),
    st.integers(0, 100),
)
@settings(max_examples=25, deadline=None)
def test_the_hand_never_jumps(gesture: str, tempo: float, size: float, seed: int) -> None:
    take = perform(DRAWINGS[gesture], Manner(tempo=tempo, size=size), 25, seed)
    wrists = np.array([target.wrist for target in take.right])
    # A fast human hand reaches 4 m/s; between two frames it is 0.16 m further.
    assert np.linalg.norm(np.diff(wrists, axis=0), axis=1).max() < 0.16


def test_only_the_sweep_moves_both_hands() -> None:
    for gesture, drawing in DRAWINGS.items():
        take = perform(drawing, Manner(), 25, seed=1)
        (stroke,) = [phase for phase in take.phases if phase.name == "stroke"]
        left = [target.wrist for target in take.left[round(stroke.start * 25) : -1]]
        assert (np.ptp(left, axis=0).max() > 0.1) == (gesture == "sweep")


def test_the_same_seed_gives_the_same_take_and_another_seed_another() -> None:
    one, same, other = (perform(DRAWINGS["three"], Manner(), 25, seed) for seed in (1, 1, 2))
    wrists = [np.array([target.wrist for target in take.right]) for take in (one, same, other)]
    assert np.array_equal(wrists[0], wrists[1])
    assert not np.array_equal(wrists[0], wrists[2])


def test_moving_about_holds_no_salute() -> None:
    take = move_about(Manner(), 25, seed=1)
    assert "salute" not in {phase.name for phase in take.phases}
    assert not any(np.array_equal(target.fingers, SALUTE.fingers) for target in take.right)
