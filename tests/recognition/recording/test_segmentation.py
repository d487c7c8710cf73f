"""Takes between salutes: from clean streams, from flickering ones, and from none."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.recognition.poses.sequence import FloatArray
from app.recognition.recording.recording import Recording
from app.recognition.recording.segmentation import (
    LONGEST_TAKE,
    SHORTEST_TAKE,
    Bracket,
    TakeMachine,
    TakeState,
    takes_in,
)
from tests.recognition.motions import (
    SALUTE_PLACE,
    Movement,
    Performance,
    circle,
    perform,
    still,
)

RATE = 25
TOP = np.array([-0.9, -0.3])


def scores(*stretches: tuple[float, float], rate: float = RATE) -> tuple[FloatArray, FloatArray]:
    """Make a stream of ``(score, seconds)`` stretches: times and scores."""
    values = np.concatenate([np.full(round(seconds * rate), score) for score, seconds in stretches])
    return np.arange(len(values)) / rate, values


def brackets(*stretches: tuple[float, float], rate: float = RATE) -> list[Bracket]:
    machine = TakeMachine()
    times, values = scores(*stretches, rate=rate)
    found = [
        machine.update(time, score)
        for time, score in zip(times.tolist(), values.tolist(), strict=True)
    ]
    found.append(machine.finish(float(times[-1])))
    return [bracket for bracket in found if bracket is not None]


SALUTE, OTHER = 0.9, 0.05


@pytest.mark.parametrize("rate", [10.0, 25.0, 60.0])
def test_a_take_lies_between_two_salutes(rate: float) -> None:
    (found,) = brackets(
        (OTHER, 0.5), (SALUTE, 0.8), (OTHER, 2.0), (SALUTE, 0.8), (OTHER, 0.5), rate=rate
    )
    assert found.closed
    assert (found.start, found.end) == pytest.approx((1.3, 3.3), abs=2 / rate)
    assert found.opening.start == pytest.approx(0.5, abs=1 / rate)


def test_the_start_salute_never_counts_as_stop_however_long_it_is_held() -> None:
    (found,) = brackets((SALUTE, 10), (OTHER, 2), (SALUTE, 0.6))
    assert found.closed
    assert (found.start, found.end) == pytest.approx((9.96, 12.0))


def test_a_stop_salute_held_on_does_not_begin_the_next_take() -> None:
    assert len(brackets((SALUTE, 0.6), (OTHER, 2), (SALUTE, 6), (OTHER, 3))) == 1


def test_two_gestures_take_four_salutes() -> None:
    found = brackets(*[(SALUTE, 0.6), (OTHER, 2.0)] * 4)
    assert [bracket.closed for bracket in found] == [True, True]


def test_a_take_that_is_not_closed_ends_with_the_clip() -> None:
    (found,) = brackets((SALUTE, 0.6), (OTHER, 2))
    assert not found.closed
    assert (found.start, found.end) == pytest.approx((0.56, 2.56))


@pytest.mark.parametrize(
    "stretches",
    [
        ((OTHER, 4),),
        ((SALUTE, 4),),
        ((OTHER, 3), (SALUTE, 0.2), (OTHER, 3)),
        ((OTHER, 3), (SALUTE, 0.6), (OTHER, 0.4)),
    ],
    ids=["nobody salutes", "one endless salute", "too short", "a salute at the very end"],
)
def test_where_no_take_begins_there_is_none(stretches: tuple[tuple[float, float], ...]) -> None:
    assert brackets(*stretches) == []


def test_a_hand_lost_for_half_a_second_still_salutes() -> None:
    lost = ((SALUTE, 0.4), (OTHER, 0.44), (SALUTE, 0.4))
    assert len(brackets(*lost, (OTHER, 2), *lost, (OTHER, 1))) == 1


def test_a_salute_that_comes_back_at_once_was_only_lost() -> None:
    (found,) = brackets(
        (SALUTE, 0.6), (OTHER, SHORTEST_TAKE - 0.1), (SALUTE, 0.6), (OTHER, 2), (SALUTE, 0.6)
    )
    assert (found.start, found.end) == pytest.approx((1.9, 3.9), abs=0.05)


def test_single_wrong_detections_change_nothing() -> None:
    clean = [(OTHER, 1.0), (SALUTE, 0.8), (OTHER, 3.0), (SALUTE, 0.8), (OTHER, 1.0)]
    times, values = scores(*clean)
    values = values.copy()
    values[[5, 50, 60, 70, 115]] = 1.0
    machine = TakeMachine()
    found = [machine.update(*frame) for frame in zip(times.tolist(), values.tolist(), strict=True)]
    assert [each for each in found if each] == brackets(*clean)


def test_a_trembling_score_is_one_salute() -> None:
    """Hysteresis: between the two thresholds a salute goes on, and none begins."""
    trembling = [(0.6, 0.08), (0.4, 0.08)] * 5
    assert len(brackets(*trembling, (OTHER, 2), *trembling)) == 1
    assert brackets((0.4, 2), (OTHER, 2), (0.4, 2)) == []


def test_a_forgotten_stop_salute_costs_one_take_not_all_that_follow() -> None:
    found = brackets(
        (SALUTE, 0.6),
        (OTHER, LONGEST_TAKE + 5),
        (SALUTE, 0.6),
        (OTHER, 2),
        (SALUTE, 0.6),
        (OTHER, 1),
    )
    assert [bracket.closed for bracket in found] == [False, True]
    assert found[0].end - found[0].start == pytest.approx(LONGEST_TAKE)
    assert found[1].end - found[1].start == pytest.approx(2, abs=0.1)


def test_the_state_can_be_shown_while_it_runs() -> None:
    machine = TakeMachine()
    states: list[TakeState] = []
    times, values = scores((OTHER, 1), (SALUTE, 0.6), (OTHER, 2), (SALUTE, 0.6), (OTHER, 1))
    for time, score in zip(times.tolist(), values.tolist(), strict=True):
        machine.update(time, score)
        if not states or states[-1] is not machine.state:
            states.append(machine.state)
    assert states == [TakeState.idle, TakeState.recording, TakeState.done, TakeState.idle]


@given(
    st.lists(
        st.tuples(st.sampled_from([0.0, 0.4, 0.6, 1.0]), st.floats(0.04, 1.5)),
        min_size=1,
        max_size=20,
    )
)
@settings(max_examples=100, deadline=None)
def test_takes_never_overlap_and_only_the_last_may_be_open(
    stretches: list[tuple[float, float]],
) -> None:
    found = brackets(*stretches)
    for bracket in found:
        assert bracket.end - bracket.start >= SHORTEST_TAKE - 1e-9
        assert bracket.opening.start <= bracket.start
    for before, after in pairwise(found):
        assert before.closed
        assert before.end < after.start


def recorded() -> tuple[Recording, Performance]:
    """Salute, reach, circle, return, salute, with a pause around the circle."""
    performance = perform(
        [
            still(SALUTE_PLACE, 0.8),
            Movement(TOP, 0.5),
            still(TOP, 0.15),
            Movement(circle(TOP), 1.6),
            still(TOP, 0.15),
            Movement(SALUTE_PLACE, 0.5),
            still(SALUTE_PLACE, 0.8),
        ],
        noise=0.004,
    )
    time, moments = performance.poses.time, performance.moments
    salutes = (time < moments[1]) | (time >= moments[-2])
    recording = Recording(
        poses=performance.poses,
        hands=((),) * len(time),
        salute=np.where(salutes, SALUTE, OTHER),
    )
    return recording, performance


def test_a_take_holds_the_stroke_and_all_between_the_salutes() -> None:
    recording, performance = recorded()
    (take,) = takes_in(recording)
    moments = performance.moments
    assert take.closed
    assert (take.start, take.end) == pytest.approx((moments[1], moments[-2]), abs=0.05)
    assert (take.stroke_start, take.stroke_end) == pytest.approx((moments[3], moments[4]), abs=0.2)
    assert take.poses == recording.poses.between(take.stroke_start, take.stroke_end)
    assert take.untrimmed == recording.poses.between(take.start, take.end)
    assert len(take.poses) < len(take.untrimmed)


def test_trimming_can_be_left_out() -> None:
    (take,) = takes_in(recorded()[0], trim=False)
    assert (take.stroke_start, take.stroke_end) == (take.start, take.end)
    assert take.poses == take.untrimmed


def test_an_empty_recording_has_no_takes() -> None:
    recording, _ = recorded()
    empty = Recording(poses=recording.poses.between(-2, -1), hands=(), salute=np.empty(0))
    assert takes_in(empty) == ()
