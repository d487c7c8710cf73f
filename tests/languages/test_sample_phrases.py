"""The phrases of the sample language: what the user guide shows is what they do."""

import pytest

from app.recognition.health.phrase_ambiguity import find_ambiguities
from app.recognition.phrases.parser import PhraseParser
from languages.build import PHRASES


def test_they_are_not_ambiguous() -> None:
    assert find_ambiguities(PHRASES) == ()


@pytest.mark.parametrize(
    ("shown", "spoken", "command"),
    [
        ("circle sweep circle", "come here", {"do": "come_here"}),
        ("circle triangle circle", "go to waypoint 1", {"do": "go_to_waypoint", "waypoint": 1}),
        ("circle square three circle", "align yourself, 3 times", {"do": "align", "times": 3}),
        (
            "circle square infinity circle",
            "align yourself until told otherwise",
            {"do": "align", "until": "until told otherwise"},
        ),
        (
            "circle wedge three square three circle",
            "survey 3 metres ahead, then turn 3 times",
            {"do": "survey", "metres": 3, "turns": 3},
        ),
    ],
)
def test_a_message_is_obeyed(shown: str, spoken: str, command: dict[str, object]) -> None:
    parser = PhraseParser(PHRASES)
    (*_, last) = [event for label in shown.split() for event in parser.feed(label, 0, 0)]
    assert last.mission is not None
    assert last.mission.spoken == f"mission: {spoken}"
    assert [each.command for each in last.mission.phrases] == [command]


def test_stop_cancels() -> None:
    parser = PhraseParser(PHRASES)
    events = [event for label in ("circle", "sweep", "line") for event in parser.feed(label, 0, 0)]
    assert events[-1].kind == "cancelled"
