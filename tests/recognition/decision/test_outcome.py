"""Rejection: what is no gesture of the language gets no label."""

import itertools
from dataclasses import replace
from random import Random

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from app.recognition import Gesture, Language, LanguageError, Recognizer
from app.recognition.decision.fused_vote import FusedVote
from app.recognition.decision.outcome import (
    FEWEST,
    LIMIT_OF_ARMS,
    LIMIT_OF_HANDS,
    MOST,
    OthersScores,
    choose_limit,
)
from app.recognition.gestures.profile import Tuning
from app.recognition.gestures.switches import Switches
from app.recognition.poses.sequence import FloatArray
from tests.recognition.demonstrations import TAUGHT, shown_by
from tests.recognition.strategies import SHAPES, circle, recording


@pytest.fixture(scope="module")
def recognizer() -> Recognizer:
    gestures = [Gesture.from_demonstration(name, recording(SHAPES[name])) for name in TAUGHT]
    return Recognizer(Language("pool", gestures))


def bounce(share: FloatArray) -> FloatArray:
    height = 0.8 - 1.2 * np.abs(np.sin(9 * share))
    return np.stack([-0.8 + 0.1 * np.sin(30 * share), height], axis=1)


def limit_of(recognizer: Recognizer) -> float:
    assert isinstance(recognizer.vote, FusedVote)
    return recognizer.vote.limit


def test_a_foreign_movement_has_no_label_but_a_nearest_gesture(recognizer: Recognizer) -> None:
    result = recognizer.recognize(recording(bounce, jitter=0.01))
    assert result.label is None
    nearest = result.gestures.index(result.nearest)
    assert result.scores[nearest] == result.scores.min()
    assert result.novelty[nearest] > 1
    assert result.confidence < 0.5 < recognizer.recognize(recording(circle)).confidence


@pytest.mark.parametrize("name", TAUGHT)
def test_another_take_is_far_from_being_rejected(recognizer: Recognizer, name: str) -> None:
    poses = recording(SHAPES[name], frames=95, rate=25, torso=60, centre=(200, 300), jitter=0.01)
    result = recognizer.recognize(poses)
    assert result.label == name
    assert result.novelty[result.gestures.index(name)] < 0.6


def test_profile_paper_never_rejects(recognizer: Recognizer) -> None:
    result = Recognizer(recognizer.language, "paper").recognize(recording(bounce))
    assert result.label == result.nearest
    assert np.isnan(result.novelty).all()


def test_novelty_is_the_score_over_one_limit_for_all_gestures(recognizer: Recognizer) -> None:
    alone = Recognizer(recognizer.language, tuning=Tuning(weights={"second_opinion": 0.0}))
    result = alone.recognize(recording(bounce, jitter=0.01))
    # A take as large as its gesture has no further factor.
    np.testing.assert_allclose(result.novelty, result.scores / limit_of(recognizer))
    np.testing.assert_array_equal(result.novelty, result.novelty_by_view["movement"])
    assert np.isnan(result.novelty_by_view["hand"]).all()


def test_a_take_much_smaller_than_its_gesture_is_more_novel(recognizer: Recognizer) -> None:
    alone = Recognizer(recognizer.language, tuning=Tuning(weights={"second_opinion": 0.0}))

    def sized(scale: float) -> float:
        poses = recording(lambda share: scale * circle(share), jitter=0.002)
        result = alone.recognize(poses)
        return float(result.novelty[0] / result.scores[0]) * limit_of(recognizer)

    assert [sized(scale) for scale in (1.0, 0.8, 2.0)] == pytest.approx([1.0] * 3)
    assert sized(0.4) > 1.5


def test_one_person_leaves_a_cautious_limit_larger_where_elbows_are_seen() -> None:
    few = OthersScores(2, np.full(FEWEST - 1, 0.2))
    assert choose_limit(few, 0.05, arms=True) == LIMIT_OF_ARMS
    assert choose_limit(few, 0.05, arms=False) == LIMIT_OF_HANDS


@pytest.mark.parametrize("refused", [0.02, 0.05, 0.1, 0.3])
def test_with_several_people_the_limit_refuses_the_share_that_was_asked_for(refused: float) -> None:
    scores = np.random.default_rng(1).uniform(0.2, 0.9, 400)
    limit = choose_limit(OthersScores(2, scores), refused, arms=True)
    assert (scores > limit).mean() == pytest.approx(refused, abs=0.01)


