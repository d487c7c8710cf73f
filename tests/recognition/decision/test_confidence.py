"""Confidence: how probable it is that the label is right."""

import numpy as np

from app.recognition.decision.outcome import SURE, bound_confidence, estimate_confidence


def test_confidence_falls_with_novelty_and_with_a_second_gesture_near() -> None:
    alone = [estimate_confidence(far, far, np.inf) for far in (0.0, 0.1, 0.3, 1.0, 5.0)]
    assert alone == sorted(alone, reverse=True)
    assert alone[0] > 0.99
    assert alone[-1] < 0.01
    beside = [estimate_confidence(0.3, 0.1, second) for second in (0.1, 0.3, 1.0)]
    assert beside == sorted(beside)
    assert 0.0 <= estimate_confidence(1e300, 1e300, 1e300) < 1e-9


def test_a_take_between_gestures_is_less_sure_than_any_answer_however_near_they_are() -> None:
    near = estimate_confidence(0.0, 0.0, 0.0)
    assert bound_confidence(near, 2, novelty=0.0) == SURE
    assert bound_confidence(near, 0, novelty=0.0) == SURE
    assert bound_confidence(0.01, 1, novelty=0.9) == SURE
    assert bound_confidence(0.4, 0, novelty=1.1) == 0.4


def test_a_gesture_without_thresholds_is_judged_by_its_score() -> None:
    near, far = (estimate_confidence(np.nan, score, np.inf) for score in (0.1, 2.0))
    assert 0.0 < far < near < 1.0
