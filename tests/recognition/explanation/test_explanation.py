"""Explanations: which voters were wrong, where and by how much, and which changes would help."""

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.recognition import Gesture, Language, OsgError, PoseSequence, Recognizer
from app.recognition.explanation.blame import Blame, Evidence
from app.recognition.explanation.causes import Cause, CauseKind
from app.recognition.explanation.context import RecognitionContext
from app.recognition.explanation.explanation import Explanation, explain
from app.recognition.explanation.strokes import transcribe_gesture
from app.recognition.explanation.transcript import describe_strokes
from app.recognition.gestures.profile import PROFILES, Tuning
from tests.recognition.damaged_poses import with_sides_exchanged
from tests.recognition.demonstrations import drawn_language, drawn_recognizer
from tests.recognition.explanation.test_causes import corners
from tests.recognition.explanation.test_strokes import stopping
from tests.recognition.strategies import Shape, circle, line, recording, recordings, square, wedge


def context(poses: PoseSequence, recognizer: Recognizer) -> RecognitionContext:
    return RecognitionContext(recognizer=recognizer, poses=poses, whole=poses)


def why(poses: PoseSequence, expected: str, profile: str = "full") -> Explanation:
    return explain(context(poses, drawn_recognizer(profile)), expected, with_counterfactuals=False)


@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("expected", ["circle", "line"])
@settings(max_examples=5)
@given(recordings())
def test_what_the_voters_say_adds_up_to_the_difference_of_the_scores(
    profile: str, expected: str, query: PoseSequence
) -> None:
    explanation = why(query, expected, profile)
    scores = context(query, drawn_recognizer(profile)).score_table.scores
    assert explanation.other is not None
    difference = scores[drawn_language().labels.index(expected)]
    difference -= scores[drawn_language().labels.index(explanation.other)]
    told = sum(voter.against for voter in explanation.breakdown) + explanation.turned
    assert told == pytest.approx(difference, abs=1e-9)
    assert explanation.margin == pytest.approx(-difference, abs=1e-9)


@pytest.mark.parametrize("profile", PROFILES)
def test_the_alignments_cost_what_the_path_voter_measures_and_their_ends(profile: str) -> None:
    explanation = why(recording(wedge, jitter=0.02), "circle", profile)
    measured = {each.voter: each for each in explanation.breakdown}
    for alignment in explanation.alignments:
        if profile == "full":
            of = measured[alignment.voter]
            expected = alignment.label == "circle"
            distance = of.distance if expected else of.other_distance
            assert distance is not None
            assert distance - 1e-5 <= alignment.distance < 2 * distance
        assert np.min(alignment.costs) >= 0.0
    assert [each.label for each in explanation.alignments] == ["circle", "wedge"]


@pytest.mark.parametrize("profile", PROFILES)
def test_a_path_alignment_can_be_drawn(profile: str) -> None:
    for alignment in why(recording(square, jitter=0.01), "wedge", profile).alignments:
        steps, others = np.transpose(alignment.pairs)
        between = np.array(alignment.query)[steps] - np.array(alignment.gesture)[others]
        whole = np.sqrt((between**2).sum(axis=(1, 2))) / len(alignment.query)
        assert np.sum(alignment.costs, axis=1) == pytest.approx(whole, abs=5e-4)


def test_moments_are_those_of_the_querys_clock() -> None:
    query = recording(square, frames=60)
    late = PoseSequence(
        landmarks=query.landmarks, xy=query.xy, time=query.time + 7, frame_size=query.frame_size
    )
    path = why(late, "wedge").alignments[0]
    # A little of the path is cut at either end.
    assert path.time[0] == pytest.approx(7.0, abs=0.15)
    assert path.time[-1] == pytest.approx(query.time[-1] + 7, abs=0.15)
    assert np.ptp(path.gesture_time) == pytest.approx(query.time[-1], abs=0.3)


@pytest.mark.parametrize("profile", PROFILES)
def test_what_was_right_is_held_against_the_runner_up(profile: str) -> None:
    explanation = explain(
        context(recording(circle, jitter=0.01), drawn_recognizer(profile)), "circle"
    )
    assert explanation.right
    assert explanation.other != "circle"
    assert explanation.margin > 0
    assert explanation.tried == 0
    assert explanation.sentence == "Read as 'circle', as expected."
    assert explanation.other == explanation.runner_up
    assert any(repr(explanation.other) in line for line in explanation.details)


