"""The forecast: each person's demonstrations are read by those of the others alone."""

import json
from dataclasses import replace

import pytest

from app.recognition import Gesture, Language, Recognizer
from app.recognition.gestures.demonstration import condense
from app.recognition.health.check import check_health, find_forecast_findings
from app.recognition.health.finding import Rate
from app.recognition.health.forecast import (
    LEAST_GAIN,
    OUTCOMES,
    CurvePoint,
    Forecast,
    Reading,
    judge,
    make_forecast,
    measure_curve,
)
from tests.recognition.demonstrations import pool, shown_by, with_wrong_take
from tests.recognition.held_takes import FIST, FLAT, hold
from tests.recognition.strategies import SHAPES, circle, line, recording

DIVERS = ("Ann", "Bo", "Cy")


def test_one_person_foretells_nothing_and_two_more_are_asked_for() -> None:
    forecast = make_forecast(pool(circle=circle, line=line))
    assert (forecast.people, forecast.readings) == (1, ())
    assert forecast.count("right") is None
    assert forecast.words.startswith("One person has shown this language")
    assert forecast.words.endswith("Ask two more people to show it, and name the divers.")
    assert forecast.to_dict()["right"] is None


def test_divers_without_a_name_count_as_one_person() -> None:
    language = shown_by(("", "", ""))
    assert (make_forecast(language).people, make_forecast(language).readings) == (1, ())
    assert make_forecast(shown_by(("", "Bo"))).people == 2


def test_every_demonstration_is_read_as_a_language_of_the_other_people_reads_it() -> None:
    language = shown_by(DIVERS)
    forecast = make_forecast(language)
    assert [(each.gesture, each.diver) for each in forecast.readings] == [
        (label, diver) for label in language.labels for diver in DIVERS
    ]
    for number, diver in enumerate(DIVERS):
        others = [gesture.without_demonstration(number) for gesture in language.gestures]
        recognizer = Recognizer(Language("others", others), "full")
        for gesture in language.gestures:
            shown = gesture.trajectories[number]
            result = recognizer.recognize_trajectory(condense(shown))
            (reading,) = [
                each
                for each in forecast.readings
                if (each.gesture, each.diver) == (gesture.label, diver)
            ]
            assert (reading.outcome, reading.read_as) == judge(result, gesture.label)


def test_outcomes_of_a_gesture_and_of_the_language_add_up() -> None:
    forecast = make_forecast(with_wrong_take())
    for label in (None, "circle", "wedge"):
        counts = [forecast.count(outcome, label) for outcome in OUTCOMES]
        known = [each for each in counts if each is not None]
        assert len(known) == len(OUTCOMES)
        assert sum(each.happened for each in known) == known[0].n
        assert known[0].n == (12 if label is None else 3)
    assert forecast.count("right", "unknown") is None


def test_a_demonstration_of_something_else_is_named_with_its_diver_and_what_it_is_read_as() -> None:
    report = check_health(with_wrong_take())
    (reading,) = [each for each in report.forecast.failed("circle") if each.diver == "Cy"]
    assert (reading.demonstration, reading.outcome, reading.read_as) == (2, "wrong", ("wedge",))
    (finding,) = [
        each
        for each in report.findings
        if each.kind == "misread" and each.gestures == ("circle", "wedge")
    ]
    assert finding.error
    assert "Cy's is read as wedge" in finding.message


def test_a_gesture_that_one_person_alone_has_shown_is_not_read_but_may_be_taken_for() -> None:
    language = shown_by(DIVERS)
    ring = Gesture.from_demonstration("ring", recording(circle, frames=70), diver="Ann")
    forecast = make_forecast(replace(language, gestures=[*language.gestures, ring]))
    assert forecast.count("right", "ring") is None
    right = forecast.count("right", "circle")
    assert right is not None
    assert right.rate < 1
    assert any("ring" in each.read_as for each in forecast.failed("circle"))


def test_two_people_are_measured_and_said_to_be_few() -> None:
    two, three = (make_forecast(shown_by(DIVERS[:count])) for count in (2, 3))
    assert len(two.readings) == 8
    assert two.words.endswith("Two people are few: ask a third.")
    assert "few" not in three.words


def test_people_who_show_other_gestures_foretell_nothing() -> None:
    circles, lines = (
        Gesture.from_demonstration(name, recording(shape), diver=diver)
        for name, shape, diver in (("circle", circle, "Ann"), ("line", line, "Bo"))
    )
    forecast = make_forecast(Language("apart", [circles, lines]))
    assert (forecast.people, forecast.readings) == (2, ())
    assert forecast.words.startswith("No gesture is shown by two people")


def test_held_hand_shapes_of_two_people_are_read_by_each_other() -> None:
    gestures = [
        Gesture.from_demonstration(name, hold(shape, seed=1), diver="Ann").with_demonstration(
            hold(shape, seed=2), "Bo"
        )
        for name, shape in (("fist", FIST), ("flat", FLAT))
    ]
    forecast = make_forecast(Language("signs", gestures))
    assert [each.outcome for each in forecast.readings] == ["right"] * 4


@pytest.mark.parametrize(
    ("outcome", "read_as", "words"),
    [
        ("wrong", ("line",), "Bo's is read as line"),
        ("asked", ("circle", "line"), "Bo's is asked back as circle or line"),
        ("refused", ("line",), "Bo's is refused (nearest line)"),
        ("refused", (), "Bo's is refused"),
    ],
)
def test_what_became_of_a_demonstration_is_told(
    outcome: str, read_as: tuple[str, ...], words: str
) -> None:
    reading = Reading("circle", 1, "Bo", outcome, read_as)  # type: ignore[arg-type]
    assert reading.words == words
    assert replace(reading, diver="").words == words.replace("Bo's", "number 2")


