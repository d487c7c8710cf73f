"""The health report: the same for the same file, plain JSON, and right about known languages."""

import json
from dataclasses import replace

import numpy as np
import pytest

from app.recognition import Gesture, Language
from app.recognition.health.check import check_health
from app.recognition.health.finding import DUPLICATE
from app.recognition.health.report import HealthReport
from tests.recognition.demonstrations import ARMS, pool, shown, shown_by
from tests.recognition.held_takes import FIST, FLAT, follow, hold
from tests.recognition.strategies import circle, line, recording

HEALTHY = pool(circle=circle, line=line)
CONFUSED = pool(circle=circle, ring=circle, line=line)


def test_distinct_figures_are_no_duplicates_and_each_has_its_nearest() -> None:
    report = check_health(HEALTHY)
    assert "duplicate" not in {finding.kind for finding in report.findings}
    assert [gesture.label for gesture in report.gestures] == ["circle", "line"]
    assert report.places.shape == (2, 2)
    first, second = (gesture.nearest for gesture in report.gestures)
    assert first is not None
    assert second is not None
    assert (first[0], second[0]) == ("line", "circle")
    assert min(first[1], second[1]) > DUPLICATE


@pytest.fixture(scope="module")
def confused() -> HealthReport:
    """Return the report of a language with the same circle twice."""
    return check_health(CONFUSED)


def test_two_gestures_that_are_the_same_are_an_error(confused: HealthReport) -> None:
    assert not confused.ok
    (finding,) = [each for each in confused.findings if each.kind == "duplicate"]
    assert finding.gestures == ("circle", "ring")
    assert finding.error
    assert "the same movement" in finding.message


def test_of_many_duplicates_a_hundred_are_named_and_the_others_counted() -> None:
    many = [replace(HEALTHY.gestures[0], label=f"circle {at}") for at in range(16)]
    found = [
        each.message
        for each in check_health(Language("many", many)).findings
        if each.kind == "duplicate"
    ]
    assert len(found) == 101
    assert "20 further pairs are the same as well" in found


def test_labels_that_look_alike_are_found_and_are_errors_beyond_ascii() -> None:
    first, second = HEALTHY.gestures
    for one, other, error in (("up1", "upl", False), ("up", "u\u0440", True)):
        gestures = [replace(first, label=one), replace(second, label=other)]
        report = check_health(replace(HEALTHY, gestures=gestures))
        (found,) = [each for each in report.findings if each.kind == "look_alike"]
        assert (found.gestures, found.error) == ((one, other), error)


def test_a_gesture_with_the_other_hand_is_no_duplicate() -> None:
    circle_shown, ring, line_shown = CONFUSED.gestures
    mended = replace(CONFUSED, gestures=[circle_shown, ring.mirror(), line_shown])
    assert "duplicate" not in {finding.kind for finding in check_health(mended).findings}


def test_what_counts_beside_the_figure_is_told() -> None:
    back = Gesture.from_demonstration(
        "back", recording(lambda share: line(1 - share), landmarks=ARMS)
    )
    report = check_health(replace(HEALTHY, gestures=[*HEALTHY.gestures, back]))
    direction = {each.label: each.counts and each.counts.direction for each in report.gestures}
    assert direction == {"circle": False, "line": True, "back": True}
    assert report.to_dict()["gestures"][1]["counts"]["direction"] is True


def test_the_same_file_gives_the_same_report(confused: HealthReport) -> None:
    read_again = Language.from_json(CONFUSED.to_json())
    assert check_health(read_again).to_dict() == confused.to_dict()


def test_the_report_is_plain_json(confused: HealthReport) -> None:
    report = confused.to_dict()
    assert json.loads(json.dumps(report, allow_nan=False)) == report
    assert list(report)[:2] == ["language", "revision"]
    assert {"ok", "forecast", "gestures", "warnings", "map"} <= set(report)
    assert {"kind", "gestures", "message", "error", "drawings"} == set(report["warnings"][0])
    assert report["gestures"][0]["nearest"]["label"] == "ring"
    assert report["gestures"][0]["right"] is None
    assert [place["label"] for place in report["map"]] == ["circle", "ring", "line"]


def test_near_gestures_are_near_on_the_map(confused: HealthReport) -> None:
    circle_at, ring_at, line_at = confused.places
    assert np.linalg.norm(circle_at - ring_at) < np.linalg.norm(circle_at - line_at)


def test_each_landmark_a_gesture_depends_on_is_told_with_its_visibility() -> None:
    (landmark,) = check_health(HEALTHY).gestures[0].landmarks
    assert landmark.landmark == "right_wrist"
    assert landmark.visible == 1
    assert landmark.displacement > 0.5


def test_a_gesture_without_demonstration_is_told_and_not_judged() -> None:
    imported = Gesture(
        label="old", salient=("right_wrist",), image=shown("line", line).redraw().image
    ).redraw()
    report = check_health(Language("mixed", [shown("circle", circle), imported]))
    assert report.gestures[1].nearest is None
    assert report.gestures[1].counts is None
    assert "no_demonstration" in {finding.kind for finding in report.findings}


def test_a_language_that_rejects_nothing_is_not_ready() -> None:
    report = check_health(replace(HEALTHY, profile="paper"))
    (finding,) = [each for each in report.findings if each.kind == "unrejecting"]
    assert finding.error
    assert "profile paper" in finding.message
    assert not report.ok


def test_a_language_without_gestures_is_not_ready() -> None:
    report = check_health(Language("empty"))
    assert not report.ok
    assert [finding.kind for finding in report.findings] == ["empty"]
    assert report.to_dict()["map"] == []


def test_progress_is_told_and_can_cancel() -> None:
    told: list[tuple[str, int, int]] = []
    check_health(shown_by(("Ann", "Bo")), progress=lambda *each: told.append(each))
    stage = "other people's demonstrations"
    assert [each[1:] for each in told if each[0] == stage] == [(done, 8) for done in range(1, 9)]
    assert [each[1:] for each in told if each[0] == "distances"] == [
        (done, 4) for done in range(1, 5)
    ]

    def cancel(stage: str, done: int, total: int) -> None:
        raise InterruptedError(stage)

    with pytest.raises(InterruptedError, match="distances"):
        check_health(HEALTHY, progress=cancel)


def test_sequences_of_hand_shapes_are_confused_with_their_like_alone() -> None:
    shown = {
        "go": (FLAT, FIST),
        "went": (FLAT, FIST),
        "back": (FIST, FLAT),
        "flat": (FLAT,),
        "fist": (FIST,),
    }
    gestures = [
        Gesture.from_demonstration(label, follow(*(hold(shape, seed=seed) for shape in shapes)))
        for seed, (label, shapes) in enumerate(shown.items())
    ]
    report = check_health(Language("signs", gestures))
    (error,) = [each for each in report.findings if each.error]
    assert (error.kind, error.gestures) == ("duplicate", ("go", "went"))
    assert "are the same sequence of hand shapes" in error.message
