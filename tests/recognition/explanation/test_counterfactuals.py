"""Counterfactuals: changes that help, verified, with what they do to the rest of the language."""

import json
from dataclasses import replace

import pytest

from app.recognition import Gesture, GestureError, Language, PoseSequence, Recognizer, Take
from app.recognition.explanation.context import KnownTake, RecognitionContext
from app.recognition.explanation.counterfactuals import (
    Counterfactual,
    Intervention,
    find_counterfactuals,
    list_interventions,
)
from app.recognition.explanation.demonstration_faults import DemonstrationFault, FaultKind
from app.recognition.explanation.explanation import explain
from app.recognition.gestures.demonstration import MAX_DEMONSTRATIONS
from app.recognition.gestures.profile import PROFILES, Tuning
from app.recognition.poses.landmarks import other_side
from tests.recognition.damaged_poses import with_sides_exchanged
from tests.recognition.demonstrations import drawn_language, drawn_recognizer
from tests.recognition.explanation.test_blame import SALUTE
from tests.recognition.explanation.test_causes import HOOK, corners, hook
from tests.recognition.strategies import SHAPES, circle, recording, wedge

TRIM = Intervention("trim", 0.5, {"start": 0.2, "end": 1.0, "longer": False})
UNREPAIRED = Intervention("keypoint_repair", 0.1, {"on": False})


def cut(label: str, demonstration: int, start: float, end: float) -> Intervention:
    values = {"label": label, "demonstration": demonstration, "start": start, "end": end}
    return Intervention("demonstration_cut", 0.5, values)


@pytest.fixture(scope="module")
def context() -> RecognitionContext:
    recognizer = Recognizer(drawn_language(), "full", tuning=Tuning(weights={"velocity": 3.0}))
    whole = recording(wedge)
    return RecognitionContext(recognizer=recognizer, poses=whole.between(0.5, 1.5), whole=whole)


def found_for(
    poses: PoseSequence, expected: str, recognizer: Recognizer, whole: PoseSequence | None = None
) -> tuple[Counterfactual, ...]:
    made = RecognitionContext(recognizer=recognizer, poses=poses, whole=whole or poses)
    assert made.result.label != expected
    return find_counterfactuals(made, expected)[0]


def test_a_trim_cuts_the_whole_otherwise_and_keeps_the_recogniser(
    context: RecognitionContext,
) -> None:
    changed = TRIM.apply(context)
    assert (changed.poses.time[0], changed.poses.time[-1]) == pytest.approx((0.2, 1.0))
    assert changed.recognizer is context.recognizer


def test_a_change_forgets_the_recorded_answer(context: RecognitionContext) -> None:
    recorded = replace(context, recorded=context.result.model_copy(update={"nearest": "line"}))
    assert recorded.result.nearest == "line"
    assert TRIM.apply(recorded).recorded is None
    assert UNREPAIRED.apply(recorded).recorded is None


def test_tuning_changes_one_thing_and_keeps_the_rest(context: RecognitionContext) -> None:
    unrepaired = UNREPAIRED.apply(context)
    assert (unrepaired.recognizer.repairs, unrepaired.recognizer.tuning.weights) == (
        False,
        {"velocity": 3.0},
    )


def test_a_switch_is_the_only_thing_that_changes_about_a_gesture(
    context: RecognitionContext,
) -> None:
    change = Intervention("switch", 1 / 3, {"label": "wedge", "switch": "mirror", "position": "on"})
    switches = change.apply(context).language.gesture("wedge").switches
    assert (switches.mirror, switches.direction, switches.tempo) == ("on", "auto", "auto")


def test_a_cut_keeps_the_middle_of_a_demonstration(context: RecognitionContext) -> None:
    middle = cut("circle", 0, 0.5, 1.5)
    before, after = (each.language.gesture("circle") for each in (context, middle.apply(context)))
    assert before.trajectory is not None
    assert after.trajectory is not None
    assert after.trajectory.time[-1] == pytest.approx(1.0, abs=0.05)
    assert (after.image != before.image).any()
    for wrong in (
        cut("circle", 3, 0.5, 1.5),
        cut("circle", 0, 0.5, 0.51),
    ):
        with pytest.raises(GestureError, match=r"no demonstration 3|would be left"):
            wrong.apply(context)


@pytest.mark.parametrize("profile", PROFILES)
def test_a_further_demonstration_leaves_the_others_as_they_are(profile: str) -> None:
    query = recording(wedge)
    made = RecognitionContext(
        recognizer=Recognizer(drawn_language(), profile), poses=query, whole=query
    )
    after = Intervention("further_demonstration", 0.5, {"label": "circle"}).apply(made)
    first, second = after.language.gesture("circle").single_demonstrations()
    assert (first.image == drawn_language().gesture("circle").image).all()
    assert (second.image == drawn_language().gesture("wedge").image).all()
    assert (after.recognizer.profile, after.poses) == (profile, query)


