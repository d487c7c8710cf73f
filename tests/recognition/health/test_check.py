"""The health report: the same for the same file, plain JSON, and right about known languages."""

import json
from dataclasses import replace

import numpy as np
import pytest

from app.recognition import Gesture, Language
from app.recognition.health.check import check_health
from app.recognition.health.report import MOST_CONFUSION, HealthReport
from tests.recognition.demonstrations import pool, shown
from tests.recognition.held_takes import FIST, FLAT, follow, hold
from tests.recognition.strategies import circle, line

HEALTHY = pool(circle=circle, line=line)
CONFUSED = pool(circle=circle, ring=circle, line=line)


CONFUSIONS = {"confused", "duplicate"}


def test_distinct_figures_are_not_confused() -> None:
    report = check_health(HEALTHY, takes=6, person="same")
    assert not CONFUSIONS & {finding.code for finding in report.findings}
    assert [gesture.label for gesture in report.gestures] == ["circle", "line"]
    assert len(report.pairs) == 1
    assert report.places.shape == (2, 2)


@pytest.fixture(scope="module")
def confused() -> HealthReport:
    """Return the report of a language with the same circle twice."""
    return check_health(CONFUSED, takes=4)


def test_two_gestures_that_are_the_same_are_found_with_a_remedy(confused: HealthReport) -> None:
    report = confused
    assert not report.ok
    (finding,) = [each for each in report.findings if each.code == "duplicate"]
    assert finding.gestures == ("circle", "ring")
    assert finding.remedies
    assert finding.remedies[0].after.rate < MOST_CONFUSION
    assert report.pairs[0].gestures == ("circle", "ring")


def test_labels_that_look_alike_are_found_and_are_errors_beyond_ascii() -> None:
    first, second = HEALTHY.gestures
    for one, other, below_bar in (("up1", "upl", False), ("up", "u\u0440", True)):
        gestures = [replace(first, label=one), replace(second, label=other)]
        report = check_health(replace(HEALTHY, gestures=gestures), takes=2)
        (found,) = [each for each in report.findings if each.code == "look_alike"]
        assert (found.gestures, found.below_bar) == ((one, other), below_bar)


def test_a_remedy_that_is_followed_ends_the_confusion() -> None:
    circle_shown, ring, line_shown = CONFUSED.gestures
    mended = replace(CONFUSED, gestures=[circle_shown, ring.mirror(), line_shown])
    report = check_health(mended, takes=6, person="same")
    assert not CONFUSIONS & {finding.code for finding in report.findings}


def test_the_same_file_gives_the_same_report(confused: HealthReport) -> None:
    read_again = Language.from_json(CONFUSED.to_json())
    assert check_health(read_again, takes=4).to_dict() == confused.to_dict()


def test_the_report_is_plain_json(confused: HealthReport) -> None:
    report = confused.to_dict()
    assert json.loads(json.dumps(report, allow_nan=False)) == report
    assert list(report)[:2] == ["language", "revision"]
    assert {"ok", "gestures", "pairs", "warnings", "map"} <= set(report)
    (remedy, *_) = report["warnings"][0]["remedies"]
    assert {"text", "before", "after"} <= set(remedy)
    assert [place["label"] for place in report["map"]] == ["circle", "ring", "line"]


def test_near_gestures_are_near_on_the_map(confused: HealthReport) -> None:
    circle_at, ring_at, line_at = confused.places
    assert np.linalg.norm(circle_at - ring_at) < np.linalg.norm(circle_at - line_at)


def test_each_landmark_a_gesture_depends_on_is_told_with_its_visibility() -> None:
    (landmark,) = check_health(HEALTHY, takes=2, person="same").gestures[0].landmarks
    assert landmark.landmark == "right_wrist"
    assert landmark.visible == 1
    assert landmark.displacement > 0.5


def test_a_gesture_without_demonstration_is_told_and_not_judged() -> None:
    imported = Gesture(
        label="old", salient=("right_wrist",), image=shown("line", line).redraw().image
    ).redraw()
    report = check_health(Language("mixed", [shown("circle", circle), imported]), takes=4)
    assert report.gestures[1].missed is None
    assert "no_demonstration" in {finding.code for finding in report.findings}
    assert report.pairs[0].second_as_first is None


def test_a_language_that_rejects_nothing_is_not_ready() -> None:
    report = check_health(replace(HEALTHY, profile="paper"), takes=2, person="same")
    (finding,) = [each for each in report.findings if each.code == "unrejecting"]
    assert finding.below_bar
    assert "profile paper" in finding.message
    assert not report.ok


def test_a_language_without_gestures_is_not_ready() -> None:
    report = check_health(Language("empty"))
    assert not report.ok
    assert [finding.code for finding in report.findings] == ["empty"]
    assert report.to_dict()["map"] == []


def test_progress_is_told_and_can_cancel() -> None:
    told: list[tuple[str, int, int]] = []
    check_health(HEALTHY, takes=3, person="same", progress=lambda *each: told.append(each))
    assert [each[1:] for each in told if each[0] == "rehearsing"] == [
        (done, 6) for done in range(1, 7)
    ]

    def cancel(stage: str, done: int, total: int) -> None:
        raise InterruptedError(stage)

    with pytest.raises(InterruptedError, match="rehearsing"):
        check_health(HEALTHY, takes=3, progress=cancel)


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
    report = check_health(Language("signs", gestures), takes=4, person="same")
    (error,) = [each for each in report.findings if each.below_bar]
    assert (error.code, error.gestures) == ("duplicate", ("go", "went"))
    assert "are the same sequence of hand shapes" in error.message
    missed = {each.label: each.missed for each in report.gestures}
    assert all(missed[label] is not None for label in shown)
