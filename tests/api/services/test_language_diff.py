"""Language diff: the differences of two languages, in words."""

from dataclasses import replace

import pytest

from app.api.services.language_diff import compare_gestures, describe_changes
from app.recognition import Gesture, Language
from app.recognition.gestures.profile import Tuning
from app.recognition.gestures.switches import Switches
from tests.api.recordings import recording_of


@pytest.fixture(scope="module")
def circle() -> Gesture:
    return Gesture.from_demonstration("circle", recording_of("circle").poses)


@pytest.fixture(scope="module")
def line() -> Gesture:
    return Gesture.from_demonstration("line", recording_of("line").poses)


def words(before: Gesture, after: Gesture) -> tuple[str, ...]:
    (change,) = compare_gestures(Language("pool", [before]), Language("pool", [after]))
    return change.words


def test_a_language_compared_with_itself_has_changed_in_nothing(
    circle: Gesture, line: Gesture
) -> None:
    language = Language("pool", [circle, line])
    assert {change.kind for change in compare_gestures(language, language)} == {"same"}
    assert describe_changes(language, language) == []


def test_every_edit_of_a_gesture_has_its_words(circle: Gesture, line: Gesture) -> None:
    assert words(circle, replace(circle, command={"go": 1})) == (
        'command was empty, is “{"go": 1}”',
    )
    assert words(circle, replace(circle, switches=Switches(tempo="on"))) == (
        "switch for tempo was “auto”, is “on”",
    )
    followed = circle.with_salient(["left_wrist", *circle.salient])
    assert words(circle, followed) == ("left wrist is followed now",)
    assert words(followed, circle) == ("left wrist is not followed any more",)
    assert words(circle, replace(line, label="circle"))[-1].startswith("another demonstration")
    assert words(circle, replace(circle, trajectory=None))[-1] == "another demonstration"
    assert words(circle, circle.redraw(simplification=0.2)) == (
        "drawn anew from the same demonstration",
    )


def test_demonstrations_that_come_and_go_are_counted(circle: Gesture, line: Gesture) -> None:
    takes = [recording_of(shape).poses for shape in ("line", "circle backwards")]
    one = circle.with_demonstration(takes[0], "Ben")
    both = one.with_demonstration(takes[1], "Ben")
    assert words(circle, one) == ("1 demonstration added, by “Ben”",)
    assert words(circle, both) == ("2 demonstrations added, by “Ben”",)
    assert words(both, one) == ("1 demonstration removed, by “Ben”",)
    assert words(both, both) == ()
    assert words(one, one.without_demonstration(0)) == (
        "diver was empty, is “Ben”",
        "1 demonstration removed",
    )
    assert words(both, both.redraw(simplification=0.2)) == (
        "drawn anew from the same demonstration",
    )


def test_a_long_text_is_quoted_in_short(circle: Gesture) -> None:
    (told,) = words(circle, replace(circle, description="wide " * 100))
    assert len(told) < 120
    assert told.endswith("…”")


def test_another_order_is_said(circle: Gesture, line: Gesture) -> None:
    older, newer = Language("pool", [circle, line]), Language("pool", [line, circle])
    assert describe_changes(older, newer) == ["the gestures are in another order"]
    assert {change.kind for change in compare_gestures(older, newer)} == {"same"}


def test_how_it_is_recognised_is_compared_in_words(circle: Gesture) -> None:
    language = Language("pool", [circle])
    tuned = replace(language, profile="paper", tuning=Tuning(weights={"hu": 0.0}))
    assert describe_changes(language, tuned) == [
        "profile was “full”, is “paper”",
        "was recognised as the profile does, is without the comparison hu",
    ]


def test_another_share_of_refused_takes_is_said(circle: Gesture) -> None:
    language = Language("pool", [circle])
    assert describe_changes(language, replace(language, most_refused=0.1)) == [
        "at most 5 % of right takes were refused, at most 10 % are"
    ]
