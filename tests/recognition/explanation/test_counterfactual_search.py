"""Counterfactuals: small changes that help, verified, with what they do to the rest."""

from collections import Counter

import pytest

from app.recognition import Gesture, Language, PoseSequence, Recognizer
from app.recognition.explanation.context import RecognitionContext
from app.recognition.explanation.counterfactual_candidates import list_interventions
from app.recognition.explanation.counterfactual_kinds import Trim
from app.recognition.explanation.counterfactual_search import (
    MOST,
    MOST_OF_A_KIND,
    ORDER,
    Counterfactuals,
    find_counterfactuals,
    measure_margin,
)
from app.recognition.gestures.profile import PROFILES
from app.recognition.poses.landmarks import POSE_LANDMARKS, other_side
from tests.recognition.damaged_poses import with_sides_exchanged
from tests.recognition.demonstrations import drawn_language, drawn_recognizer
from tests.recognition.explanation.test_differences import HOOK, corners
from tests.recognition.strategies import SHAPES, recording, wedge


def found_for(
    poses: PoseSequence, expected: str, recognizer: Recognizer, whole: PoseSequence | None = None
) -> Counterfactuals:
    context = RecognitionContext(recognizer=recognizer, poses=poses, whole=whole or poses)
    assert context.result.label != expected
    return find_counterfactuals(context, expected)


@pytest.mark.parametrize("profile", PROFILES)
def test_each_turns_the_recognition_right_when_applied(profile: str) -> None:
    query = recording(SHAPES["square"], jitter=0.03)
    context = RecognitionContext(recognizer=drawn_recognizer(profile), poses=query, whole=query)
    told = find_counterfactuals(context, "circle")
    assert told.found
    assert told.tried >= len(told.found)
    for each in told.found:
        after = each.change.apply(context).result
        assert after.label == each.label == "circle"
        assert after.confidence == each.confidence


@pytest.mark.parametrize("profile", PROFILES)
def test_what_teaches_most_comes_first_and_not_too_many_of_a_kind(profile: str) -> None:
    told = found_for(recording(SHAPES["square"], jitter=0.03), "circle", drawn_recognizer(profile))
    sizes = [each.change.size for each in told.found]
    ranks = [(ORDER.index(each.change.kind), each.change.size) for each in told.found]
    assert ranks == sorted(ranks)
    assert all(0.0 < size <= 1.0 for size in sizes)
    assert len(sizes) <= MOST
    kinds = Counter(each.change.kind for each in told.found)
    assert max(kinds.values()) <= MOST_OF_A_KIND


def test_a_transit_in_the_stroke_is_trimmed_off() -> None:
    x, y = HOOK[2]
    transit = (*HOOK[:3], (x - 0.2, y))
    gestures = [
        Gesture.from_demonstration("corner", recording(corners(*HOOK[:3]))),
        Gesture.from_demonstration("hook", recording(corners(*transit))),
    ]
    recognizer = Recognizer(Language("hooks", gestures), "paper")
    told = found_for(recording(corners(*transit)), "corner", recognizer)
    trims = [each for each in told.found if each.change.kind == "trim"]
    assert trims
    assert trims[0].effect is None  # it changes this take alone


def test_a_stroke_cut_too_short_is_made_longer() -> None:
    gestures = [
        Gesture.from_demonstration("corner", recording(corners(*HOOK[:3]))),
        Gesture.from_demonstration("hook", recording(corners(*HOOK))),
    ]
    whole = recording(corners(*HOOK), frames=90)
    recognizer = Recognizer(Language("hooks", gestures), "full")
    told = found_for(whole.between(0.0, 2.0), "hook", recognizer, whole)
    assert any(each.change.kind == "trim" for each in told.found)


def test_bad_keypoints_are_repaired() -> None:
    mistaken = with_sides_exchanged(recording(wedge), [*range(20, 26), *range(34, 40)])
    told = found_for(mistaken, "wedge", drawn_recognizer("paper"))
    repairs = [each for each in told.found if each.change.kind == "keypoint_repair"]
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
    assert "switch" in {each.change.kind for each in told.found}


@pytest.mark.parametrize("profile", PROFILES)
def test_none_makes_a_gesture_of_the_language_lose_a_take(profile: str) -> None:
    told = found_for(recording(SHAPES["line"], jitter=0.01), "circle", drawn_recognizer(profile))
    effects = [each.effect for each in told.found if each.effect is not None]
    assert all(effect.takes == 2 * len(SHAPES) and effect.lost == () for effect in effects)
    # A circle shown as a line is no circle any more, and takes lines for itself.
    assert "demonstration" not in {each.change.kind for each in told.found}


def test_another_demonstration_is_offered_first() -> None:
    language = Language(
        "pool",
        [
            Gesture.from_demonstration(name, recording(SHAPES[name]))
            for name in ("circle", "infinity", "line")
        ],
    )
    query = recording(SHAPES["square"], jitter=0.005)
    found = found_for(query, "line", Recognizer(language, "paper")).found
    assert found[0].change.kind == "further_demonstration"
    assert found[0].effect is not None
    assert found[0].effect.right_after == found[0].effect.right_before


def test_a_trim_keeps_most_of_the_stroke() -> None:
    whole = recording(corners(*HOOK), frames=90)
    stroke = whole.between(1.0, 2.0)
    context = RecognitionContext(recognizer=drawn_recognizer("full"), poses=stroke, whole=whole)
    trims = [
        change
        for series in list_interventions(context, "circle")
        for change in series
        if isinstance(change, Trim)
    ]
    start, end = float(stroke.time[0]), float(stroke.time[-1])
    kept = [min(each.end, end) - max(each.start, start) for each in trims]
    assert trims
    assert min(kept) >= 0.8 * (end - start) - 1e-6


def test_a_gesture_with_as_many_demonstrations_as_it_may_have_gets_no_other() -> None:
    circled = drawn_language().gesture("circle")
    for seed in range(4):
        circled = circled.with_demonstration(recording(SHAPES["circle"], jitter=0.01, seed=seed))
    full = Recognizer(drawn_language().with_changed(circled), "paper")
    query = recording(SHAPES["line"], jitter=0.01)
    context = RecognitionContext(recognizer=full, poses=query, whole=query)
    kinds = {each.kind for series in list_interventions(context, "circle") for each in series}
    assert "demonstration" in kinds
    assert "further_demonstration" not in kinds


def test_no_weight_helps_a_gesture_whose_keypoint_is_not_seen() -> None:
    left = Gesture.from_demonstration("left", recording(wedge, hand="left_wrist"))
    recognizer = Recognizer(Language("pool", [*drawn_language().gestures, left]), "paper")
    landmarks = tuple(name for name in POSE_LANDMARKS if name != "left_wrist")
    told = found_for(recording(SHAPES["circle"], landmarks=landmarks), "left", recognizer)
    assert {each.change.kind for each in told.found} <= {
        "salient",
        "further_demonstration",
        "demonstration",
    }


@pytest.mark.parametrize(
    ("scores", "expected"),
    [
        ([0.2, 0.5, 0.9], 0.3),
        ([0.6, 0.5, 0.9], -0.1),
        ([0.2], float("inf")),
        ([float("inf"), 0.5], -float("inf")),
    ],
)
def test_the_margin_is_to_the_nearest_other(scores: list[float], expected: float) -> None:
    assert measure_margin(scores, 0) == pytest.approx(expected)
