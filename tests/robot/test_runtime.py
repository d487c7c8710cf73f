"""The runtime: real frames in, through the real models, and events out."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from functools import partial
from itertools import pairwise
from pathlib import Path

import pytest

from app.recognition import RecognitionError, record, takes_in
from app.recognition.errors import LanguageError
from app.recognition.estimation import PoseEstimator, create_estimator
from app.recognition.takes import TakeState
from app.robot import (
    Event,
    LanguageChanged,
    LanguageRefused,
    Listener,
    Runtime,
    SourceEnded,
    SourceLost,
    SourceOpened,
    SourceRestored,
    SpokenLanguage,
    StateChanged,
    TakeRecognized,
    open_source,
)
from app.robot.cameras import NetworkStream
from app.robot.live_source import LiveSource
from tests.conftest import ROOT
from tests.robot.languages import spoken
from tests.robot.mjpeg_server import MjpegServer

TABLE = ROOT / "languages" / "osg-table-2.json"


@pytest.fixture(scope="module")
def estimator(installed_models: None) -> Iterator[PoseEstimator]:
    with closing(create_estimator()) as opened:
        yield opened


@pytest.mark.slow
def test_a_clip_says_what_its_recording_says(estimator: PoseEstimator, sample_clips: Path) -> None:
    clip = sample_clips / "line-test-1.mp4"
    language = SpokenLanguage.load(TABLE)
    times: list[float] = []
    with closing(open_source(str(clip))) as source:
        runtime = Runtime(
            source,
            estimator,
            Listener(language),
            observer=lambda frame, found: times.append(frame.time),
        )
        told = list(runtime)
    recording = record(clip, estimator=estimator)
    assert times == recording.poses.time.tolist()
    (take,) = takes_in(recording)
    (said,) = [event for event in told if isinstance(event, TakeRecognized)]
    assert (said.start, said.end) == (take.start, take.end)
    expected = language.recognizer.recognize(take.poses)
    assert said.recognition.to_dict() == expected.to_dict()
    opened, changed, *_, ended = told
    assert opened == SourceOpened(0.0, str(clip), False, recording.poses.frame_size, None)
    assert isinstance(changed, LanguageChanged)
    assert changed.sha256 == said.sha256
    assert ended == SourceEnded(times[-1], len(times), 0, False)
    assert all(before.time <= after.time for before, after in pairwise(told))


def test_a_camera_that_breaks_is_told_and_watched_again(estimator: PoseEstimator) -> None:
    with MjpegServer() as first:
        source = LiveSource("reef", partial(NetworkStream, first.address), first_wait=0.05)
        runtime = Runtime(source, estimator, Listener(spoken("circle")))
        events = iter(runtime)
        told = [next(events) for _ in range(3)]
    with closing(source):
        told.append(next(events))
        with MjpegServer(first.port):
            told.append(next(events))
            runtime.stop()
            told.extend(events)
    opened, _, idle, lost, restored, *_, ended = told
    assert isinstance(opened, SourceOpened)
    assert opened.live
    assert opened.began is not None
    assert idle == StateChanged(idle.time, TakeState.idle)
    assert isinstance(lost, SourceLost)
    assert isinstance(restored, SourceRestored)
    assert isinstance(ended, SourceEnded)
    assert ended.stopped
    assert ended.frames > 0


def test_another_language_is_spoken_from_the_next_frame_on_and_a_broken_one_is_refused(
    estimator: PoseEstimator,
) -> None:
    changes: list[SpokenLanguage | RecognitionError | None] = [
        spoken("circle", "line", revision=2),
        None,
        LanguageError("not a language file", "/format"),
    ]
    told: list[Event] = []
    with MjpegServer() as server, closing(open_source(server.address)) as source:
        runtime = Runtime(
            source,
            estimator,
            Listener(spoken("circle")),
            changes=lambda: changes.pop(0) if changes else None,
        )
        for event in runtime:
            told.append(event)
            if isinstance(event, LanguageRefused):
                runtime.stop()
    before, after = [event for event in told if isinstance(event, LanguageChanged)]
    assert (before.gestures, after.gestures) == (("circle",), ("circle", "line"))
    (refused,) = [event for event in told if isinstance(event, LanguageRefused)]
    assert refused.reason == "/format: not a language file"
    assert (refused.sha256, refused.revision) == (after.sha256, 2)
