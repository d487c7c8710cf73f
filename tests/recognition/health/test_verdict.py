"""The verdict: errors, failing gestures and untested gestures, in one sentence."""

from __future__ import annotations

import pytest

from app.recognition.health.finding import TestedGesture, Verdict

LABELS = ("circle", "square", "line")


def read_of(**takes: tuple[int, int]) -> list[TestedGesture]:
    return [TestedGesture(label, *counts) for label, counts in takes.items()]


@pytest.mark.parametrize(
    ("errors", "takes", "words", "ready"),
    [
        (0, {}, "no errors, no gesture tested", False),
        (2, {}, "2 errors, no gesture tested", False),
        (0, {"circle": (1, 1)}, "no errors, 2 gestures untested", False),
        (
            0,
            {"circle": (1, 1), "line": (0, 0), "square": (3, 4)},
            "no errors, line untested",
            False,
        ),
        (0, {"circle": (1, 2), "line": (2, 2), "square": (0, 1)}, "square 0 of 1", False),
        (1, {"circle": (0, 1), "line": (1, 1), "square": (1, 1)}, "1 error, circle 0 of 1", False),
        (0, {"circle": (1, 2), "line": (2, 2), "square": (1, 1)}, "no errors", True),
    ],
)
def test_a_language_is_ready_without_errors_and_with_every_gesture_tested(
    errors: int, takes: dict[str, tuple[int, int]], words: str, ready: bool
) -> None:
    verdict = Verdict.of(errors, LABELS, read_of(**takes))
    assert (verdict.words, verdict.is_ready) == (words, ready)
    assert verdict.to_dict()["ready"] is ready


def test_a_gesture_that_the_language_lacks_does_not_count() -> None:
    verdict = Verdict.of(0, ("circle",), read_of(triangle=(0, 3), circle=(2, 2)))
    assert verdict.is_ready
