"""The salute test against the published rule, on hands that the hand model found in pictures."""

import json
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from app.recognition import record
from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.factory import create_estimator
from benchmarks.accuracy.murky_clips import count_frames
from benchmarks.accuracy.pictures import apply_rules, read_pictures


@pytest.fixture(scope="module")
def estimator() -> Iterator[PoseEstimator]:
    with closing(create_estimator()) as opened:
        yield opened


@pytest.mark.slow
def test_shared_images(shared_data: Path, estimator: PoseEstimator) -> None:
    pictures = read_pictures(shared_data / "hands", estimator)
    assert sum(picture.salutes for picture in pictures) >= 10
    assert sum(not picture.salutes for picture in pictures) >= 60
    rates = {each.name: each.value for each in apply_rules(pictures)}
    assert rates["ours/seen"] >= rates["published/seen"]
    assert rates["ours/false"] <= rates["published/false"] / 10


@pytest.mark.slow
def test_frames_of_a_demonstration(sample_clips: Path, estimator: PoseEstimator) -> None:
    name = "circle-demonstration"
    recording = record(sample_clips / f"{name}.mp4", estimator=estimator)
    phases = json.loads((sample_clips / "phases.json").read_text())
    counts = count_frames(recording, phases[name])
    assert counts["salute"] > 0.95 * counts["salute-frames"]
    assert counts["other"] < 0.01 * counts["other-frames"]
