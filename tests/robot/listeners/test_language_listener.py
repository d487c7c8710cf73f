"""A robot listens between the triggers of its language, or without them."""

from dataclasses import replace

import pytest

from app.recognition.errors import EstimatorError
from app.recognition.triggers.trigger import NO_TRIGGER, SALUTE, Trigger
from app.robot import ActiveLanguage, Event, TakeRecognized, TakeRejected, create_listener
from tests.posed import BY_BELLY, BY_BELLY_AND_HEAD, posed_language, posed_recording
from tests.robot.languages import moments_of, run_listener


def active(trigger: Trigger) -> ActiveLanguage:
    return ActiveLanguage.from_json(replace(posed_language(), trigger=trigger).to_json())


def verdicts(events: list[Event]) -> list[str]:
    told = [event for event in events if isinstance(event, TakeRecognized | TakeRejected)]
    return [each.label if isinstance(each, TakeRecognized) else each.reason for each in told]


@pytest.mark.parametrize("name", ["circle-by-belly", "circle-by-belly-2", "wedge-by-belly"])
def test_a_gesture_between_arm_poses_is_heard_where_no_hand_is_seen(name: str) -> None:
    listener = create_listener(active(BY_BELLY))
    assert verdicts(run_listener(listener, posed_recording(name))) == [name.split("-")[0]]


def test_another_pose_may_end_it() -> None:
    listener = create_listener(active(BY_BELLY_AND_HEAD))
    assert verdicts(run_listener(listener, posed_recording("wedge-by-belly-and-head"))) == ["wedge"]


def test_a_take_without_its_stop_pose_is_rejected_with_the_reason() -> None:
    listener = create_listener(active(BY_BELLY_AND_HEAD))
    (reason,) = verdicts(run_listener(listener, posed_recording("wedge-by-belly")))
    assert reason.startswith("no pose of the arms ended it")
    assert reason.endswith("or what begins a take came again")


def test_a_language_without_trigger_is_heard_anywhere() -> None:
    listener = create_listener(active(NO_TRIGGER))
    events = [*run_listener(listener, posed_recording("circle-by-belly")), *listener.finish()]
    assert "circle" in verdicts(events)


def test_a_stream_without_hands_refuses_salutes_at_once_and_later() -> None:
    with pytest.raises(EstimatorError, match="without hands no salute is seen"):
        create_listener(active(SALUTE), hands=False)
    listener = create_listener(active(BY_BELLY), hands=False)
    with pytest.raises(EstimatorError, match="waits for salutes"):
        listener.set_language(active(SALUTE))
    assert listener.language.trigger == BY_BELLY
    spotting = create_listener(active(SALUTE), without_salutes=True, hands=False)
    assert spotting.language.trigger == SALUTE


def test_between_trigger_gestures_alone_gestures_are_heard() -> None:
    frames = moments_of(posed_recording("circle-by-belly"))
    unopened = active(Trigger("gesture", start_label="wedge", stop_label="circle"))
    for spots, heard in ((False, False), (True, True)):
        listener = create_listener(unopened, without_salutes=spots)
        events = [event for frame in frames for event in listener.feed(*frame)]
        assert ("circle" in verdicts([*events, *listener.finish()])) == heard


def test_a_language_with_another_trigger_is_heard_from_the_next_frame_on() -> None:
    frames = moments_of(posed_recording("circle-by-belly"))
    listener = create_listener(active(SALUTE))
    for trigger in (NO_TRIGGER, SALUTE, BY_BELLY):
        listener.set_language(active(trigger))
        assert listener.language.trigger == trigger
    events = [event for frame in frames for event in listener.feed(*frame)]
    assert verdicts(events) == ["circle"]


def test_a_change_of_the_trigger_ends_an_open_take() -> None:
    frames = moments_of(posed_recording("circle-by-belly"))
    for following in (BY_BELLY_AND_HEAD, NO_TRIGGER):
        listener = create_listener(active(BY_BELLY))
        events = [event for frame in frames[:100] for event in listener.feed(*frame)]
        listener.set_language(active(following))
        events += listener.feed(*frames[100])
        assert verdicts(events) == ["the language's trigger changed"]
