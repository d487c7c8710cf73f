"""Counterfactual kinds: each changes a context as its words say."""

import json
from dataclasses import replace

import pytest

from app.recognition import GestureError, Language, PoseSequence, Recognizer, Take
from app.recognition.explanation.context import RecognitionContext
from app.recognition.explanation.counterfactual_kinds import (
    FurtherDemonstration,
    Intervention,
    KeypointRepair,
    NewDemonstration,
    OtherProfile,
    SalientKeypoints,
    Simplification,
    SwitchPosition,
    Trim,
    VoterWeight,
)
from app.recognition.gestures.profile import PROFILES
from app.recognition.gestures.tuning import Tuning
from tests.recognition.demonstrations import drawn_language
from tests.recognition.strategies import circle, recording, wedge


@pytest.fixture(scope="module")
def context() -> RecognitionContext:
    recognizer = Recognizer(drawn_language(), "full", tuning=Tuning(weights={"velocity": 3.0}))
    whole = recording(wedge)
    return RecognitionContext(recognizer=recognizer, poses=whole.between(0.5, 1.5), whole=whole)


def test_a_trim_cuts_the_whole_otherwise_and_keeps_the_recogniser(
    context: RecognitionContext,
) -> None:
    changed = Trim(size=0.5, start=0.2, end=1.0).apply(context)
    assert (changed.poses.time[0], changed.poses.time[-1]) == pytest.approx((0.2, 1.0))
    assert changed.recognizer is context.recognizer


def test_a_weight_multiplies_the_one_there_is(context: RecognitionContext) -> None:
    for voter, expected in (
        ("velocity", {"velocity": 1.5}),
        ("path", {"velocity": 3.0, "path": 0.5}),
    ):
        changed = VoterWeight(size=0.1, voter=voter, factor=0.5).apply(context)
        assert changed.tuning.weights == expected


def test_tuning_changes_one_thing_and_keeps_the_rest(context: RecognitionContext) -> None:
    coarser = Simplification(size=0.5, tolerance=8.0).apply(context)
    assert (coarser.tuning.simplification, coarser.tuning.weights) == (8.0, {"velocity": 3.0})
    unrepaired = KeypointRepair(size=0.1, on=False).apply(context)
    assert (unrepaired.recognizer.repairs, unrepaired.tuning.weights) == (False, {"velocity": 3.0})


def test_another_profile_drops_weights_of_voters_it_may_not_have(
    context: RecognitionContext,
) -> None:
    changed = OtherProfile(size=1.0, profile="paper").apply(context)
    assert (changed.profile, dict(changed.tuning.weights)) == ("paper", {})


def test_other_salient_keypoints_are_drawn_anew(context: RecognitionContext) -> None:
    both = ("left_wrist", "right_wrist")
    change = SalientKeypoints(size=0.5, label="circle", salient=both)
    changed = change.apply(context).language.gesture("circle")
    assert changed.salient == both
    assert (changed.image != drawn_language().gesture("circle").image).any()
    with pytest.raises(GestureError, match="not in this recording"):
        replace(change, salient=("left_knee",)).apply(context)


def test_a_switch_is_the_only_thing_that_changes_about_a_gesture(
    context: RecognitionContext,
) -> None:
    change = SwitchPosition(size=1 / 3, label="wedge", switch="mirror", position="on")
    switches = change.apply(context).language.gesture("wedge").switches
    assert (switches.mirror, switches.direction, switches.tempo) == ("on", "auto", "auto")


def test_a_new_demonstration_keeps_what_the_author_wrote() -> None:
    told = replace(drawn_language().gesture("circle"), description="round", command="orbit")
    gestures = [told if each.label == "circle" else each for each in drawn_language().gestures]
    query = recording(wedge)
    before = RecognitionContext(
        recognizer=Recognizer(Language("pool", gestures), "paper"), poses=query, whole=query
    )
    assert before.result.label == "wedge"
    after = NewDemonstration(size=1.0, label="circle").apply(before)
    made = after.language.gesture("circle")
    assert (made.description, made.command) == ("round", "orbit")
    assert (made.image == drawn_language().gesture("wedge").image).all()
    assert after.result.label == "circle"  # of two that are now the same, the first


