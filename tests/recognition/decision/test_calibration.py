"""Calibration: thresholds from the demonstration alone, kept with the language."""

from dataclasses import replace

import numpy as np
import pytest

from app.recognition import Gesture, Language, Recognizer
from app.recognition.decision.calibration import CUES, calibrate
from app.recognition.gestures.demonstration import condense
from app.recognition.gestures.switches import Switches
from app.recognition.simulation.variation import draw_variants
from tests.recognition.strategies import SHAPES, circle, recording, wedge


@pytest.fixture(scope="module")
def language() -> Language:
    gestures = [
        Gesture.from_demonstration(name, recording(shape)) for name, shape in SHAPES.items()
    ]
    return Language("pool", gestures).calibrated()


def test_every_gesture_has_thresholds_and_expected_rates(language: Language) -> None:
    for gesture in language.gestures:
        assert set(gesture.thresholds) == set(CUES)
        assert all(value > 0 for value in gesture.thresholds.values())
        assert gesture.rates is not None
        assert 0 < gesture.rates.miss < 0.3
        assert 0 <= gesture.rates.false_alarm < 0.3


def test_other_takes_than_the_thresholds_were_made_of_are_accepted(language: Language) -> None:
    recognizer = Recognizer(language)
    for gesture in language.gestures:
        assert gesture.trajectory is not None
        takes = draw_variants(gesture.trajectory, 20, seed=77)
        labels = [recognizer.recognize_trajectory(condense(take)).label for take in takes]
        assert labels.count(gesture.label) >= 17


def test_calibrating_again_changes_nothing(language: Language) -> None:
    assert language.calibrated() is language
    once, again = (calibrate(language.gestures) for _ in range(2))
    for first, second, kept in zip(once, again, language.gestures, strict=True):
        assert first.thresholds == second.thresholds == kept.thresholds
        assert first.rates == second.rates == kept.rates


def test_thresholds_are_kept_in_the_file(language: Language) -> None:
    text = language.to_json()
    restored = Language.from_json(text)
    assert restored.to_json() == text
    assert restored.calibrated() is restored
    for before, after in zip(language.gestures, restored.gestures, strict=True):
        assert after.thresholds == before.thresholds
        assert after.rates == before.rates


def test_a_file_without_thresholds_is_calibrated_when_a_recogniser_takes_it(
    language: Language,
) -> None:
    bare = [replace(gesture, thresholds={}, rates=None) for gesture in language.gestures]
    old = Language.from_json(Language("pool", bare).to_json())
    assert not any(gesture.thresholds for gesture in old.gestures)
    query = recording(circle, jitter=0.01)
    before, after = (Recognizer(each).recognize(query).novelty for each in (language, old))
    np.testing.assert_array_equal(after, before)


def test_a_changed_language_is_calibrated_anew(language: Language) -> None:
    circle_only = replace(language.gesture("circle"), switches=Switches(direction="on"))
    changed = replace(language, gestures=(circle_only, *language.gestures[1:]))
    assert changed.calibrated() is not changed
    assert language.without("line").calibrated().thresholds_for != language.thresholds_for
    renamed = replace(language.gestures[0], label="round")
    same = replace(language, gestures=(renamed, *language.gestures[1:]))
    assert same.calibrated() is same


def test_thresholds_by_another_rule_are_made_anew(
    language: Language, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.recognition.language.language.RULE", "another")
    assert language.calibrated().thresholds_for != language.thresholds_for


def test_what_is_drawn_with_more_care_reaches_less_far() -> None:
    """The thresholds are the gesture's own: detail varies more than a plain stroke."""

    def scribble(share: np.ndarray) -> np.ndarray:
        return np.asarray(wedge(share) + 0.08 * np.sin(60 * share)[:, None])

    plain, fine = calibrate(
        [
            Gesture.from_demonstration(name, recording(shape))
            for name, shape in (("plain", wedge), ("fine", scribble))
        ]
    )
    assert fine.thresholds["direction"] > plain.thresholds["direction"]


def test_a_gesture_without_demonstration_gets_no_thresholds() -> None:
    drawn = Gesture.from_demonstration("circle", recording(circle))
    imported = Gesture(label="drawn", salient=drawn.salient, image=drawn.image)
    shown, bare = calibrate([drawn, imported])
    assert shown.thresholds
    assert not bare.thresholds
    assert bare.rates is None


def test_landmarks_of_other_bodies_have_thresholds_but_no_false_alarm_to_expect() -> None:
    poses = recording(circle).select(["right_wrist"])
    marker = replace(poses, landmarks=("hand_marker",))
    (gesture,) = calibrate([Gesture.from_demonstration("circle", marker)])
    assert gesture.thresholds
    assert gesture.rates is None
