"""A topic of a dive recording as a source: every picture, at its own stamp."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack

from app.bags import bag_and_topic
from app.bags.bag import opened_bag
from app.bags.frames import BagFrames
from app.recognition.errors import BagError
from app.recognition.video_limits import VideoLimits
from app.robot.source import Frame, Notice, Warned


class BagSource:
    """A dive recording; a `Source` that is not live.

    Parameters
    ----------
    text
        ``BAG``, or ``BAG@/TOPIC`` where it has several topics of pictures.
    limits
        What the recording may cost.

    Raises
    ------
    BagError
        When it is none, is damaged, or the topic holds no pictures.
    VideoError
        When it breaks a limit.

    """

    live = False
    began = None

    def __init__(self, text: str, limits: VideoLimits | None = None) -> None:
        self.name = text
        path, topic = bag_and_topic(text)
        with ExitStack() as opening:
            bag = opening.enter_context(opened_bag(path))
            chosen = bag.topic(topic)
            if chosen.use != "pictures":
                raise BagError(
                    f"{chosen.name} holds keypoints, and a robot looks at pictures; use "
                    f"`osg-studio recognize {path} --topic {chosen.name}`"
                )
            self._frames = BagFrames(bag, chosen, limits)
            self._open = opening.pop_all()
        self._closed = False

    @property
    def frame_size(self) -> tuple[int, int]:
        """Width and height in pixels of every frame."""
        return self._frames.info.width, self._frames.info.height

    def __iter__(self) -> Iterator[Frame | Notice]:
        """Give every frame, then what was wrong with the recording.

        Raises
        ------
        VideoError
            When the recording breaks a limit after all.

        """
        time = 0.0
        while not self._closed:
            frame = next(self._frames, None)
            if frame is None:
                break
            time = frame.time
            yield Frame(time, frame.image)
        for warning in self._frames.warnings:
            yield Warned(time, warning)

    def close(self) -> None:
        """Close the recording; nothing more is given."""
        self._closed = True
        self._open.close()
