"""Transit: the reaches between salute and stroke are found, and nothing is cut in doubt."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.recognition.poses.sequence import FloatArray, PoseSequence
from app.recognition.preprocessing.repair import repair_poses
from app.recognition.recording.trimming import LARGEST_SHARE, Span, find_stroke
from tests.recognition.motions import (
    RESTING_PLACE,
    SALUTE_PLACE,
    Movement,
    Performance,
    circle,
    perform,
    still,
)

TOP = np.array([-0.9, -0.3])
HOLD = 0.5


def moved(place: FloatArray, right: float, down: float) -> FloatArray:
    return np.asarray(place + np.array([right, down]), dtype=np.float64)


STROKES = {
    "circle": (Movement(circle(TOP), 1.6),),
    "line": (Movement(moved(TOP, 0.9, 0.0), 0.8),),
    "wedge": (Movement(moved(TOP, 0.4, 0.8), 0.7), Movement(moved(TOP, 0.8, 0.0), 0.7)),
    "triangle": (
        Movement(moved(TOP, 0.4, 0.8), 0.7),
        Movement(moved(TOP, -0.4, 0.8), 0.7),
        Movement(TOP, 0.7),
    ),
}


def gesture(
    strokes: tuple[Movement, ...],
    *,
    pause: float = 0.15,
    reach: float = 0.5,
    noise: float = 0.0,
    rate: float = 25.0,
) -> Performance:
    """Salute, reach, pause, strokes, pause, return, salute."""
    start, end = TOP, np.atleast_2d(strokes[-1].path)[-1]
    return perform(
        [
            still(SALUTE_PLACE, HOLD),
            Movement(start, reach),
            still(start, pause),
            *strokes,
            still(end, pause),
            Movement(SALUTE_PLACE, reach),
            still(SALUTE_PLACE, HOLD),
        ],
        noise=noise,
        rate=rate,
    )


def salutes(performance: Performance) -> tuple[Span, Span]:
    """Say when the salutes of `gesture` are seen: exactly while the hand is still."""
    moments = performance.moments
    return Span(0.0, moments[1]), Span(moments[-2], moments[-1])


def stroke_of(performance: Performance) -> Span:
    return find_stroke(performance.poses, *salutes(performance))


def true_stroke(performance: Performance) -> Span:
    """From the end of the first pause to the beginning of the second."""
    return Span(performance.moments[3], performance.moments[-4])


@pytest.mark.parametrize("name", STROKES)
@pytest.mark.parametrize("noise", [0.0, 0.01])
@pytest.mark.parametrize("pause", [0.0, 0.15, 0.6])
def test_both_reaches_are_left_out(name: str, noise: float, pause: float) -> None:
    performance = gesture(STROKES[name], noise=noise, pause=pause)
    found, true = stroke_of(performance), true_stroke(performance)
    assert found.start == pytest.approx(true.start, abs=0.2)
    assert found.end == pytest.approx(true.end, abs=0.2)
    wrist = performance.poses.between(found.start, found.end).column("right_wrist")
    whole = performance.poses.between(true.start, true.end).column("right_wrist")
    assert np.allclose(np.ptp(wrist, axis=0), np.ptp(whole, axis=0), atol=12)


@pytest.mark.parametrize("rate", [10.0, 15.0, 30.0, 60.0])
def test_the_frame_rate_does_not_matter(rate: float) -> None:
    performance = gesture(STROKES["circle"], rate=rate)
    found, true = stroke_of(performance), true_stroke(performance)
    assert (found.start, found.end) == pytest.approx((true.start, true.end), abs=0.2)


def test_a_salute_kept_up_while_leaving_and_taken_before_arriving_changes_nothing() -> None:
    performance = gesture(STROKES["wedge"])
    moments = performance.moments
    early = find_stroke(
        performance.poses, Span(0.0, moments[1] + 0.25), Span(moments[-2] - 0.25, moments[-1])
    )
    assert (early.start, early.end) == pytest.approx(
        (true_stroke(performance).start, true_stroke(performance).end), abs=0.2
    )


def test_a_salute_kept_up_to_the_stroke_costs_nothing_of_it() -> None:
    performance = gesture(STROKES["wedge"])
    true = true_stroke(performance)
    found = find_stroke(
        performance.poses,
        Span(0.0, true.start),
        Span(true.end, performance.moments[-1]),
    )
    assert (found.start, found.end) == pytest.approx((true.start, true.end), abs=0.1)


STIRRED = moved(SALUTE_PLACE, 0.05, 0.05)
RAISED = [Movement(moved(SALUTE_PLACE, 0.3, 1.2), 0.01), Movement(SALUTE_PLACE, 0.5)]


@pytest.mark.parametrize(
    ("salute", "seen"),
    [
        ([*RAISED, still(SALUTE_PLACE, HOLD)], 0.3),
        ([still(SALUTE_PLACE, 0.3), Movement(STIRRED, 0.15), still(STIRRED, 0.2)], 0.0),
    ],
    ids=["raised", "stirred"],
)
def test_a_hand_that_moves_before_or_while_it_salutes_sets_out_later(
    salute: list[Movement], seen: float
) -> None:
    way = [Movement(TOP, 0.5), Movement(circle(TOP), 1.6), Movement(SALUTE_PLACE, 0.5)]
    performance = perform([*salute, *way, still(SALUTE_PLACE, HOLD)])
    moments = performance.moments
    found = find_stroke(performance.poses, Span(seen, moments[3]), Span(moments[-2], moments[-1]))
    assert (found.start, found.end) == pytest.approx((moments[4], moments[5]), abs=0.2)


HOOK = np.vstack([moved(SALUTE_PLACE, 0.5, 0.0), moved(SALUTE_PLACE, 0.5, 0.5), SALUTE_PLACE])
CORNERS = moved(SALUTE_PLACE, 0.5, 0.8), moved(SALUTE_PLACE, -0.3, 0.8), SALUTE_PLACE
FAR = moved(SALUTE_PLACE, 1.5, 0.8)
FINGERS_CHANGE = still(SALUTE_PLACE, 0.3)
WITHOUT_REACHES = {
    "a line there and back": [
        Movement(moved(SALUTE_PLACE, 0.9, 0.3), 0.7),
        Movement(SALUTE_PLACE, 0.7),
    ],
    "one flowing movement": [Movement(circle(SALUTE_PLACE), 2.0)],
    # A hook, a pause and a wave: nothing here is a straight way to somewhere.
    "bent": [
        Movement(HOOK, 1.0),
        still(SALUTE_PLACE, 0.2),
        Movement(circle(SALUTE_PLACE, 0.3), 1.0),
    ],
    # The fingers change while the hand rests, which no reach lets them do.
    "straight sides from salute to salute": [
        FINGERS_CHANGE,
        *(Movement(place, 0.7) for place in CORNERS),
        FINGERS_CHANGE,
    ],
    "long and slow": [Movement(FAR, 3.0), Movement(circle(FAR), 1.6), Movement(SALUTE_PLACE, 3.0)],
}


@pytest.mark.parametrize("strokes", WITHOUT_REACHES.values(), ids=WITHOUT_REACHES)
def test_what_has_no_reaches_is_kept_whole(strokes: list[Movement]) -> None:
    salute = still(SALUTE_PLACE, HOLD)
    performance = perform([salute, *strokes, salute])
    first, last = salutes(performance)
    assert stroke_of(performance) == Span(first.end, last.start)


def test_hands_that_do_not_move_are_kept_whole() -> None:
    performance = perform([still(SALUTE_PLACE, HOLD)] * 3, noise=0.01)
    first, last = salutes(performance)
    assert stroke_of(performance) == Span(first.end, last.start)


def test_a_hand_that_drifts_while_it_salutes_has_not_set_out() -> None:
    drifted = moved(SALUTE_PLACE, 0.03, 0.03)
    performance = perform(
        [
            still(SALUTE_PLACE, 0.3),
            Movement(drifted, 0.1),
            still(drifted, 0.3),
            Movement(TOP, 0.5),
            still(TOP, 0.15),
            Movement(circle(TOP), 2.4),
            still(TOP, 0.15),
            Movement(drifted, 0.5),
            still(drifted, 0.3),
            Movement(SALUTE_PLACE, 0.1),
            still(SALUTE_PLACE, 0.3),
        ]
    )
    moments = performance.moments
    found = find_stroke(performance.poses, Span(0.0, moments[3]), Span(moments[-4], moments[-1]))
    assert (found.start, found.end) == pytest.approx((moments[5], moments[6]), abs=0.25)


def test_two_hands_that_set_out_together_are_followed_together() -> None:
    left_start = np.array([0.9, -0.3])
    pause = 0.15
    right = [
        still(SALUTE_PLACE, HOLD),
        Movement(TOP, 0.5),
        still(TOP, pause),
        Movement(moved(TOP, 0.0, 0.9), 0.8),
        still(moved(TOP, 0.0, 0.9), pause),
        Movement(SALUTE_PLACE, 0.5),
        still(SALUTE_PLACE, HOLD),
    ]
    left = [
        still(RESTING_PLACE, HOLD),
        Movement(left_start, 0.5),
        still(left_start, pause),
        Movement(moved(left_start, 0.0, 0.9), 0.8),
        still(moved(left_start, 0.0, 0.9), pause),
        Movement(RESTING_PLACE, 0.5),
    ]
    performance = perform(right, left)
    found, true = stroke_of(performance), true_stroke(performance)
    assert (found.start, found.end) == pytest.approx((true.start, true.end), abs=0.2)


def test_a_short_reach_need_not_be_straight() -> None:
    beside = moved(SALUTE_PLACE, 0.2, -0.1)
    bent = np.array([moved(SALUTE_PLACE, 0.0, -0.2), beside])
    performance = perform(
        [
            still(SALUTE_PLACE, HOLD),
            Movement(bent, 0.6),
            still(beside, 0.1),
            Movement(circle(beside), 1.6),
            still(beside, 0.1),
            Movement(bent[::-1], 0.6),
            Movement(SALUTE_PLACE, 0.2),
            still(SALUTE_PLACE, HOLD),
        ]
    )
    found = stroke_of(performance)
    assert found.start == pytest.approx(performance.moments[3], abs=0.2)


def test_a_hand_lost_on_its_way_keeps_that_way() -> None:
    performance = gesture(STROKES["circle"])
    moments = performance.moments
    xy = performance.poses.xy.copy()
    lost = (performance.poses.time > moments[1] - 0.1) & (performance.poses.time < moments[2])
    xy[lost] = np.nan
    found = find_stroke(replace(performance.poses, xy=xy), *salutes(performance))
    assert found.start == moments[1]
    assert found.end == pytest.approx(true_stroke(performance).end, abs=0.2)


@pytest.mark.parametrize("frame", [16, 17, 20])
def test_a_frame_with_left_and_right_exchanged_does_not_split_a_reach(frame: int) -> None:
    performance = gesture(STROKES["circle"])
    xy = performance.poses.xy.copy()
    xy[frame] = xy[frame][[1, 0, 3, 2, 5, 4]]
    repaired = repair_poses(replace(performance.poses, xy=xy)).poses
    found = find_stroke(repaired, *salutes(performance))
    expected = stroke_of(performance)
    assert (found.start, found.end) == pytest.approx((expected.start, expected.end), abs=0.1)


def test_an_unclosed_take_loses_only_its_first_reach() -> None:
    performance = gesture(STROKES["circle"])
    first, _ = salutes(performance)
    true = true_stroke(performance)
    open_ended = performance.poses.between(0, true.end)
    found = find_stroke(open_ended, first, None)
    assert found.start == pytest.approx(true.start, abs=0.2)
    assert found.end == open_ended.time[-1]


def test_poses_without_wrists_are_kept_whole() -> None:
    performance = gesture(STROKES["circle"])
    first, last = salutes(performance)
    nose_only = PoseSequence(
        landmarks=("nose",),
        xy=performance.poses.column("right_wrist")[:, None],
        time=performance.poses.time,
        frame_size=(640, 640),
    )
    assert find_stroke(nose_only, first, last) == Span(first.end, last.start)


@given(
    scale=st.floats(0.2, 5),
    shift=st.tuples(st.floats(-300, 300), st.floats(-300, 300)),
    later=st.integers(-50, 50),
    name=st.sampled_from(sorted(STROKES)),
)
@settings(max_examples=30, deadline=None)
def test_distance_place_and_clock_do_not_matter(
    scale: float, shift: tuple[float, float], later: int, name: str
) -> None:
    performance = gesture(STROKES[name], noise=0.005)
    first, last = salutes(performance)
    elsewhere = replace(
        performance.poses,
        xy=performance.poses.xy * scale + np.array(shift),
        time=performance.poses.time + later,
    )
    found = find_stroke(
        elsewhere,
        Span(first.start + later, first.end + later),
        Span(last.start + later, last.end + later),
    )
    before = find_stroke(performance.poses, first, last)
    assert (found.start, found.end) == pytest.approx(
        (before.start + later, before.end + later), abs=0.02
    )


@given(seed=st.integers(0, 10**6), count=st.integers(0, 6))
@settings(max_examples=40, deadline=None)
def test_a_stroke_always_remains_inside_the_take(seed: int, count: int) -> None:
    random = np.random.default_rng(seed)
    movements = [
        Movement(random.uniform(-1, 1, 2), float(random.uniform(0.2, 1.5))) for _ in range(count)
    ]
    performance = perform(
        [
            still(SALUTE_PLACE, HOLD),
            *movements,
            Movement(SALUTE_PLACE, 0.5),
            still(SALUTE_PLACE, HOLD),
        ]
    )
    first, last = salutes(performance)
    found = stroke_of(performance)
    assert first.end <= found.start < found.end <= last.start
    whole = performance.moments[-2] - performance.moments[1]
    assert found.end - found.start >= (1 - 2 * LARGEST_SHARE) * whole - 0.2
