"""MediaPipe's library as an estimator: what our wrapper adds."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from app.recognition.errors import EstimatorError
from app.recognition.estimation.factory import OnnxPoseEstimator
from app.recognition.estimation.mediapipe_estimator import MediaPipeEstimator
from app.recognition.estimation.water import Examiner
from app.recognition.recording.video import VideoFrame
from tests.recognition.estimation.clip_frames import clip_frames
from tests.recognition.strategies import known


@pytest.fixture(scope="module")
def frame(shared_data: Path) -> VideoFrame:
    return next(clip_frames(shared_data / "clips" / "slt_person205_front.mp4", 1))


def test_rows_that_do_not_follow_each_other_are_read_right(
    library: MediaPipeEstimator, frame: VideoFrame
) -> None:
    padded = np.zeros((frame.image.shape[0], frame.image.shape[1] + 5, 3), np.uint8)
    padded[:, :-5] = frame.image
    library.reset()
    expected = library.estimate(np.ascontiguousarray(frame.image), 0.0).body
    library.reset()
    body = library.estimate(padded[:, :-5], 0.0).body
    assert expected is not None
    assert body is not None
    np.testing.assert_array_equal(body.xy, expected.xy)


@pytest.mark.parametrize("times", [(0.0, 0.0), (5.0, -5.0), (0.0, 0.0001)])
def test_times_that_the_library_refuses_are_mended(
    library: MediaPipeEstimator, frame: VideoFrame, times: tuple[float, float]
) -> None:
    library.reset()
    for time in times:
        assert library.estimate(frame.image, time).body is not None


def test_pixels_lie_in_the_image(library: MediaPipeEstimator, frame: VideoFrame) -> None:
    library.reset()
    body = library.estimate(frame.image, 0.0).body
    assert body is not None
    height, width = frame.image.shape[:2]
    assert ((body.xy[:13] > 0) & (body.xy[:13] < (width, height))).all()


def test_places_in_the_world_are_those_of_our_own_pipeline(
    library: MediaPipeEstimator, estimator: OnnxPoseEstimator, frame: VideoFrame
) -> None:
    library.reset()
    theirs, ours = (each.estimate(frame.image, 0.0).body for each in (library, estimator))
    assert theirs is not None
    assert ours is not None
    np.testing.assert_allclose(known(ours.world), known(theirs.world), atol=0.01)


def test_what_is_no_image_is_refused(library: MediaPipeEstimator) -> None:
    with pytest.raises(EstimatorError, match="image has shape"):
        library.estimate(np.zeros((4, 4), np.uint8), 0.0)


def test_an_examination_finds_the_same_and_leaves_the_tracking_alone(
    library: MediaPipeEstimator, frame: VideoFrame
) -> None:
    assert isinstance(library, Examiner)
    library.reset()
    first = library.estimate(frame.image, 0.0).body
    examined = library.examine(frame.image).body
    library.examine(np.ascontiguousarray(frame.image[:, ::-1]))
    again = library.estimate(frame.image, 0.04).body
    assert first is not None
    assert examined is not None
    assert again is not None
    np.testing.assert_allclose(examined.xy[:13], first.xy[:13], atol=5)
    np.testing.assert_allclose(again.xy[:13], first.xy[:13], atol=5)
