"""Takes between poses of the arms, where no hand is seen."""

from itertools import pairwise

import numpy as np
import pytest

from app.recognition import Recognizer, Take, takes_in
from app.recognition.recording.live_segmentation import LiveTakes
from app.recognition.recording.segmentation import TakeMachine, TakeState
from app.recognition.triggers.trigger import NO_TRIGGER, Trigger
from tests.posed import BY_BELLY, BY_BELLY_AND_HEAD, posed_language, posed_recording

NAMES = ("circle-by-belly", "circle-by-belly-2", "wedge-by-belly")


@pytest.mark.parametrize("name", NAMES)
def test_a_take_lies_between_two_poses_and_is_recognised(name: str) -> None:
    recording = posed_recording(name)
    assert takes_in(recording) == ()
    (take,) = takes_in(recording, trigger=BY_BELLY)
    assert take.closed
    assert take.start < take.stroke_start < take.stroke_end < take.end
    assert Recognizer(posed_language()).recognize(take.poses).label == name.split("-")[0]


def test_another_pose_may_end_it() -> None:
    (take,) = takes_in(posed_recording("wedge-by-belly-and-head"), trigger=BY_BELLY_AND_HEAD)
    assert take.closed
    (unended,) = takes_in(posed_recording("wedge-by-belly"), trigger=BY_BELLY_AND_HEAD)
    assert not unended.closed


def test_without_a_trigger_there_are_no_takes() -> None:
    assert takes_in(posed_recording("circle-by-belly"), trigger=NO_TRIGGER) == ()


@pytest.mark.parametrize("trigger", [BY_BELLY, BY_BELLY_AND_HEAD])
@pytest.mark.parametrize("name", [*NAMES, "wedge-by-belly-and-head"])
def test_a_camera_gives_the_takes_of_the_recording(name: str, trigger: Trigger) -> None:
    recording = posed_recording(name)
    poses = recording.poses
    live = LiveTakes(poses.frame_size, trigger)
    found: list[Take | None] = [
        live.feed_moment(poses.between(time, time), salute).take
        for time, salute in zip(poses.time.tolist(), recording.salute.tolist(), strict=True)
    ]
    found.append(live.finish())
    streamed = [take for take in found if take]
    recalled = takes_in(recording, trigger=trigger)
    assert [(take.start, take.end, take.closed) for take in streamed] == [
        (take.start, take.end, take.closed) for take in recalled
    ]
    for one, other in zip(streamed, recalled, strict=True):
        assert np.array_equal(one.poses.xy, other.poses.xy, equal_nan=True)


START, STOP, NONE = (0.9, 0.0), (0.0, 0.9), (0.0, 0.0)


def run(*stretches: tuple[tuple[float, float], float]) -> tuple[list[tuple[float, bool]], str]:
    """Return end and closedness of the takes of a stream of two scores, and the last state."""
    machine = TakeMachine.of(BY_BELLY_AND_HEAD)
    scores = [score for score, seconds in stretches for _ in range(round(25 * seconds))]
    found = [machine.update(k / 25, *score) for k, score in enumerate(scores)]
    return [(round(each.end, 1), each.closed) for each in found if each], machine.state.value


def test_only_the_start_pose_begins_and_only_the_stop_pose_ends() -> None:
    takes, state = run((STOP, 1), (NONE, 1), (START, 1), (NONE, 2), (STOP, 1), (NONE, 1))
    assert (takes, state) == ([(5.0, True)], TakeState.idle.value)


def test_a_start_pose_shown_again_leaves_the_take_before_unclosed() -> None:
    takes, _ = run((START, 1), (NONE, 2), (START, 1), (NONE, 2), (STOP, 1), (NONE, 1))
    assert takes == [(3.0, False), (6.0, True)]


def test_a_start_pose_that_is_lost_for_a_moment_continues() -> None:
    takes, _ = run((START, 1), (NONE, 0.7), (START, 1), (NONE, 2), (STOP, 1), (NONE, 1))
    assert takes == [(4.7, True)]


def test_a_stop_pose_at_once_calls_the_take_off() -> None:
    takes, state = run((START, 1), (NONE, 0.1), (STOP, 1), (NONE, 1))
    assert (takes, state) == ([], TakeState.idle.value)


def test_a_forgotten_stop_pose_ends_in_a_minute() -> None:
    takes, state = run((START, 1), (NONE, 62))
    assert (takes, state) == ([(61.0, False)], TakeState.idle.value)


def test_every_take_is_ended_by_its_own_pose() -> None:
    shown = ((START, 1.0), (NONE, 2.0), (STOP, 1.0), (NONE, 0.6))
    takes, _ = run(*shown, *shown, *shown)
    assert [closed for _, closed in takes] == [True] * 3
    assert all(after[0] - before[0] == pytest.approx(4.6) for before, after in pairwise(takes))
