"""The runtime: real frames in, through the real models, and events out."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from functools import partial
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from app.recognition import Gesture, Language, OsgError, PoseSequence, record
from app.recognition.errors import LandmarkError, LanguageError
from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.factory import OnnxPoseEstimator, create_estimator
from app.recognition.recording.segmentation import TakeState
from app.robot import (
    ActiveLanguage,
    Event,
    FrameRateChanged,
    Heartbeat,
    LanguageChanged,
    LanguageRefused,
    RecognitionReady,
    Runtime,
    SourceEnded,
    SourceLost,
    SourceOpened,
    SourceRestored,
    SourceWarned,
    StateChanged,
    TriggerListener,
    open_source,
)
from app.robot import runtime as runtime_module
from app.robot.runtime import RateWatch
from app.robot.sources.cameras import NetworkStream
from app.robot.sources.live import LiveSource
from tests.recognition.damaged_clips import HEIGHT, WIDTH, cut_off, write_clip
from tests.robot.languages import spoken
from tests.robot.mjpeg_server import MjpegServer


@pytest.fixture(scope="module")
def estimator(installed_models: None) -> Iterator[PoseEstimator]:
    with closing(create_estimator()) as opened:
        yield opened


@pytest.mark.slow
def test_every_frame_of_a_clip_is_looked_at(estimator: PoseEstimator, tmp_path: Path) -> None:
    clip = write_clip(tmp_path / "dive.mp4", frames=6)
    looked_at: list[float] = []
    with closing(open_source(str(clip))) as source:
        runtime = Runtime(
            source,
            estimator,
            TriggerListener(spoken("circle")),
            observer=lambda frame, found: looked_at.append(frame.time),
        )
        emitted = list(runtime)
    assert looked_at == record(clip, estimator=estimator).poses.time.tolist()
    assert emitted == [
        SourceOpened(0.0, str(clip), False, (WIDTH, HEIGHT), None),
        LanguageChanged(
            0.0, "pool", spoken("circle").sha256, 1, ("circle",), "full", "as the profile does"
        ),
        StateChanged(0.0, TakeState.idle),
        RecognitionReady(0.0),
        SourceEnded(looked_at[-1], 6, 0, False),
    ]


@pytest.mark.slow
def test_a_damaged_clip_is_looked_at_as_far_as_it_goes_and_told(
    estimator: PoseEstimator, tmp_path: Path
) -> None:
    whole = write_clip(tmp_path / "whole.mkv", frames=50)
    clip = cut_off(whole, 0.6)
    with closing(open_source(str(clip))) as source:
        *_, warned, ended = Runtime(source, estimator, TriggerListener(spoken("circle")))
    assert isinstance(warned, SourceWarned)
    assert "the clip is" in warned.reason
    assert isinstance(ended, SourceEnded)
    assert 0 < ended.frames < 50


def test_a_camera_that_breaks_is_told_and_watched_again(estimator: PoseEstimator) -> None:
    with MjpegServer() as first:
        source = LiveSource("reef", partial(NetworkStream, first.address), first_wait=0.05)
        runtime = Runtime(source, estimator, TriggerListener(spoken("circle")))
        events = iter(runtime)
        emitted = [next(events) for _ in range(4)]
    with closing(source):
        told = (event for event in events if not isinstance(event, Heartbeat))
        emitted.append(next(told))
        with MjpegServer(first.port):
            emitted.append(next(told))
            runtime.stop()
            emitted.extend(told)
    opened, _, idle, ready, lost, restored, *_, ended = emitted
    assert isinstance(opened, SourceOpened)
    assert opened.live
    assert opened.began == source.began
    assert idle == StateChanged(idle.time, TakeState.idle)
    assert isinstance(ready, RecognitionReady)
    assert isinstance(lost, SourceLost)
    assert isinstance(restored, SourceRestored)
    assert isinstance(ended, SourceEnded)
    assert ended.stopped
    assert ended.frames > 0


@pytest.mark.withstands(row="H36")
@pytest.mark.parametrize(("rate", "told"), [(2, [(2.0, False)]), (5, [])])
def test_a_source_with_too_few_frames_a_second_is_told(
    estimator: PoseEstimator, tmp_path: Path, rate: int, told: list[tuple[float, bool]]
) -> None:
    clip = write_clip(
        tmp_path / "dive.mp4", frames=6 * rate, times=[each / rate for each in range(6 * rate)]
    )
    with closing(open_source(str(clip))) as source:
        emitted = list(Runtime(source, estimator, TriggerListener(spoken("circle"))))
    changes = [event for event in emitted if isinstance(event, FrameRateChanged)]
    assert [(each.frames_per_second, each.sufficient) for each in changes] == told


def rates(times: list[float]) -> list[tuple[float, bool]]:
    """Return the changes of the rate of frames at these times."""
    watch = RateWatch()
    events = [event for time in times for event in watch.count(time)]
    events += watch.finish()
    return [(event.frames_per_second, event.sufficient) for event in events]


def test_the_rate_is_told_once_for_each_change() -> None:
    slow = [each / 2 for each in range(42)]
    fast = [21 + each / 4 for each in range(60)]
    assert rates(slow) == [(2.0, False)]
    assert rates(slow + fast) == [(2.0, False), (4.0, True)]
    assert rates(fast) == []


def test_the_time_in_which_the_models_are_loaded_is_no_low_rate() -> None:
    assert rates([0.0, *[8 + each / 5 for each in range(60)]]) == []


@pytest.mark.slow
def test_a_machine_that_drops_frames_does_less_for_each_and_says_so(
    estimator: PoseEstimator, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(runtime_module, "RATE_SECONDS", 0.2)
    monkeypatch.setattr(runtime_module, "SPARE_BELOW", 1000.0)
    monkeypatch.setattr(runtime_module, "SPARE_UNTIL", 2000.0)
    assert isinstance(estimator, OnnxPoseEstimator)
    with (
        MjpegServer(pause=0.002) as server,
        closing(open_source(f"http://127.0.0.1:{server.port}/")) as source,
    ):
        runtime = Runtime(source, estimator, TriggerListener(spoken("circle")))
        for event in runtime:
            if isinstance(event, SourceWarned):
                assert "hands that move or hang are looked at once a second" in event.reason
                monkeypatch.setattr(runtime_module, "SPARE_UNTIL", 0.0)
                assert estimator._hands._paces.spares
                break
        for event in runtime:
            if isinstance(event, SourceWarned):
                assert event.reason.endswith("all is looked at again")
                break
    assert not estimator._hands._paces.spares


def test_a_gap_in_which_the_source_is_lost_is_no_low_rate() -> None:
    watch = RateWatch()
    events = [event for each in range(10) for event in watch.count(each / 5)]
    watch.restart()
    events += [event for each in range(60) for event in watch.count(60 + each / 5)]
    assert events == []


def test_a_live_source_gives_heartbeats_also_while_it_is_lost(
    estimator: PoseEstimator, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(runtime_module, "HEARTBEAT_SECONDS", 0.2)
    beats: list[Heartbeat] = []
    with MjpegServer() as server:
        source = LiveSource("reef", partial(NetworkStream, server.address), first_wait=0.05)
        runtime = Runtime(source, estimator, TriggerListener(spoken("circle")))
        events = iter(runtime)
        while not beats:
            beats += [event for event in [next(events)] if isinstance(event, Heartbeat)]
    with closing(source):
        for event in events:
            if isinstance(event, Heartbeat):
                beats.append(event)
                if event.lost:
                    runtime.stop()
    assert not beats[0].lost
    assert beats[-1].lost
    assert all(later.time - beat.time >= 0.2 for beat, later in pairwise(beats))
    assert beats[-1].frames >= beats[0].frames


def test_a_clip_gives_no_heartbeats(
    estimator: PoseEstimator, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(runtime_module, "HEARTBEAT_SECONDS", 0.0)
    clip = write_clip(tmp_path / "dive.mp4", frames=3)
    with closing(open_source(str(clip))) as source:
        emitted = list(Runtime(source, estimator, TriggerListener(spoken("circle"))))
    assert not any(isinstance(event, Heartbeat) for event in emitted)


def test_another_language_is_spoken_from_the_next_frame_on_and_a_broken_one_is_refused(
    estimator: PoseEstimator,
) -> None:
    changes: list[ActiveLanguage | OsgError | None] = [
        spoken("circle", "line", revision=2),
        None,
        LanguageError("not a language file", "/format"),
    ]
    emitted: list[Event] = []
    with MjpegServer() as server, closing(open_source(server.address)) as source:
        runtime = Runtime(
            source,
            estimator,
            TriggerListener(spoken("circle")),
            changes=lambda: changes.pop(0) if changes else None,
        )
        for event in runtime:
            emitted.append(event)
            if isinstance(event, LanguageRefused):
                runtime.stop()
    before, after = [event for event in emitted if isinstance(event, LanguageChanged)]
    assert (before.gestures, after.gestures) == (("circle",), ("circle", "line"))
    (refused,) = [event for event in emitted if isinstance(event, LanguageRefused)]
    assert refused.reason == "/format: not a language file"
    assert (refused.sha256, refused.revision) == (after.sha256, 2)


def test_a_language_that_the_estimator_cannot_follow_is_refused(
    estimator: PoseEstimator, tmp_path: Path
) -> None:
    clip = write_clip(tmp_path / "dive.mp4", frames=2)
    time = np.linspace(0, 2, 40)
    tail = np.stack([300 + 80 * np.cos(3 * time), 200 + 80 * np.sin(3 * time)], axis=1)
    poses = PoseSequence(
        landmarks=("tail_fin",), xy=tail[:, None], time=time, frame_size=(640, 480)
    )
    fish = Language("fish", [Gesture.from_demonstration("wag", poses)])
    wagging = ActiveLanguage.from_json(fish.to_json())
    with closing(open_source(str(clip))) as source:
        with pytest.raises(LandmarkError, match="tail_fin"):
            Runtime(source, estimator, TriggerListener(wagging))
        changes = [wagging]
        runtime = Runtime(
            source,
            estimator,
            TriggerListener(spoken("circle")),
            changes=lambda: changes.pop() if changes else None,
        )
        (refused,) = [event for event in runtime if isinstance(event, LanguageRefused)]
    assert "tail_fin" in refused.reason
    assert refused.sha256 == spoken("circle").sha256
