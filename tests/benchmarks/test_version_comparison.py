"""Version comparison: two versions' answers to the same takes."""

from app.recognition import Recognizer
from benchmarks.version_comparison import answer, differences
from tests.recognition.demonstrations import pool
from tests.recognition.strategies import circle, line, recording


def test_an_answer_is_the_recognition_or_why_a_take_cannot_be_compared() -> None:
    recognizer = Recognizer(pool(circle=circle, line=line))
    assert answer(recognizer, recording(circle, jitter=0.01))["label"] == "circle"
    refused = answer(recognizer, recording(circle, hand="left_wrist"))
    assert "nothing to compare" in refused["refused"]


def test_only_what_differs_by_more_than_rounding_is_a_difference() -> None:
    one = {"label": "circle", "distances": [0.5, 1.0]}
    assert not list(differences(one, {"label": "circle", "distances": [0.5, 1.0 + 1e-12]}))
    assert list(differences(one, {"label": "circle", "distances": [0.5, 1.1]}))
    assert list(differences(one, {"label": "line", "distances": [0.5, 1.0]}))
