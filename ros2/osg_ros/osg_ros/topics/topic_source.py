"""Topic source: gives the pictures of a topic to the robot's runtime as frames."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from typing import Any, Final

from app.recognition.errors import OsgError
from app.robot import Frame, NoFrame, Notice
from osg_ros.topics.image_messages import PictureDecoder
from osg_ros.topics.stamps import StampOrArrival, Stopwatch

QUIET_SECONDS: Final = 0.2
"""Seconds without a picture after which the runtime gets a turn to check its language and end."""


class TopicSource:
    """Live `app.robot.Source` that gives the newest picture of a topic.

    A frame's time is its stamp, counted from that of the first picture. A picture that arrives
    while another is processed replaces an older waiting one, so that results have no growing delay.

    Parameters
    ----------
    name
        Name of the topic, for people.
    report_problem
        Called with one line when a picture cannot be decoded and is skipped, and when the pictures
        have no stamps.
    now
        Present time in nanoseconds, for pictures without a stamp.

    Attributes
    ----------
    stopwatch
        Converts the frames' seconds to stamps; None before the first picture.
    frame_id
        Frame of the newest picture's header, which identifies the camera.
    unreadable
        Number of pictures that could not be decoded.

    """

    live = True
    began = None

    def __init__(
        self,
        name: str,
        report_problem: Callable[[str], None],
        now: Callable[[], int] = time.time_ns,
    ) -> None:
        self.name = name
        self._stamp_of = StampOrArrival(name, now, report_problem)
        self.stopwatch: Stopwatch | None = None
        self.frame_id = ""
        self.unreadable = 0
        self._report_problem = report_problem
        self._decoder = PictureDecoder()
        self._news = threading.Condition()
        self._closed = False
        self._newest: Any = None
        self._dropped = 0
        self._time = 0.0
        self._first: Frame | None = None

    @property
    def frame_size(self) -> tuple[int, int]:
        """Width and height of the first picture, which it waits for; 0, 0 if closed before."""
        while self._first is None and not self._closed:
            self._first = self._take_frame(None)
        if self._first is None:
            return 0, 0
        height, width = self._first.image.shape[:2]
        return width, height

    def put(self, message: Any) -> None:
        """Add a message of the topic; called by the subscription."""
        with self._news:
            if self._newest is not None:
                self._dropped += 1
            self._newest = message
            self._news.notify_all()

    def __iter__(self) -> Iterator[Frame | Notice]:
        """Yield frames as they arrive, until the source is closed."""
        while not self._closed:
            first, self._first = self._first, None
            frame = first or self._take_frame(QUIET_SECONDS)
            yield NoFrame(self._time) if frame is None else frame

    def close(self) -> None:
        """Stop the iteration."""
        with self._news:
            self._closed = True
            self._news.notify_all()

    def _take_frame(self, seconds: float | None) -> Frame | None:
        """Wait for the next picture and decode it; None if none came or it is unreadable."""
        with self._news:
            if self._newest is None and not self._closed:
                self._news.wait(seconds)
            message, self._newest = self._newest, None
            dropped, self._dropped = self._dropped, 0
        if message is None:
            return None
        try:
            image = self._decoder.decode(message)
        except OsgError as error:
            self.unreadable += 1
            reason = str(error).partition(";")[0]  # the rest is advice about recordings
            self._report_problem(
                f"the pictures on {self.name} arrive and cannot be decoded "
                f"({self.unreadable} so far): {reason}"
            )
            return None
        stamp = self._stamp_of(message.header.stamp)
        if self.stopwatch is None:
            self.stopwatch = Stopwatch(stamp)
        self.frame_id = message.header.frame_id
        self._time = self.stopwatch.seconds(stamp)
        return Frame(self._time, image, dropped)