def test_no_limit_is_beyond_the_distance_of_two_gestures() -> None:
    assert choose_limit(OthersScores(2, np.full(20, 3.0)), 0.05, arms=True) == MOST


@st.composite
def scored(draw: st.DrawFn) -> tuple[FloatArray, list[int], list[str]]:
    """Draw scores of demonstrations for each other, their gestures and who has shown them."""
    count = draw(st.integers(1, 12))
    score = st.floats(0.0, 3.0) | st.just(np.inf)
    scores = draw(arrays(np.float64, (count, count), elements=score))
    owners = draw(st.lists(st.integers(0, 3), min_size=count, max_size=count))
    divers = draw(st.lists(st.sampled_from(["", "Ann", "Bo"]), min_size=count, max_size=count))
    return scores, owners, divers


def find(scores: FloatArray, owners: list[int], divers: list[str]) -> OthersScores:
    return OthersScores.of(scores, np.arange(len(owners)), np.array(owners), np.array(divers))


@given(scored())
def test_a_demonstration_is_compared_with_those_of_other_people_only(
    drawn: tuple[FloatArray, list[int], list[str]],
) -> None:
    scores, owners, divers = drawn
    expected: dict[bool, list[float]] = {True: [], False: []}
    for take, which in itertools.product(range(len(owners)), (True, False)):
        by_others = [
            scores[take, other]
            for other in range(len(owners))
            if divers[other] != divers[take] and (owners[other] == owners[take]) is which
        ]
        if np.isfinite(least := min(by_others, default=np.inf)):
            expected[which].append(least)
    found = find(scores, owners, divers)
    assert found.people == len(set(divers))
    assert found.right.tolist() == expected[True]
    assert found.foreign.tolist() == expected[False]


@given(scored(), st.randoms(use_true_random=False))
def test_the_order_of_the_demonstrations_and_the_names_of_people_change_nothing(
    drawn: tuple[FloatArray, list[int], list[str]], random: Random
) -> None:
    scores, owners, divers = drawn
    order = [*range(len(owners))]
    random.shuffle(order)
    renamed = [{"": "Cy", "Ann": "", "Bo": "Ann"}[divers[index]] for index in order]
    one = find(scores, owners, divers)
    other = find(scores[np.ix_(order, order)], [owners[index] for index in order], renamed)
    np.testing.assert_array_equal(np.sort(one.right), np.sort(other.right))
    np.testing.assert_array_equal(np.sort(one.foreign), np.sort(other.foreign))


def test_demonstrations_of_several_people_set_the_limit() -> None:
    together = Recognizer(shown_by(("Ann", "Bo", "Cy")))
    assert limit_of(together) not in (LIMIT_OF_ARMS, LIMIT_OF_HANDS)
    strict, lenient = (
        limit_of(Recognizer(replace(together.language, most_refused=share)))
        for share in (0.5, 0.01)
    )
    assert strict < limit_of(together) < lenient


def test_mirror_images_are_no_demonstrations_of_their_own() -> None:
    language = shown_by(("Ann", "Bo"))
    images = [replace(each, switches=Switches(mirror="on")) for each in language.gestures]
    mirrored = replace(language, gestures=images)
    for each in (language, mirrored):
        vote = Recognizer(each).vote
        assert isinstance(vote, FusedVote)
        assert len(vote.others.right) == len(vote.others.foreign) == 2 * len(TAUGHT)


def test_one_persons_repetitions_do_not_set_the_limit() -> None:
    assert limit_of(Recognizer(shown_by(("Ann", "Ann", "Ann")))) == LIMIT_OF_ARMS
    assert limit_of(Recognizer(shown_by(("", "", "")))) == LIMIT_OF_ARMS


@pytest.mark.parametrize("share", [0.0, -0.1, 0.51, float("nan")])
def test_a_share_that_is_none_is_refused(recognizer: Recognizer, share: float) -> None:
    with pytest.raises(LanguageError, match="share of right takes") as error:
        replace(recognizer.language, most_refused=share)
    assert error.value.pointer == "/most_refused"


def test_the_share_is_in_the_file_where_it_is_not_the_default(recognizer: Recognizer) -> None:
    language = recognizer.language
    assert "most_refused" not in language.to_json()
    other = replace(language, most_refused=0.1)
    assert Language.from_json(other.to_json()).most_refused == 0.1
