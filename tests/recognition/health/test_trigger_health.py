"""The health of a trigger: missed by other people, set off by ordinary movement."""

from dataclasses import replace

import numpy as np

from app.recognition import Gesture, Language
from app.recognition.health.check import check_health
from app.recognition.health.report import check_trigger, list_trigger_findings
from app.recognition.triggers.trigger import NO_TRIGGER, SALUTE, ArmPose, Trigger
from tests.posed import BY_BELLY, head_pose, posed_language, posed_recording

BY_HEAD = Trigger("pose", head_pose())
ASIDE = ArmPose(((0.85, 0.0), (1.3, 0.0), (-0.85, 0.0), (-1.3, 0.0)))


def kinds(trigger: Trigger, *gestures: Gesture) -> list[str]:
    return [each.kind for each in list_trigger_findings(trigger, check_trigger(trigger), gestures)]


def test_a_hand_on_the_head_is_seldom_missed_and_seldom_set_off() -> None:
    health = check_trigger(BY_HEAD)
    assert health is not None
    assert health.missed.rate < 0.05
    assert health.false_per_hour < 30
    assert kinds(BY_HEAD) == []


def test_a_hand_before_the_belly_is_set_off_by_what_hands_do_there() -> None:
    health = check_trigger(BY_BELLY)
    assert health is not None
    assert "checking a gauge" in health.set_off_by
    assert health.false_per_hour > 60
    assert kinds(BY_BELLY) == ["trigger_accidental"]


def test_outstretched_arms_depend_on_how_long_they_are() -> None:
    assert "trigger_missed" in kinds(Trigger("pose", ASIDE))
    health = check_trigger(Trigger("pose", head_pose(), ASIDE))
    assert health is not None
    assert health.missed.rate > 0.1


def test_a_gesture_that_holds_the_pose_would_end_its_take() -> None:
    poses = posed_recording("circle-by-belly").poses
    whole = Gesture.from_demonstration("whole", poses.between(1.0, 3.5))
    assert kinds(BY_BELLY, whole)[-1] == "trigger_like"
    brief = Gesture.from_demonstration("brief", poses.between(1.9, 3.5))
    assert kinds(BY_BELLY, brief)[-1] == "trigger_passed"
    apart = Gesture.from_demonstration("apart", poses.between(2.6, 4.4))
    assert kinds(BY_HEAD, apart) == []


def test_a_trigger_of_gestures_has_no_rates_of_its_own() -> None:
    trigger = Trigger("gesture", start_label="circle", stop_label="wedge")
    assert check_trigger(trigger) is None
    assert check_health(replace(posed_language(), trigger=trigger)).trigger is None


def test_a_salute_has_no_rates() -> None:
    assert check_trigger(SALUTE) is None
    assert kinds(SALUTE) == []
    assert kinds(NO_TRIGGER) == ["untriggered"]


def test_the_report_of_a_language_tells_of_its_trigger() -> None:
    language = posed_language(BY_HEAD)
    report = check_health(language)
    assert report.trigger == check_trigger(BY_HEAD)
    assert report.to_dict()["trigger"]["words"] == BY_HEAD.words
    assert check_health(replace(language, trigger=SALUTE)).to_dict()["trigger"] is None


def test_a_salute_within_a_gesture_matters_where_salutes_end_takes() -> None:
    poses = posed_recording("circle-by-belly").poses
    xy = np.array(poses.xy)
    for part, place in (("elbow", (-60, 60)), ("wrist", (-60, 0)), ("index", (-60, -30))):
        middle = (poses.column("left_shoulder") + poses.column("right_shoulder")) / 2
        xy[:, poses.landmarks.index(f"left_{part}")] = middle + place
    raised = replace(poses, xy=xy).between(2.6, 4.4)
    language = Language("pool", [Gesture.from_demonstration("raised", raised)])
    found = {
        trigger.kind: [each.kind for each in check_health(each_language).findings]
        for trigger in (SALUTE, BY_HEAD)
        for each_language in [replace(language, trigger=trigger)]
    }
    assert "salute_like" in found["salute"]
    assert "salute_like" not in found["pose"]
