"""Triggers: what begins and ends a take."""

import numpy as np
import pytest

from app.recognition.errors import TriggerError
from app.recognition.triggers.trigger import NO_TRIGGER, SALUTE, Trigger
from tests.posed import BY_BELLY, BY_BELLY_AND_HEAD, belly_pose, head_pose, posed_recording


def test_a_salute_is_the_default_and_scores_as_the_hands_do() -> None:
    recording = posed_recording("circle-by-belly")
    start, stop = SALUTE.score(recording.poses, recording.salute)
    assert start is stop is recording.salute
    assert Trigger() == SALUTE


def test_of_two_poses_the_one_that_is_held_more_counts() -> None:
    recording = posed_recording("wedge-by-belly-and-head")
    start, stop = BY_BELLY_AND_HEAD.score(recording.poses, recording.salute)
    assert not (np.minimum(start, stop) > 0).any()
    assert start.max() > 0.9
    assert stop.max() > 0.9


def test_without_a_trigger_nothing_scores() -> None:
    recording = posed_recording("circle-by-belly")
    start, stop = NO_TRIGGER.score(recording.poses, recording.salute)
    assert not start.any()
    assert not stop.any()


def test_poses_belong_to_the_kind_pose_alone() -> None:
    with pytest.raises(TriggerError, match="'pose' needs a start pose"):
        Trigger("pose")
    with pytest.raises(TriggerError, match="'none' has no poses"):
        Trigger("none", belly_pose())
    with pytest.raises(TriggerError, match="'salute' has no poses"):
        Trigger(stop=head_pose())


def test_gestures_belong_to_the_kind_gesture_alone() -> None:
    trigger = Trigger("gesture", start_label="circle")
    assert trigger.stop_label == "circle"
    assert trigger.renamed("circle", "ring") == Trigger("gesture", start_label="ring")
    assert trigger.words == "between the gestures 'circle' and 'circle'"
    with pytest.raises(TriggerError, match="'gesture' needs a gesture"):
        Trigger("gesture")
    with pytest.raises(TriggerError, match="'none' has no gestures"):
        Trigger("none", start_label="circle")
    with pytest.raises(TriggerError, match="'salute' has no gestures"):
        Trigger(stop_label="circle")


def test_start_and_stop_that_are_alike_are_refused() -> None:
    with pytest.raises(TriggerError, match=r"too much alike \(score 1\.00"):
        Trigger("pose", belly_pose(), belly_pose())


def test_a_trigger_is_named_in_words() -> None:
    assert SALUTE.words == "between two salutes"
    assert BY_BELLY.words == "between two poses of the arms (left hand before the body)"
    assert BY_BELLY_AND_HEAD.words.endswith("(left hand before the body; left hand at the head)")
    assert "anywhere" in NO_TRIGGER.words
