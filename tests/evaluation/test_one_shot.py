"""One-shot accuracy: the choice of queries, on drawn movements."""

from dataclasses import replace

import numpy as np
import pytest

from app.evaluation.confusion import NONE
from app.evaluation.one_shot import LabelledTake, OneShot, one_shot, recognize_takes
from app.recognition import Gesture, Language, OsgError
from tests.evaluation.takes import drawn_takes


@pytest.fixture(scope="module")
def swipes() -> list[LabelledTake]:
    return drawn_takes("swipes", people=(0, 1), takes=2)


@pytest.fixture(scope="module")
def by_full(swipes: list[LabelledTake]) -> OneShot:
    return one_shot(swipes, profile="full")


def test_every_take_is_asked_for_under_every_choice_that_did_not_take_it_as_template(
    by_full: OneShot,
) -> None:
    # Two people, two takes of three gestures each: two languages a person.
    assert by_full.languages == 4
    assert by_full.same_person.correct.asked == 4 * (6 - 3)
    assert by_full.other_people.correct.asked == 4 * 6
    assert by_full.same_person.labels == ("left", "right", "up")
    assert by_full.unusable == {}


def test_swipes_to_three_sides_are_told_apart_by_full_and_not_by_shape_alone(
    swipes: list[LabelledTake], by_full: OneShot
) -> None:
    paper = one_shot(swipes, profile="paper").other_people.correct
    full = by_full.other_people.correct
    assert full.correct >= 0.9 * full.asked
    assert paper.correct < 0.8 * paper.asked


def test_where_people_are_not_known_all_queries_are_the_same_persons(
    swipes: list[LabelledTake],
) -> None:
    unknown = [replace(take, person="") for take in swipes]
    result = one_shot(unknown, profile="paper")
    assert result.languages == 4
    assert result.same_person.correct.asked == 4 * (12 - 3)
    assert result.other_people.correct.asked == 0


def test_a_take_that_cannot_be_a_demonstration_is_named_and_still_asked_for(
    swipes: list[LabelledTake],
) -> None:
    shown = swipes[0].poses
    still = replace(shown, xy=np.broadcast_to(shown.xy[:1], shown.xy.shape))
    bad = replace(swipes[0], source="still.mp4", poses=still)
    result = one_shot([bad, *swipes[1:]], profile="paper")
    assert list(result.unusable) == ["still.mp4"]
    assert "nothing moves" in result.unusable["still.mp4"]
    assert result.other_people.refused.correct == 2  # by each language of the other person


def test_takes_of_none_of_the_gestures_are_asked_for_and_demonstrate_nothing(
    swipes: list[LabelledTake],
) -> None:
    others = [replace(take, label=NONE) for take in swipes if take.label == "up"]
    result = one_shot([*others, *(take for take in swipes if take.label != "up")], profile="full")
    row = result.other_people.labels.index(NONE)
    asked = result.same_person.counts[row].sum() + result.other_people.counts[row].sum()
    assert asked == result.languages * len(others)


def test_one_gesture_alone_cannot_be_confused_with_anything(swipes: list[LabelledTake]) -> None:
    with pytest.raises(OsgError, match="at least two gestures"):
        one_shot([take for take in swipes if take.label == "up"], profile="paper")


def test_single_takes_leave_nothing_to_ask_for(swipes: list[LabelledTake]) -> None:
    firsts = {take.label: take for take in reversed(swipes) if take.person == "person 0"}
    with pytest.raises(OsgError, match="at least two takes"):
        one_shot([*firsts.values()], profile="paper")


def test_a_given_language_is_asked_for_foreign_gestures_too(swipes: list[LabelledTake]) -> None:
    templates = {take.label: take.poses for take in swipes if take.label != "up"}
    gestures = [Gesture.from_demonstration(label, poses) for label, poses in templates.items()]
    matrix = recognize_takes(Language("two", gestures), swipes, profile="full")
    assert matrix.labels == ("left", "right", "up")
    assert matrix.counts.sum(axis=1).tolist() == [4, 4, 4]
    assert matrix.counts[2, 2] == 0
