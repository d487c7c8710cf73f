"""Two divers in real pictures, by the real models: the take has the body of the one who salutes."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest

from app.recognition import Language, Recognizer
from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.factory import create_estimator
from app.recognition.recording.extraction import record_frames
from app.recognition.recording.live_segmentation import PeopleInStream
from app.recognition.recording.recording import Recording
from app.recognition.recording.segmentation import takes_in
from tests.recognition.two_divers import Beside, Placed

pytestmark = pytest.mark.slow

SALUTES = "two people are seen; the body is that of the diver who salutes"


@pytest.fixture(scope="module")
def estimator(installed_models: None) -> Iterator[PoseEstimator]:
    with closing(create_estimator()) as opened:
        yield opened


@pytest.fixture(scope="module")
def recognizer(sample_clips: Path) -> Recognizer:
    return Recognizer(Language.load(sample_clips.parent / "osg-table-2.json"))


def side_of(recording: Recording) -> set[str]:
    """Return the halves of the picture in which the body is."""
    middles = recording.poses.torso_centre()
    assert middles is not None
    seen = recording.poses.seen.any(axis=1)
    half = recording.poses.frame_size[0] / 2
    return {"left" if x < half else "right" for x in middles[seen, 0]}


def labels(recording: Recording, recognizer: Recognizer) -> list[str | None]:
    return [recognizer.recognize(take.poses).label for take in takes_in(recording)]


@pytest.mark.withstands(row="H11")
def test_the_take_is_of_the_diver_who_salutes_although_the_buddy_is_nearer(
    estimator: PoseEstimator, recognizer: Recognizer, sample_clips: Path
) -> None:
    buddy = Placed(sample_clips / "ordinary-movement.mp4")
    diver = Placed(sample_clips / "square-test-2.mp4", scale=0.6)
    recording = record_frames(Beside(buddy, diver), estimator=estimator, water="off")
    assert side_of(recording) == {"right"}
    assert labels(recording, recognizer) == ["square"]
    assert recording.warnings[0] == SALUTES
    assert recording.people is not None
    assert recording.people.max() == 2


def test_two_divers_who_both_gesture_have_their_own_takes(
    estimator: PoseEstimator, recognizer: Recognizer, sample_clips: Path
) -> None:
    first = Placed(sample_clips / "circle-demonstration.mp4")
    second = Placed(sample_clips / "line-demonstration.mp4", begins=7.0)
    recording = record_frames(Beside(first, second), estimator=estimator, water="off")
    assert labels(recording, recognizer) == ["circle", "line"]
    assert "more than one salutes" in recording.warnings[0]


def test_a_stream_turns_to_the_diver_who_salutes(
    estimator: PoseEstimator, sample_clips: Path
) -> None:
    buddy = Placed(sample_clips / "ordinary-movement.mp4")
    diver = Placed(sample_clips / "square-test-2.mp4", begins=1.6)
    people = PeopleInStream()
    estimator.reset()
    middles, changes = [], []
    for frame in Beside(buddy, diver):
        followed = people.follow(frame.time, estimator.estimate(frame.image, frame.time))
        _, found = followed.frames[-1]
        changes += [frame.time] * bool(followed.change)
        middles.append(np.nan if found.body is None else found.body.xy[[11, 12], 0].mean())
    (change,) = changes
    assert np.nanmax(middles[:20]) < 480
    assert np.nanmin(middles[round(change / 0.08) :]) > 480
