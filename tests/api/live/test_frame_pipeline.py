"""The frame pipeline of a live view, with languages of other triggers than the salute."""

from __future__ import annotations

from contextlib import closing
from dataclasses import replace
from pathlib import Path

import pytest

from app.api.live.frame_pipeline import Frame, FramePipeline, Recognized, Seen, answer_of
from app.recognition import OsgError, Recognizer, takes_in
from app.recognition.estimation.factory import NO_HANDS, create_estimator
from app.recognition.triggers.trigger import NO_TRIGGER, Trigger
from tests.api.live.test_socket import frames_of
from tests.api.recordings import recording_of
from tests.posed import BY_BELLY, posed_clip, posed_language
from tests.robot.languages import ambiguous

pytestmark = [pytest.mark.usefixtures("installed_models"), pytest.mark.slow]


def watch(recognizer: Recognizer, clip: Path) -> list[Seen | Recognized]:
    with closing(
        FramePipeline(create_estimator(hands=NO_HANDS), "auto", lambda: recognizer)
    ) as pipeline:
        return [
            answer
            for time, jpeg in frames_of(clip)
            for answer in pipeline.look(Frame(time, jpeg, arrived=0.0))
        ]


@pytest.mark.parametrize(
    ("trigger", "name"), [(BY_BELLY, "circle-by-belly-2"), (NO_TRIGGER, "circle-by-belly")]
)
def test_a_gesture_is_recognised_where_no_hand_is_seen(trigger: Trigger, name: str) -> None:
    recognizer = Recognizer(replace(posed_language(), trigger=trigger))
    answers = watch(recognizer, posed_clip(name))
    found = [each for each in answers if isinstance(each, Recognized)]
    assert "circle" in [each.label for each in found]
    assert all(each.closed and each.language == "posed" for each in found)
    seen = [each for each in answers if isinstance(each, Seen)]
    assert any(each.held for each in seen) == (trigger == BY_BELLY)


def test_a_take_between_two_gestures_is_answered_with_both() -> None:
    (take,) = takes_in(recording_of("circle"))
    answer = answer_of(take, ambiguous().recognizer)
    assert (answer.label, answer.problem) == (None, None)
    assert set(answer.pair or ()) == {"circle", "ring"}


def test_a_language_that_is_gone_leaves_the_salute() -> None:
    def refuse() -> Recognizer:
        raise OsgError("there is no such language")

    frame = next(frames_of(posed_clip("circle-by-belly")))
    with closing(FramePipeline(create_estimator(hands=NO_HANDS), "auto", refuse)) as pipeline:
        (seen,) = pipeline.look(Frame(*frame, arrived=0.0))
    assert isinstance(seen, Seen)
    assert not seen.held