def test_a_gesture_that_others_never_read_is_an_error_and_one_refusal_of_three_a_note() -> None:
    def kinds(*outcomes: str) -> list[tuple[str, bool]]:
        readings = tuple(
            Reading("circle", at, diver, outcome, ("line",))  # type: ignore[arg-type]
            for at, (diver, outcome) in enumerate(zip(DIVERS, outcomes, strict=True))
        )
        found = find_forecast_findings(pool(circle=circle, line=line), Forecast(3, readings))
        return [(each.kind, each.error) for each in found]

    assert kinds("right", "right", "right") == []
    assert kinds("right", "right", "refused") == [("missed", False)]
    assert kinds("refused", "asked", "right") == [("missed", True)]
    assert kinds("right", "right", "wrong") == [("misread", True)]


def test_the_forecast_is_plain_json_and_the_same_each_time() -> None:
    once, again = (make_forecast(with_wrong_take()).to_dict() for _ in range(2))
    assert once == again == json.loads(json.dumps(once, allow_nan=False))
    assert once["people"] == 3
    assert once["right"]["n"] == 12
    assert {"gesture", "demonstration", "diver", "outcome", "read_as"} == set(once["failed"][0])


def test_readings_are_counted_while_they_are_made_and_can_be_ended() -> None:
    told = 0

    def advance() -> None:
        nonlocal told
        told += 1
        if told == 5:
            raise InterruptedError

    with pytest.raises(InterruptedError):
        make_forecast(shown_by(DIVERS), advance=advance)


EIGHT = ("Ann", "Bo", "Cy", "Di", "Ed", "Flo", "Gus", "Hal")


def curve_of(language: Language) -> tuple[CurvePoint, ...]:
    return measure_curve(language, make_forecast(language))


def test_the_curve_ends_with_the_forecast_and_begins_with_one_person() -> None:
    language = with_wrong_take()
    forecast = make_forecast(language)
    first, last = measure_curve(language, forecast)
    assert (first.people, last.people) == (1, 2)
    assert last.right == forecast.count("right")
    # Each person's demonstrations are read by one other person's, the next by name.
    reader = {"Ann": "Bo", "Bo": "Cy", "Cy": "Ann"}
    right = 0
    for diver, other in reader.items():
        shown = {
            gesture.label: {each.diver: each for each in gesture.single_demonstrations()}
            for gesture in language.gestures
        }
        recognizer = Recognizer(Language("one", [row[other] for row in shown.values()]), "full")
        for label, row in shown.items():
            trajectory = row[diver].trajectory
            assert trajectory is not None
            outcome, _ = judge(recognizer.recognize_trajectory(condense(trajectory)), label)
            right += outcome == "right"
    assert first.right == Rate(right, 12)


def test_one_person_has_no_curve_and_two_have_one_point() -> None:
    assert curve_of(shown_by(DIVERS[:1])) == ()
    (only,) = curve_of(shown_by(DIVERS[:2]))
    assert (only.people, only.right.n) == (1, 8)


@pytest.mark.parametrize(
    ("people", "happened", "asks"),
    [
        (1, (), True),
        (2, (20,), True),
        (3, (20, 24), True),  # 0.64 to 0.86
        (3, (24, 24), False),
        (3, (24, 20), False),
        (4, (18, 24, 24), False),
        (8, (12, 13, 14, 15, 16, 17, 24), False),
    ],
)
def test_another_person_is_asked_for_until_the_last_one_raised_the_lower_end_no_more(
    people: int, happened: tuple[int, ...], asks: bool
) -> None:
    points = tuple(CurvePoint(1 + at, Rate(right, 24)) for at, right in enumerate(happened))
    assert Forecast(people, curve=points).asks_more is asks


def test_the_words_of_three_people_say_whether_to_ask_one_more() -> None:
    readings = make_forecast(shown_by(DIVERS)).readings

    def words(*happened: int) -> str:
        points = tuple(CurvePoint(1 + at, Rate(right, 24)) for at, right in enumerate(happened))
        return Forecast(3, readings, points).words

    assert words(20, 24).endswith("by two points or more: ask one more.")
    assert words(24, 24).endswith("by less than two points: more people would help little.")


def test_a_gain_below_two_points_is_none() -> None:
    def asks(last: int) -> bool:
        points = (CurvePoint(1, Rate(700, 1000)), CurvePoint(2, Rate(last, 1000)))
        return Forecast(3, curve=points).asks_more

    gains = {
        last: Rate(last, 1000).interval[0] - Rate(700, 1000).interval[0] for last in (718, 722)
    }
    assert gains[718] < LEAST_GAIN < gains[722]
    assert (asks(718), asks(722)) == (False, True)


def test_the_report_of_eight_people_has_a_curve_and_asks_for_no_more() -> None:
    content = check_health(shown_by(EIGHT, {"circle": SHAPES["circle"], "line": line})).forecast
    assert [point.people for point in content.curve] == [1, 2, 3, 4, 5, 6, 7]
    written = content.to_dict()
    assert written["asks_more"] is False
    assert written["curve"][-1] == {"people": 7, **written["right"]}