@pytest.mark.parametrize("profile", PROFILES)
def test_an_explanation_is_plain_json(profile: str) -> None:
    explanation = why(recording(wedge, jitter=0.02), "circle", profile)
    told = json.loads(json.dumps(explanation.to_dict(), allow_nan=False))
    assert told["sentence"] == explanation.sentence
    assert told["expected"] == "circle"
    assert not told["right"]
    assert len(json.dumps(told)) < 40_000


def test_a_language_of_one_gesture_has_nothing_to_hold_against() -> None:
    language = Language("one", drawn_language().gestures[:1])
    explanation = explain(context(recording(circle), Recognizer(language, "full")), "circle")
    assert explanation.other is None
    assert explanation.right
    assert explanation.to_dict()["margin"] is None


def test_a_gesture_that_cannot_be_compared_is_told() -> None:
    left = Gesture.from_demonstration("left", recording(circle, hand="left_wrist"))
    language = Language("pool", [*drawn_language().gestures, left])
    landmarks = tuple(name for name in recording(circle).landmarks if name != "left_wrist")
    for profile in PROFILES:
        query = recording(line, landmarks=landmarks)
        explanation = explain(context(query, Recognizer(language, profile)), "left")
        assert explanation.margin == -np.inf
        assert "is not seen moving" in explanation.sentence
        json.dumps(explanation.to_dict(), allow_nan=False)


def test_gestures_without_demonstration_are_explained_by_their_images() -> None:
    pictures = [replace(gesture, trajectory=None) for gesture in drawn_language().gestures]
    language = Language("pictures", pictures)
    for profile in PROFILES:
        query = recording(wedge, jitter=0.02)
        explanation = explain(context(query, Recognizer(language, profile)), "circle")
        assert explanation.alignments == ()
        assert explanation.causes == ()
        assert explanation.breakdown[0].against > 0


def test_who_expects_what_the_language_lacks_is_told_what_it_has() -> None:
    with pytest.raises(OsgError, match=r"no gesture 'spiral'.*circle, wedge"):
        explain(context(recording(circle), drawn_recognizer("full")), "spiral")


def test_who_was_rejected_is_told_by_how_much() -> None:
    zigzag = corners((-1.2, -0.4), (-0.3, -0.3), (-1.2, -0.2), (-0.3, -0.1), (-1.2, 0.0))
    examined = context(recording(zigzag), drawn_recognizer("full"))
    assert examined.result.label is None
    nearest = examined.result.nearest
    explanation = explain(examined, nearest, with_counterfactuals=False)
    assert (explanation.label, explanation.other != nearest) == (None, True)
    assert explanation.novelty > 1.0
    allowed = f"The take is {explanation.novelty:.2f} times as far as the limit allows."
    assert allowed in explanation.details
    assert sum(voter.share for voter in explanation.breakdown) == pytest.approx(1.0)


def between(*, asked: bool) -> RecognitionContext:
    """Return a take that lies between two gestures, if asked about, or between three."""
    examined = context(recording(wedge, jitter=0.02), drawn_recognizer("full"))
    names = ("wedge", "circle", "line")
    scores = [
        1.0 + 0.01 * names.index(each) if each in names else 9.0 for each in drawn_language().labels
    ]
    result = examined.result.model_copy(
        update={
            "label": None,
            "pair": names[:2] if asked else None,
            "scores": np.array(scores),
            "novelty": np.full(len(scores), 0.5),
        }
    )
    vars(examined)["trace"] = replace(examined.trace, result=result)
    return examined


@pytest.mark.parametrize("expected", ["wedge", "circle", "square"])
def test_a_take_between_gestures_is_told_so(expected: str) -> None:
    asked = explain(between(asked=True), expected, with_counterfactuals=False)
    assert asked.sentence.startswith("You showed")
    assert (asked.right, asked.to_dict()["pair"]) == (False, ["wedge", "circle"])
    rejected = explain(between(asked=False), expected, with_counterfactuals=False)
    assert rejected.sentence.startswith("You showed")
    assert rejected.to_dict()["pair"] is None