def test_a_new_demonstration_keeps_the_further_ones(context: RecognitionContext) -> None:
    several = FurtherDemonstration(size=0.5, label="circle").apply(context)
    after = NewDemonstration(size=1.0, label="circle").apply(several).language.gesture("circle")
    assert after.further == several.language.gesture("circle").further
    assert (after.image == after.further[0].image).all()


@pytest.mark.parametrize("profile", PROFILES)
def test_a_further_demonstration_leaves_the_others_as_they_are(profile: str) -> None:
    query = recording(wedge)
    context = RecognitionContext(
        recognizer=Recognizer(drawn_language(), profile), poses=query, whole=query
    )
    after = FurtherDemonstration(size=0.5, label="circle").apply(context)
    first, second = after.language.gesture("circle").single_demonstrations()
    assert (first.image == drawn_language().gesture("circle").image).all()
    assert (second.image == drawn_language().gesture("wedge").image).all()
    assert (after.profile, after.poses) == (context.profile, query)


def test_nothing_can_be_demonstrated_by_a_hand_at_rest(context: RecognitionContext) -> None:
    still = recording(lambda share: circle(0 * share))
    with pytest.raises(GestureError, match="nothing moves"):
        NewDemonstration(size=1.0, label="circle").apply(replace(context, poses=still))
    with pytest.raises(GestureError, match="nothing moves"):
        FurtherDemonstration(size=0.5, label="circle").apply(replace(context, poses=still))


@pytest.mark.parametrize(
    ("change", "values", "words"),
    [
        (Trim(size=0.2, start=0.1, end=1.6), {"start": 0.1, "end": 1.6}, "0.10-1.60 s"),
        (VoterWeight(size=0.1, voter="hu", factor=0.0), {"factor": 0.0}, "without the voter hu"),
        (
            VoterWeight(size=0.1, voter="wrist_bend", factor=2.0),
            {"voter": "wrist_bend"},
            "with 2 times the weight on the voter wrist bend",
        ),
        (KeypointRepair(size=0.1, on=True), {"on": True}, "put right"),
        (OtherProfile(size=1.0, profile="full"), {"profile": "full"}, "profile full"),
        (
            SalientKeypoints(size=0.5, label="a", salient=("left_wrist", "nose")),
            {"salient": ["left_wrist", "nose"]},
            "left wrist and nose",
        ),
        (
            SwitchPosition(size=1 / 3, label="a", switch="tempo", position="off"),
            {"switch": "tempo", "position": "off"},
            "switch tempo of 'a' off",
        ),
        (
            FurtherDemonstration(size=0.5, label="a"),
            {"label": "a", "reach": "gesture"},
            "with this take as another demonstration of 'a'",
        ),
        (
            NewDemonstration(size=1.0, label="a"),
            {"label": "a"},
            "with this take in place of the demonstration of 'a'",
        ),
    ],
)
def test_a_change_is_plain_json_to_apply_and_words_to_read(
    change: Intervention, values: dict[str, object], words: str
) -> None:
    told = json.loads(json.dumps(change.to_dict()))
    assert told["kind"] == change.kind
    assert values.items() <= told.items()
    assert words in told["words"]


def test_a_situation_of_a_take_can_be_cut_to_all_of_it(context: RecognitionContext) -> None:
    def take(poses: PoseSequence) -> Take:
        return Take(
            start=0.0,
            end=2.0,
            closed=True,
            poses=poses.between(0.5, 1.5),
            stroke_start=0.5,
            stroke_end=1.5,
            untrimmed=poses,
        )

    cut = RecognitionContext.of_take(context.recognizer, take(recording(wedge)))
    assert (len(cut.poses), len(cut.whole)) == (len(context.poses), len(context.whole))
