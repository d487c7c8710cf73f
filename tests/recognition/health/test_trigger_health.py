"""The health of a trigger: missed by other people, set off by ordinary movement."""

from dataclasses import replace

import numpy as np

from app.recognition import Gesture, Language
from app.recognition.health.check import check_health
from app.recognition.health.false_alarms import FalseAlarm
from app.recognition.health.trigger_health import (
    check_trigger,
    check_trigger_gestures,
    list_trigger_findings,
)
from app.recognition.simulation.rate_estimate import RateEstimate
from app.recognition.triggers.arm_pose import ArmPose
from app.recognition.triggers.trigger import NO_TRIGGER, SALUTE, Trigger
from tests.posed import BY_BELLY, head_pose, posed_language, posed_recording

BY_HEAD = Trigger("pose", head_pose())
ASIDE = ArmPose(((0.85, 0.0), (1.3, 0.0), (-0.85, 0.0), (-1.3, 0.0)))


def codes(trigger: Trigger, *gestures: Gesture) -> list[str]:
    return [each.code for each in list_trigger_findings(trigger, check_trigger(trigger), gestures)]


def test_a_hand_on_the_head_is_seldom_missed_and_seldom_set_off() -> None:
    health = check_trigger(BY_HEAD)
    assert health is not None
    assert health.missed.rate < 0.05
    assert health.false_per_hour < 30
    assert codes(BY_HEAD) == []


def test_a_hand_before_the_belly_is_set_off_by_what_hands_do_there() -> None:
    health = check_trigger(BY_BELLY)
    assert health is not None
    assert "checking a gauge" in health.set_off_by
    assert health.to_dict()["false_per_hour"] > 60
    assert codes(BY_BELLY) == ["trigger_accidental"]


def test_outstretched_arms_depend_on_how_long_they_are() -> None:
    assert "trigger_missed" in codes(Trigger("pose", ASIDE))
    health = check_trigger(Trigger("pose", head_pose(), ASIDE))
    assert health is not None
    assert health.missed.rate > 0.1


def test_a_gesture_that_holds_the_pose_would_end_its_take() -> None:
    poses = posed_recording("circle-by-belly").poses
    whole = Gesture.from_demonstration("whole", poses.between(1.0, 3.5))
    assert codes(BY_BELLY, whole)[-1] == "trigger_like"
    brief = Gesture.from_demonstration("brief", poses.between(1.9, 3.5))
    assert codes(BY_BELLY, brief)[-1] == "trigger_passed"
    apart = Gesture.from_demonstration("apart", poses.between(2.6, 4.4))
    assert codes(BY_HEAD, apart) == []


def test_a_trigger_of_gestures_has_the_rates_of_these() -> None:
    trigger = Trigger("gesture", start_label="circle", stop_label="wedge")
    report = check_health(replace(posed_language(), trigger=trigger), takes=10)
    rates = {each.label: each.missed for each in report.gestures}
    assert report.trigger is not None
    assert report.trigger.words == trigger.words
    assert report.trigger.missed in rates.values()
    assert report.trigger.missed.rate == max(each.rate for each in rates.values() if each)
    circle = next(each for each in report.gestures if each.label == "circle")
    assert set(report.trigger.set_off_by) == set(circle.set_off_by)
    assert (report.trigger.false_per_hour > 0) is bool(circle.set_off_by)


def test_a_gesture_that_is_missed_or_made_by_chance_is_a_bad_trigger() -> None:
    language = replace(posed_language(), trigger=Trigger("gesture", start_label="circle"))
    missed = [RateEstimate.of_count(3, 10), None]
    alarms = [FalseAlarm("checking a gauge", 0, True, 10.0), FalseAlarm("waving", 1, True, 10.0)]
    health = check_trigger_gestures(language, missed, alarms)
    assert health is not None
    assert health.false_per_hour == 180
    assert health.set_off_by == ("checking a gauge",)
    found = list(list_trigger_findings(language.trigger, health, language.gestures))
    assert [each.code for each in found] == ["trigger_missed", "trigger_accidental"]
    assert found[0].message.startswith("the trigger's gesture is not recognised in 30% of takes")
    assert check_trigger_gestures(language, [None, None], alarms) is None
    assert check_trigger_gestures(posed_language(), missed, alarms) is None


def test_a_salute_has_no_rates() -> None:
    assert check_trigger(SALUTE) is None
    assert codes(SALUTE) == []
    assert codes(NO_TRIGGER) == ["untriggered"]


def test_the_report_of_a_language_tells_of_its_trigger() -> None:
    language = posed_language(BY_HEAD)
    report = check_health(language, takes=2)
    assert report.trigger == check_trigger(BY_HEAD)
    assert report.to_dict()["trigger"]["words"] == BY_HEAD.words
    assert check_health(replace(language, trigger=SALUTE), takes=2).to_dict()["trigger"] is None


def test_a_salute_within_a_gesture_matters_where_salutes_end_takes() -> None:
    poses = posed_recording("circle-by-belly").poses
    xy = np.array(poses.xy)
    for part, place in (("elbow", (-60, 60)), ("wrist", (-60, 0)), ("index", (-60, -30))):
        middle = (poses.column("left_shoulder") + poses.column("right_shoulder")) / 2
        xy[:, poses.landmarks.index(f"left_{part}")] = middle + place
    raised = replace(poses, xy=xy).between(2.6, 4.4)
    language = Language("pool", [Gesture.from_demonstration("raised", raised)])
    found = {
        trigger.kind: [each.code for each in check_health(each_language, takes=2).findings]
        for trigger in (SALUTE, BY_HEAD)
        for each_language in [replace(language, trigger=trigger)]
    }
    assert "salute_like" in found["salute"]
    assert "salute_like" not in found["pose"]