def test_two_ways_of_comparing_that_disagree_are_told() -> None:
    examined = between(asked=True)
    votes = {**examined.result.votes, "second_opinion": "circle"}
    trace = replace(examined.trace, result=examined.result.model_copy(update={"votes": votes}))
    vars(examined)["trace"] = trace
    told = explain(examined, "square", with_counterfactuals=False)
    assert "The two ways of comparing disagree: by directions it is 'circle'." in told.details


def test_a_recording_too_poor_to_judge_is_told_so() -> None:
    query = recording(circle)
    xy = query.xy.copy()
    xy[10:50, query.landmarks.index("right_wrist")] = np.nan
    poor = PoseSequence(
        landmarks=query.landmarks, xy=xy, time=query.time, frame_size=query.frame_size
    )
    explanation = explain(context(poor, drawn_recognizer("full")), "circle")
    assert explanation.label is None
    assert explanation.fault is not None
    assert explanation.fault in explanation.details[0]
    assert explanation.causes[0].kind == "not_seen"
    assert "in 40 of 60 frames" in explanation.sentence


@pytest.mark.parametrize("profile", PROFILES)
def test_the_sentence_names_the_cause_and_the_remedy(profile: str) -> None:
    mistaken = with_sides_exchanged(recording(wedge), [*range(20, 26), *range(34, 40)])
    unrepaired = Recognizer(drawn_language(), profile, tuning=Tuning(keypoints_repaired=False))
    explanation = explain(context(mistaken, unrepaired), "wedge")
    assert not explanation.right
    cause = explanation.causes[0]
    assert (cause.kind, cause.sentence) == ("keypoints_jumped", explanation.sentence)
    assert "keypoint_repair" in {each.change.kind for each in explanation.counterfactuals}
    identifiers = [voter.name for voter in PROFILES[profile].voters if "_" in voter.name]
    assert not any(name in explanation.sentence for name in identifiers)


def test_votes_without_weight_are_not_counted() -> None:
    tuning = Tuning(weights={"hu": 0.0, "zernike": 0.0})
    silent = Recognizer(drawn_language(), "paper", tuning=tuning)
    explanation = explain(context(recording(circle, jitter=0.01), silent), "circle")
    assert sum(explanation.votes.values()) == 5
    assert sum(explanation.support.values()) == pytest.approx(1)


def test_the_take_is_aligned_with_the_demonstration_that_is_nearest() -> None:
    both = (
        drawn_language()
        .gesture("circle")
        .with_demonstration(recording(wedge, hand="left_wrist"), "Ben")
    )
    recognizer = Recognizer(drawn_language().with_changed(both), "paper")
    for query, nearest in (
        (recording(circle, jitter=0.01), 0),
        (recording(wedge, hand="left_wrist", jitter=0.01), 1),
    ):
        explanation = explain(context(query, recognizer), "circle")
        (shown,) = [each for each in explanation.alignments if each.label == "circle"]
        assert explanation.right
        assert shown.demonstration == nearest
        assert shown.distance < 0.05
        assert explanation.causes == ()


def test_the_numbers_tell_nothing_of_a_turn_that_mixed_sides_make_up() -> None:
    mistaken = with_sides_exchanged(recording(wedge), [*range(20, 26), *range(34, 40)])
    unrepaired = Recognizer(drawn_language(), "full", tuning=Tuning(keypoints_repaired=False))
    jumped = explain(context(mistaken, unrepaired), "wedge", with_counterfactuals=False)
    told = jumped.model_copy(update={"facing": 174.0}).details
    assert not any("turned" in each for each in told)
    right = why(recording(wedge), "wedge").model_copy(update={"facing": 24.0})
    assert "The diver is turned 24 degrees to their left." in right.details


def test_strokes_that_could_not_be_followed_are_no_numbers() -> None:
    told = why(recording(circle, jitter=0.01), "wedge")
    for kind, strokes in (("near_gesture", True), ("keypoints_jumped", False)):
        cause = Cause(kind=CauseKind(kind), sentence="So.")
        details = told.model_copy(update={"causes": (cause,)}).details
        assert any("You showed" in each for each in details) is strokes


def test_who_showed_the_strokes_is_told_which_gesture_is_as_near() -> None:
    told = explain(between(asked=True), "wedge", with_counterfactuals=False)
    same = told.model_copy(update={"transcript": replace(told.transcript, differs=None)})
    assert same.sentence.endswith("'circle' is about as near.")
    assert "as near" not in told.model_copy(update={"between": ()}).sentence
    assert "The take is within the limit." in told.model_copy(update={"novelty": 0.6}).details


