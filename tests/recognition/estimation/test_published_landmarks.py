"""Our landmarks against ones that other people published for their clip."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from app.recognition.estimation.factory import OnnxPoseEstimator
from app.recognition.poses.sequence import FloatArray
from tests.recognition.estimation.clip_frames import clip_frames

TOLERANCE = 0.01
"""Of the frame: the published ones come from another model size and release of MediaPipe."""


@pytest.mark.slow
def test_a_signing_person_is_seen_as_published(
    estimator: OnnxPoseEstimator, shared_data: Path
) -> None:
    clips = shared_data / "clips"
    table: FloatArray = np.loadtxt(
        clips / "image_pose_d-D_person205_front.csv", delimiter=",", skiprows=1
    )
    published = table.reshape(-1, 33, 4)[..., :2]
    errors: list[float] = []
    for frame in clip_frames(clips / "slt_person205_front.mp4", len(table)):
        body = estimator.estimate(frame.image, frame.time).body
        assert body is not None
        size = np.array([frame.image.shape[1], frame.image.shape[0]])
        errors.append(float(np.abs(body.xy / size - published[len(errors)]).mean()))
    assert len(errors) == len(table)
    assert np.mean(errors) <= TOLERANCE
