"""The gesture worker: it starts again after a failure, and says when it cannot."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from sensor_msgs.msg import Image

from app.recognition.poses.frame import FrameLandmarks
from app.recognition.poses.landmarks import POSE_LANDMARKS
from app.robot import ActiveLanguage, Event, Frame, create_listener
from osg_ros.nodes.gesture_worker import MOST_FAILURES, GestureWorker
from osg_ros.topics.image_messages import to_image_message
from osg_ros.topics.stamps import to_stamp
from osg_ros.topics.topic_source import TopicSource
from tests.api.running import until
from tests.robot.languages import spoken


class NobodySeen:
    """An estimator that finds nobody, and fails with as many frames as it is told to."""

    landmarks = POSE_LANDMARKS

    def __init__(self, failures: int) -> None:
        self.failures = failures
        self.frames = 0

    def estimate(self, image: Any, time: float) -> FrameLandmarks:
        if self.failures:
            self.failures -= 1
            raise IndexError("index -1 is out of bounds")
        self.frames += 1
        return FrameLandmarks(None, ())

    def reset(self) -> None:
        pass

    def close(self) -> None:
        pass


class Handler:
    """Keeps what a worker says."""

    def __init__(self) -> None:
        self.problems: list[str] = []

    def handle_frame(self, source: TopicSource, frame: Frame, found: FrameLandmarks) -> None:
        pass

    def handle_event(self, source: TopicSource, event: Event, language: ActiveLanguage) -> None:
        pass

    def report_problem(self, what: str) -> None:
        self.problems.append(what)


def picture(number: int) -> Image:
    message = to_image_message(np.zeros((4, 4, 3), np.uint8))
    message.header.stamp = to_stamp(1_000_000_000 + number * 40_000_000)
    return message


@pytest.mark.parametrize("failures", [1, MOST_FAILURES - 1, MOST_FAILURES])
def test_a_failure_starts_the_recogniser_again_and_a_lasting_one_is_a_fault(failures: int) -> None:
    handler, estimator = Handler(), NobodySeen(failures)
    source = TopicSource("/image", handler.report_problem)
    listener = create_listener(spoken("circle"))
    worker = GestureWorker(source, estimator, listener, "off", handler)
    try:
        number = 0

        def fed() -> bool:
            nonlocal number
            number += 1
            source.put(picture(number))
            return estimator.frames > 2 or bool(worker.find_fault())

        until(fed)
        lasting = failures == MOST_FAILURES
        assert ("IndexError" in worker.find_fault()) is lasting
        assert len(handler.problems) == failures
        assert "Traceback" in handler.problems[0]
        assert worker.facts()["recogniser failures"] == str(failures)
        assert (worker.facts()["recogniser"] == "working") is not lasting
    finally:
        worker.stop()


def test_pictures_that_cannot_be_decoded_are_told_as_such() -> None:
    handler = Handler()
    source = TopicSource("/image", handler.report_problem)
    wrong = picture(1)
    wrong.encoding = "32FC1"
    for _ in range(2):
        source.put(wrong)
        next(iter(source))
    assert "arrive and cannot be decoded (2 so far)" in handler.problems[-1]
    assert "recording" not in handler.problems[-1]


def test_pictures_without_stamps_are_timed_by_their_arrival_and_it_is_said_once() -> None:
    handler = Handler()
    arrivals = iter([5_000_000_000, 5_040_000_000])
    source = TopicSource("/image", handler.report_problem, lambda: next(arrivals))
    frames = []
    for _ in range(2):
        unstamped = picture(1)
        unstamped.header.stamp = to_stamp(0)
        source.put(unstamped)
        frames.append(next(iter(source)))
    assert [frame.time for frame in frames] == [0.0, 0.04]
    assert ["have no stamps" in each for each in handler.problems] == [True]