def test_the_numbers_of_a_blamed_demonstration_stand_only_below_its_sentence() -> None:
    evidence = Evidence(unlike=2.0, failing=1.0, gain=1.0)
    blamed = Blame(
        label="square",
        demonstration=0,
        change="leave_out",
        takes=9,
        failing=3,
        repaired=2,
        broken=0,
        evidence=evidence,
    )
    told = why(recording(circle, jitter=0.01), "square").model_copy(update={"blame": (blamed,)})
    numbers = "Of 9 known takes the change repairs 2 and breaks 0."
    cause = Cause(kind=CauseKind.demonstration, share=1.0, sentence=blamed.sentence)
    other = Cause(kind=CauseKind.near_gesture, share=1.0, sentence="They are nearly alike.")
    assert numbers in told.model_copy(update={"causes": (cause,)}).details
    assert numbers not in told.model_copy(update={"causes": (other, cause)}).details
    assert numbers not in told.model_copy(update={"causes": ()}).details


@pytest.mark.parametrize("query", [square, circle, corners((0, 0), (1, 1), (0, 1), (0, 0))])
def test_a_recording_has_one_transcript_whatever_it_is_compared_with(query: Shape) -> None:
    poses, language = recording(query), drawn_language()
    found = [why(poses, label).transcript for label in language.labels]
    assert len({each.shown for each in found}) == 1
    assert [each.expected for each in found] == [
        transcribe_gesture(gesture) for gesture in language.gestures
    ]


BELOW = ((-0.4, 0.1), (-1.2, 0.1), (-1.2, -0.7), (-0.4, -0.7), (-0.4, 0.1))


def test_a_closed_figure_is_told_from_where_the_hand_begins() -> None:
    box = Gesture.from_demonstration("box", recording(stopping(square, 4)))
    recognizer = Recognizer(drawn_language().without("square").with_gesture(box), "full")
    assert describe_strokes(transcribe_gesture(box)) == "right, down, left, up"
    told = explain(
        context(recording(stopping(corners(*BELOW), 4)), recognizer),
        "box",
        with_counterfactuals=False,
    ).transcript
    assert (told.expected, told.differs) == (transcribe_gesture(box), None)
    assert describe_strokes(told.shown) == "left, up, right, down"


def test_a_demonstration_is_told_alike_as_a_gesture_and_as_a_take() -> None:
    for gesture, shown in zip(drawn_language().gestures, (circle, wedge, square), strict=False):
        take = context(recording(shown), drawn_recognizer("full"))
        made = Gesture.from_demonstration(gesture.label, take.poses)
        assert take.strokes == transcribe_gesture(made)


@pytest.fixture(scope="module")
def box() -> Recognizer:
    """Return a recogniser of a square whose hand stops at the corners, and others."""
    drawn = Gesture.from_demonstration("box", recording(stopping(square, 4), frames=90))
    return Recognizer(drawn_language().without("square").with_gesture(drawn), "full")


@settings(max_examples=15)
@given(
    st.integers(8, 30),
    st.floats(0.2, 0.8),
    st.floats(0.06, 0.15),
    st.floats(0.8, 1.5),
    st.floats(0, 2 * np.pi),
    st.sampled_from([("left_wrist", "right_wrist"), ("right_wrist",), ("left_wrist",)]),
)
def test_a_keypoint_that_jumps_changes_neither_strokes_nor_label(
    box: Recognizer,
    rate: int,
    share: float,
    seconds: float,
    far: float,
    angle: float,
    hands: tuple[str, ...],
) -> None:
    clean = recording(stopping(square, 4), frames=4 * rate, rate=rate)
    xy, first = clean.xy.copy(), int(share * len(clean))
    away = slice(first, first + max(1, int(seconds * rate)))
    for hand in hands:
        by = 120 * far * np.array([np.cos(angle), np.sin(angle)])
        xy[away, clean.landmarks.index(hand)] += by
    jumped = context(replace(clean, xy=xy), box)
    assert describe_strokes(jumped.strokes) == "right, down, left, up"
    assert jumped.result.label == "box"
    told = explain(jumped, "circle", with_counterfactuals=False)
    assert bool(told.transcript.bridged) == ("right_wrist" in hands)
    assert any("is bridged there" in each for each in told.details) == ("right_wrist" in hands)
