"""The salute test against the published rule, on hands that the hand model found in pictures."""

from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.factory import create_estimator
from benchmarks.accuracy.salute import (
    Picture,
    Rates,
    check_published_rule,
    clip_pictures,
    image_pictures,
    salutes,
)


@pytest.fixture(scope="module")
def estimator() -> Iterator[PoseEstimator]:
    with closing(create_estimator()) as opened:
        yield opened


def assert_better(pictures: list[Picture]) -> None:
    """At least the published rule's recall, at most a tenth of its false positives."""
    own, published = Rates.of(salutes, pictures), Rates.of(check_published_rule, pictures)
    assert own.recall >= published.recall
    assert own.false_positives <= published.false_positives / 10


@pytest.mark.slow
def test_shared_images(shared_data: Path, estimator: PoseEstimator) -> None:
    pictures = image_pictures(shared_data / "hands", estimator)
    assert sum(picture.salutes for picture in pictures) >= 10
    assert sum(not picture.salutes for picture in pictures) >= 60
    assert_better(pictures)


@pytest.mark.slow
def test_frames_of_a_demonstration(sample_clips: Path, estimator: PoseEstimator) -> None:
    pictures = clip_pictures(sample_clips, ["circle-demonstration"], estimator)
    own = Rates.of(salutes, pictures)
    assert own.recall > 0.95
    assert own.false_positives < 0.01
