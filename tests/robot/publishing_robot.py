"""A robot without ROS 2 that says the same again and again; the process of its own in a test.

``python -m tests.robot.publishing_robot``
"""

from __future__ import annotations

import time
from contextlib import closing
from dataclasses import replace

from app.recognition.phrases.grammar import Grammar
from app.recognition.phrases.phrase import OneOf, Phrase
from app.robot import (
    ActiveLanguage,
    AnswerGiven,
    Event,
    PhraseListener,
    TakeRejected,
    TriggerListener,
)
from app.robot.commands.replies import Reply
from app.robot.publishing.publisher import open_publisher
from app.robot.runtime import build_language_changed
from tests.api.recordings import recording_of
from tests.robot.languages import ambiguous, language_of, run_listener

PAUSE = 0.2
"""Seconds between two rounds: a subscriber may join at any time."""

LATER = 60.0
"""Seconds of the take between two gestures after the others."""

PHOTO = Phrase("photo", (OneOf(("circle",)),), {"do": "photo"}, "take a photo")


def list_round_events() -> list[Event]:
    """Return the events of a round: a phrase, an unknown gesture, one between two, its answer."""
    made = replace(language_of("circle"), grammar=Grammar((PHOTO,)))
    language = ActiveLanguage.from_json(made.to_json())
    shown = recording_of("circle", "line")
    between = run_listener(TriggerListener(ambiguous()), recording_of("circle"))
    return [
        build_language_changed(0.0, language),
        *run_listener(PhraseListener(TriggerListener(language)), shown),
        *(
            replace(event, start=event.start + LATER, end=event.end + LATER)
            for event in between
            if isinstance(event, TakeRejected)
        ),
        AnswerGiven(LATER, Reply.one_of_two, 3, "circle or line? show it again"),
    ]


def main() -> None:
    """Publish until the process is ended."""
    events = list_round_events()
    with closing(open_publisher("dds")) as publisher:
        while True:
            for event in events:
                publisher.publish(event)
            time.sleep(PAUSE)


if __name__ == "__main__":
    main()
