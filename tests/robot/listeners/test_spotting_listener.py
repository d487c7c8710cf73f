"""Spotting listener: frame by frame it emits what the spotter finds in the recording."""

from __future__ import annotations

from collections.abc import Sequence

from app.recognition.spotting import Spotter
from app.robot import Event, LanguageChanged, SpottingListener, StateChanged, TakeRecognized
from tests.api.recordings import recording_of
from tests.robot.languages import moments_of, run_listener, spoken


def recognitions_in(events: Sequence[Event]) -> list[tuple[str, float, float, int]]:
    return [
        (event.label, event.start, event.end, event.revision)
        for event in events
        if isinstance(event, TakeRecognized)
    ]


def test_gestures_are_told_as_the_spotter_finds_them() -> None:
    language = spoken("circle", "line")
    recording = recording_of("circle", "line")
    listener = SpottingListener(language)
    emitted = [*run_listener(listener, recording), *listener.finish()]
    found = Spotter(language.recognizer).listen(recording.poses)
    assert found
    assert recognitions_in(emitted) == [
        (each.recognition.label, each.start, each.end, language.revision) for each in found
    ]
    assert isinstance(emitted[0], StateChanged)
    assert not any(isinstance(event, LanguageChanged) for event in emitted)


def test_a_gesture_that_goes_on_is_heard_in_the_next_language() -> None:
    recording = recording_of("circle", "line")
    (circle, *_) = Spotter(spoken("circle", "line").recognizer).listen(recording.poses)
    assert circle.recognition.label == "circle"
    listener = SpottingListener(spoken("line"))
    emitted: list[Event] = []
    halfway = (circle.start + circle.end) / 2
    for moment, salute in moments_of(recording):
        if moment.time[0] > halfway and listener.language.revision == 1:
            listener.set_language(spoken("circle", "line", revision=2))
        emitted += listener.feed(moment, salute)
    assert recognitions_in([*emitted, *listener.finish()])[0] == (
        "circle",
        circle.start,
        circle.end,
        2,
    )


def test_a_gesture_of_the_past_does_not_come_out_in_the_next_language() -> None:
    recording = recording_of("circle")
    listener = SpottingListener(spoken("line"))
    run_listener(listener, recording)
    listener.set_language(spoken("circle", "line", revision=2))
    assert recognitions_in(list(listener.finish())) == []


def test_what_is_abandoned_is_forgotten() -> None:
    listener = SpottingListener(spoken("circle", "line"))
    for moment, salute in moments_of(recording_of("circle"))[:20]:
        listener.feed(moment, salute)
    assert len(listener) > 0
    assert listener.abandon(2.0, "the source was lost") == ()
    assert len(listener) == 0
