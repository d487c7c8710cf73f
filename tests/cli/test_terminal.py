"""What a person reads on the terminal."""

import pytest

from app.cli.terminal import show_explanation
from app.recognition import Gesture, Language, Recognizer
from app.recognition.explanation.context import RecognitionContext
from app.recognition.explanation.explanation import explain
from tests.recognition.strategies import SHAPES, recording


def test_an_explanation_is_a_sentence_and_what_would_help(
    capsys: pytest.CaptureFixture[str],
) -> None:
    gestures = [
        Gesture.from_demonstration(name, recording(SHAPES[name])) for name in ("circle", "line")
    ]
    query = recording(SHAPES["wedge"])
    recognizer = Recognizer(Language("pool", gestures), "paper")
    taken = recognizer.recognize(query).nearest
    (expected,) = {"circle", "line"} - {taken}
    explanation = explain(
        RecognitionContext(recognizer=recognizer, poses=query, whole=query), expected
    )
    show_explanation(explanation)
    shown = capsys.readouterr()
    assert shown.out == ""
    read = " ".join(shown.err.split())
    assert explanation.sentence in read
    for found in explanation.counterfactuals.found:
        assert found.change.words.split()[-1] in read
