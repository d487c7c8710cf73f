"""Topic summary: lists the usable topics of a recording, with the size of each first picture."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from app.bags.bag import Bag, Topic, Use, open_bag
from app.bags.image_topic import BagFrames
from app.bags.keypoint_topic import keypoint_frame_size
from app.recognition.errors import BagError, OsgError
from app.recognition.recording.video_limits import VideoLimits

LONGEST_NAME = 255
"""Most characters of a topic's name, as ROS allows."""


@dataclass(frozen=True)
class TopicSummary:
    """One topic that a clip can be made of.

    Attributes
    ----------
    name, type, use, messages
        See `app.bags.bag.Topic`; each message is one frame of the clip.
    duration
        Seconds from its first message to its last.
    width, height
        Pixels of its first picture, upright.

    """

    name: str
    type: str
    use: Use
    messages: int
    duration: float
    width: int
    height: int


def usable_topics(path: str | Path) -> tuple[TopicSummary, ...]:
    """List the usable topics of a recording, and decode the first picture of each.

    Returns
    -------
    The topics, at least one, in the recording's order, those that seem to hold depth last.

    Raises
    ------
    BagError
        When the file is no recording, is damaged, or no topic can be used.
    VideoError
        When every topic exceeds a limit.

    """
    limits = VideoLimits()
    found: list[TopicSummary] = []
    refused: OsgError | None = None
    with open_bag(path) as bag:
        candidates = [topic for topic in bag.usable_topics() if len(topic.name) <= LONGEST_NAME]
        if not candidates:
            bag.topic()  # raises an error with the reason
        durations = bag.durations()
        for topic in candidates:
            try:
                limits.require_frames(topic.messages)
                duration = durations.get(topic.name, 0.0)
                limits.require_seconds(duration)
                found.append(_summary(bag, topic, duration, limits))
            except OsgError as error:
                refused = refused or error
    if not found:
        raise refused or BagError(f"{Path(path).name} has no topic whose name can be used")
    return tuple(found)


def _summary(bag: Bag, topic: Topic, duration: float, limits: VideoLimits) -> TopicSummary:
    assert topic.use is not None
    if topic.use == "pictures":
        info = BagFrames(bag, topic, limits).info
        width, height = info.width, info.height
    else:
        width, height = keypoint_frame_size(bag, topic)
        limits.require_pixels(width, height)
    return TopicSummary(topic.name, topic.type, topic.use, topic.messages, duration, width, height)
