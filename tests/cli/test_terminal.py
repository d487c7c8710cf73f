"""What a person reads on the terminal."""

from io import StringIO

import pytest
from rich.console import Console

from app.cli import terminal
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
    for found in explanation.counterfactuals:
        assert found.change.words.split()[-1] in read


def test_a_path_is_written_as_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    written = StringIO()
    monkeypatch.setattr(terminal, "people", Console(file=written, width=40))
    line = "dives/[red] team/a long name of a clip of the morning.mp4: no gesture"
    terminal.tell(line)
    assert written.getvalue() == f"{line}\n"


def test_a_batch_shows_its_clips_bar_beside_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    written = StringIO()
    console = Console(file=written, force_terminal=True, width=100)
    monkeypatch.setattr(terminal, "people", console)
    with terminal.batch_bar(2, 1000) as advance:
        with terminal.progress_bar("dive.mp4") as frames:
            frames(5, 10)
        advance(400, "dive.mp4: circle")
        with terminal.progress_bar("again.mp4"):
            pass
        advance(600, "again.mp4: line")
    text = written.getvalue()
    assert "1/2 dive.mp4: circle" in text
    assert "2 of 2 clips" in text
    assert "0:00:00" in text