def test_nothing_can_be_demonstrated_by_a_hand_at_rest(context: RecognitionContext) -> None:
    still = recording(lambda share: circle(0 * share))
    with pytest.raises(GestureError, match="nothing moves"):
        Intervention("further_demonstration", 0.5, {"label": "circle"}).apply(
            replace(context, poses=still)
        )


@pytest.mark.parametrize(
    ("change", "values", "words"),
    [
        (
            Intervention("trim", 0.2, {"start": 0.1, "end": 1.6, "longer": True}),
            {"start": 0.1, "end": 1.6, "reach": "take"},
            "with more of the clip, 0.10-1.60 s",
        ),
        (Intervention("keypoint_repair", 0.1, {"on": True}), {"reach": "language"}, "put right"),
        (
            Intervention("switch", 1 / 3, {"label": "a", "switch": "tempo", "position": "off"}),
            {"switch": "tempo", "position": "off"},
            "switch tempo of 'a' off",
        ),
        (
            Intervention("further_demonstration", 0.5, {"label": "a"}),
            {"label": "a", "reach": "gesture"},
            "with this take as another demonstration of 'a'",
        ),
        (
            cut("a", 1, 0.5, 1.5),
            {"demonstration": 1, "start": 0.5},
            "with the demonstration of 'a' cut to 0.50-1.50 s",
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
    poses = recording(wedge)
    take = Take(
        start=0.0,
        end=2.0,
        closed=True,
        poses=poses.between(0.5, 1.5),
        stroke_start=0.5,
        stroke_end=1.5,
        untrimmed=poses,
    )
    cut = RecognitionContext.of_take(context.recognizer, take)
    assert (len(cut.poses), len(cut.whole)) == (len(context.poses), len(context.whole))


@pytest.mark.parametrize("profile", PROFILES)
def test_each_turns_the_recognition_right_when_applied(profile: str) -> None:
    query = recording(SHAPES["square"], jitter=0.03)
    made = RecognitionContext(recognizer=drawn_recognizer(profile), poses=query, whole=query)
    found, tried = find_counterfactuals(made, "circle")
    assert found
    assert tried >= len(found)
    for each in found:
        after = each.change.apply(made).result
        assert after.label == each.label == "circle"
        assert after.confidence == each.confidence


def test_this_take_as_demonstration_is_offered_where_it_repairs_other_takes() -> None:
    shapes = drawn_recognizer("full")
    query = recording(SHAPES["square"], jitter=0.005)
    read = tuple(
        KnownTake(label, shapes.query(recording(SHAPES[label], jitter=0.01, seed=seed)))
        for label in ("circle", "line")
        for seed in range(2)
    )
    square = shapes.query(recording(SHAPES["square"], jitter=0.01))
    made = RecognitionContext(recognizer=shapes, poses=query, whole=query)
    misread = replace(made, known=(*read, KnownTake("infinity", square)))
    *_, last = find_counterfactuals(misread, "infinity")[0]
    assert last.change.kind == "further_demonstration"
    assert last.effect is not None
    assert (last.effect.takes, last.effect.repaired, last.effect.broken) == (5, 1, 0)
    # It is right by itself: that repairs nothing.
    assert find_counterfactuals(replace(made, known=read), "infinity")[0] == ()
    # Without an end it may be no gesture at all.
    assert find_counterfactuals(replace(misread, closed=False), "infinity")[0] == ()
    # Farther off than any take that is accepted, it is none, whatever it would repair.
    assert made.result.novelty[made.language.labels.index("line")] > 1
    far_off = replace(made, known=(*read, KnownTake("line", square)))
    assert find_counterfactuals(far_off, "line")[0] == ()


def test_a_bad_demonstration_is_cut_first() -> None:
    gestures = [
        Gesture.from_demonstration(name, recording(shape, frames=frames))
        for name, shape, frames in (
            ("hook", corners(SALUTE, *HOOK, SALUTE), 90),
            ("circle", circle, 60),
            ("line", SHAPES["line"], 60),
        )
    ]
    fault = DemonstrationFault(
        kind=FaultKind.reaches_salute, words="reaches the salutes", remedy="set_range"
    )
    query = recording(hook)
    made = RecognitionContext(
        recognizer=Recognizer(Language("hooks", gestures), "full"),
        poses=query,
        whole=query,
        faults={"hook": [(fault,)]},
    )
    explanation = explain(made, "hook")
    assert fault.describe("hook") in {cause.sentence for cause in explanation.causes}
    assert explanation.counterfactuals[0].change.kind == "demonstration_cut"


def test_a_transit_in_the_stroke_is_trimmed_off() -> None:
    x, y = HOOK[2]
    transit = (*HOOK[:3], (x - 0.2, y))
    gestures = [
        Gesture.from_demonstration("corner", recording(corners(*HOOK[:3]))),
        Gesture.from_demonstration("hook", recording(corners(*transit))),
    ]
    recognizer = Recognizer(Language("hooks", gestures), "paper")
    told = found_for(recording(corners(*transit)), "corner", recognizer)
    trims = [each for each in told if each.change.kind == "trim"]
    assert trims
    assert trims[0].effect is None  # it changes this take alone


def test_a_stroke_cut_too_short_is_made_longer() -> None:
    gestures = [
        Gesture.from_demonstration("corner", recording(corners(*HOOK[:3]))),
        Gesture.from_demonstration("hook", recording(corners(*HOOK[:4]))),
    ]
    whole = recording(corners(*HOOK[:4]), frames=90)
    recognizer = Recognizer(Language("hooks", gestures), "full")
    told = found_for(whole.between(0.0, 2.0), "hook", recognizer, whole)
    assert any(each.change.kind == "trim" for each in told)


def test_bad_keypoints_are_repaired() -> None:
    mistaken = with_sides_exchanged(recording(wedge), [*range(20, 26), *range(34, 40)])
    told = found_for(mistaken, "wedge", drawn_recognizer("paper"))
    repairs = [each for each in told if each.change.kind == "keypoint_repair"]
    assert len(repairs) == 1
    assert repairs[0].change.size == pytest.approx(12 / 60, abs=0.07)


def test_the_other_hand_counts_with_the_mirror_switch() -> None:
    two = Gesture.from_demonstration("other", recording(SHAPES["line"], hand="left_wrist"))
    language = Language("pool", [*drawn_language().gestures, two])
    query = recording(wedge)
    mirrored = PoseSequence(
        landmarks=tuple(other_side(name) for name in query.landmarks),
        xy=query.xy * (-1.0, 1.0) + (640.0, 0.0),
        time=query.time,
        frame_size=query.frame_size,
    )
    told = found_for(mirrored, "wedge", Recognizer(language, "full"))
    assert "switch" in {each.change.kind for each in told}


@pytest.mark.parametrize("profile", PROFILES)
def test_none_makes_a_gesture_of_the_language_lose_its_demonstration(profile: str) -> None:
    told = found_for(recording(SHAPES["line"], jitter=0.01), "circle", drawn_recognizer(profile))
    effects = [each.effect for each in told if each.effect is not None]
    assert all(effect.takes == 0 and effect.lost == () for effect in effects)


def test_a_trim_keeps_most_of_the_stroke() -> None:
    whole = recording(corners(*HOOK), frames=90)
    stroke = whole.between(1.0, 2.0)
    made = RecognitionContext(recognizer=drawn_recognizer("full"), poses=stroke, whole=whole)
    trims = [
        change
        for series in list_interventions(made, "circle")
        for change in series
        if change.kind == "trim"
    ]
    start, end = float(stroke.time[0]), float(stroke.time[-1])
    kept = [min(each.values["end"], end) - max(each.values["start"], start) for each in trims]
    assert trims
    assert min(kept) >= 0.8 * (end - start) - 1e-6


def test_a_gesture_with_as_many_demonstrations_as_it_may_have_gets_no_other() -> None:
    circled = drawn_language().gesture("circle")
    for seed in range(MAX_DEMONSTRATIONS - 1):
        circled = circled.with_demonstration(recording(SHAPES["circle"], jitter=0.01, seed=seed))
    full = Recognizer(drawn_language().with_changed(circled), "paper")
    query = recording(SHAPES["line"], jitter=0.01)
    made = RecognitionContext(recognizer=full, poses=query, whole=query)
    kinds = {each.kind for series in list_interventions(made, "circle") for each in series}
    assert "trim" in kinds
    assert "further_demonstration" not in kinds


@pytest.mark.parametrize(("hand", "offered"), [("right_wrist", False), ("left_wrist", True)])
def test_the_mirror_image_is_offered_for_the_other_arm_only(hand: str, offered: bool) -> None:
    poses = recording(circle, hand=hand)
    left = Gesture.from_demonstration("left", recording(SHAPES["line"], hand="left_wrist"))
    recognizer = Recognizer(drawn_language().with_gesture(left), "full")
    made = RecognitionContext(recognizer=recognizer, poses=poses, whole=poses)
    switches = [
        each.values["switch"]
        for series in list_interventions(made, "wedge")
        for each in series
        if each.kind == "switch" and each.values["label"] == "wedge"
    ]
    assert ("mirror" in switches) == offered
