"""A topic of pictures as a source of frames for the robot's runtime."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from typing import Any, Final

from app.recognition.errors import OsgError
from app.robot import Frame, Notice, Quiet
from osg_ros.topics.image_messages import PictureDecoder
from osg_ros.topics.stamps import Stopwatch, nanoseconds_of

QUIET_SECONDS: Final = 0.2
"""Without a picture for so long the runtime is let look for a new language or its end."""


class TopicSource:
    """The newest picture of a topic; a live `app.robot.Source`.

    A frame's time is its stamp, counted from that of the first picture. Pictures that come while
    one is looked at replace each other, so that the answer is never about the past.

    Parameters
    ----------
    name
        The topic's, for people.
    refused
        Told in one line when a picture cannot be decoded; it is left out.

    Attributes
    ----------
    stopwatch
        From the frames' seconds back to stamps; None before the first picture.
    frame_id
        Of the newest picture: the camera.

    """

    live = True
    began = None

    def __init__(self, name: str, refused: Callable[[str], None]) -> None:
        self.name = name
        self.stopwatch: Stopwatch | None = None
        self.frame_id = ""
        self._refused = refused
        self._decoder = PictureDecoder()
        self._news = threading.Condition()
        self._closed = False
        self._newest: Any = None
        self._dropped = 0
        self._time = 0.0
        self._first: Frame | None = None

    @property
    def frame_size(self) -> tuple[int, int]:
        """Width and height of the first picture, which is waited for; 0 when closed before it."""
        while self._first is None and not self._closed:
            self._first = self._taken(None)
        if self._first is None:
            return 0, 0
        height, width = self._first.image.shape[:2]
        return width, height

    def put(self, message: Any) -> None:
        """Take a message of the topic; called by the subscription."""
        with self._news:
            if self._newest is not None:
                self._dropped += 1
            self._newest = message
            self._news.notify_all()

    def __iter__(self) -> Iterator[Frame | Notice]:
        """Give frames as they come, until the source is closed."""
        while not self._closed:
            first, self._first = self._first, None
            frame = first or self._taken(QUIET_SECONDS)
            yield Quiet(self._time) if frame is None else frame

    def close(self) -> None:
        """Give nothing more."""
        with self._news:
            self._closed = True
            self._news.notify_all()

    def _taken(self, seconds: float | None) -> Frame | None:
        """Wait for the next picture and decode it; None where none came, or it is unreadable."""
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
            self._refused(f"a picture on {self.name} is left out: {error}")
            return None
        stamp = nanoseconds_of(message.header.stamp)
        if self.stopwatch is None:
            self.stopwatch = Stopwatch(stamp)
        self.frame_id = message.header.frame_id
        self._time = self.stopwatch.seconds(stamp)
        return Frame(self._time, image, dropped)
