"""Bag frames: reads the frames of a topic of pictures, with the recording's own timestamps."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import cv2
import numpy as np
from av.error import FFmpegError

from app.bags.bag import Bag, Message, Topic
from app.bags.image_messages import PacketDecoder, raw_image
from app.bags.message_clock import MessageClock
from app.recognition.errors import BagError, VideoError
from app.recognition.poses.frame import Image
from app.recognition.recording.video import Turn, VideoFrame, VideoInfo
from app.recognition.recording.video_limits import VideoLimits

RAW = "sensor_msgs/msg/Image"


class BagFrames(Iterator[VideoFrame]):
    """The frames of one topic, read one at a time (`app.recognition.recording.video.FrameSource`).

    Time is that of `MessageClock`. A last odd row or column of pixels is left out, because
    the usual video codecs store only even sizes, and the clip must match its landmarks.

    Parameters
    ----------
    bag
        The recording, which must stay open until the last frame is read.
    topic
        One of its usable topics of pictures.
    limits
        Limits of the clip.
    turn
        By how much the pictures are turned.

    Attributes
    ----------
    info
        Size and count of the frames.

    Raises
    ------
    BagError
        When no message holds a readable picture.
    VideoError
        When a limit is broken.

    """

    def __init__(
        self, bag: Bag, topic: Topic, limits: VideoLimits | None = None, turn: Turn = 0
    ) -> None:
        self._topic = topic
        self._limits = limits or VideoLimits()
        self._limits.require_frames(topic.messages)
        self._unreadable = 0
        self._resized = 0
        self._reason = ""
        self._broken = ""
        self._clock = MessageClock()
        self._count = 0
        self._pictures = (
            (stamp, np.ascontiguousarray(np.rot90(image, -turn // 90)))
            for stamp, image in self._read(bag)
        )
        self._next = next(self._pictures, None)
        if self._next is None:
            raise BagError(
                f"{bag.name}: no picture of topic {topic.name} can be read "
                f"({self._reason or self._broken or 'it is empty'})"
            )
        height, width = self._next[1].shape[:2]
        self.info = VideoInfo(
            width=width,
            height=height,
            duration=None,
            frames=topic.messages,
            rotation=-turn % 360,
            codec=topic.type,
        )

    @property
    def warnings(self) -> tuple[str, ...]:
        """Sentences about faults of the frames read so far."""
        found = []
        name, total = self._topic.name, self._topic.messages
        if self._broken:
            found.append(f"{self._count} of {total} messages were read, then: {self._broken}")
        if self._unreadable:
            found.append(
                f"{self._unreadable} of {total} pictures of {name} were left out: {self._reason}"
            )
        if self._resized:
            found.append(
                f"{self._resized} of {self._count} pictures had another size than the first and "
                f"were scaled to {self.info.width} x {self.info.height}"
            )
        return (*found, *self._clock.list_warnings(name, self._count))

    def __next__(self) -> VideoFrame:
        """Read the next frame.

        Raises
        ------
        VideoError
            When a limit is broken.

        """
        picture, self._next = self._next, None
        if picture is None:
            picture = next(self._pictures)
        stamp, image = picture
        time = self._clock.seconds(stamp)
        self._limits.require_seconds(time)
        self._limits.require_frames(self._count + 1)
        self._count += 1
        return VideoFrame(index=self._count - 1, time=time, image=self._fit(image))

    def _read(self, bag: Bag) -> Iterator[tuple[int | None, Image]]:
        """Yield the readable pictures, with nanoseconds after the stamp of the first one."""
        decoder = PacketDecoder(self._limits)
        messages = bag.messages(self._topic.name)
        try:
            for message in messages:
                yield from self._decode(message, decoder)
            yield from ((stamp, _crop_to_even(image)) for stamp, image in decoder.rest())
        except (BagError, FFmpegError) as error:
            self._broken = _say(error)

    def _decode(
        self, message: Message, decoder: PacketDecoder
    ) -> Iterator[tuple[int | None, Image]]:
        content: Any = message.content
        stamp = self._clock.after_first(message)
        try:
            if self._topic.type == RAW:
                yield stamp, _crop_to_even(raw_image(content, self._limits))
                return
            stated = getattr(content, "encoding", None) or getattr(content, "format", "")
            data = np.asarray(content.data, dtype=np.uint8).tobytes()
            for taken, image in decoder.decode(data, str(stated), stamp):
                yield taken, _crop_to_even(image)
        except VideoError:
            raise
        except (BagError, FFmpegError, ValueError) as error:
            self._unreadable += 1
            self._reason = self._reason or _say(error)

    def _fit(self, image: Image) -> Image:
        size = (self.info.width, self.info.height)
        if image.shape[1::-1] == size:
            return image
        self._resized += 1
        return np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), dtype=np.uint8)


def _say(error: Exception) -> str:
    """Return an error in words; the decoder's own are of no use to anybody."""
    if isinstance(error, FFmpegError):
        return "they cannot be decoded, as where a stream begins between two key frames"
    return str(error)


def _crop_to_even(image: Image) -> Image:
    """Crop a last odd row or column; raise BagError if nothing would be left."""
    height, width = image.shape[:2]
    if min(height, width) < 2:
        raise BagError(f"a picture has {width} x {height} pixels; the recording is damaged")
    return np.ascontiguousarray(image[: height // 2 * 2, : width // 2 * 2])
